//! Replaces numbers that contain a byte 1B, because some controllers may not accept this byte as a value. See
//! docs/src/reference/protocols.md, 2.2.
//!
//! No known program that drives an rFLEX escapes the byte 1B. Instead, these programs replace a turn rate that contains
//! a byte 1B by the nearest turn rate without one. This module does the same for every byte of every number.

/// The escape byte 1B, which begins a two-byte mark on the line.
pub(crate) const ESCAPE: u8 = 0x1B;

/// Returns the nearest number without a byte 1B. If two numbers are equally near, returns the lower one.
#[must_use]
pub fn avoided(number: u32) -> u32 {
    let bytes = number.to_be_bytes();
    let Some(place) = bytes.iter().position(|byte| *byte == ESCAPE) else { return number };
    // Maximum value of the bytes after this one.
    let most = u32::MAX.checked_shr(8 * (place as u32 + 1)).unwrap_or(0);
    let begins = number & !most;
    let below = begins.wrapping_sub(1);
    let above = begins | most;
    if number - below <= above - number + 1 { below } else { above.wrapping_add(1) }
}

#[cfg(test)]
mod tests {
    use super::avoided;

    #[test]
    fn a_number_with_the_byte_gives_way_to_its_neighbour() {
        // Same results as the other programs, for the third byte and the first.
        assert_eq!([avoided(0x1B40), avoided(0x1B7F)], [0x1AFF; 2]);
        assert_eq!([avoided(0x1B80), avoided(0x1BC0)], [0x1C00; 2]);
        assert_eq!([avoided(0x1B00_0000), avoided(0x1BFF_FFFF)], [0x1AFF_FFFF, 0x1C00_0000]);
        // Also for the bytes that the other programs do not check.
        assert_eq!([avoided(0x1B), avoided(0x0012_341B)], [0x1A, 0x0012_341A]);
        assert_eq!([avoided(0x001B_7FFF), avoided(0x001B_8000)], [0x001A_FFFF, 0x001C_0000]);
        assert_eq!(avoided(0x1B1B_1B1B), 0x1AFF_FFFF);
    }

    #[test]
    fn what_comes_out_is_the_nearest() {
        for number in (0..0x0002_0000).chain(0x1AFF_FF00..0x1B00_0100) {
            let nearest = avoided(number);
            assert!(!nearest.to_be_bytes().contains(&0x1B), "{number:X}");
            if !number.to_be_bytes().contains(&0x1B) {
                assert_eq!(nearest, number);
            }
        }
        for number in 0..0x4000_u32 {
            let distance = number.abs_diff(avoided(number));
            let free = |other: u32| !other.to_be_bytes().contains(&0x1B);
            assert!(
                (0..distance).all(|by| !free(number + by) && number.checked_sub(by).is_none_or(|less| !free(less)))
            );
        }
    }
}
