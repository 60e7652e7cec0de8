//! Whole numbers in the Scout's format: two bytes, low byte first, in sign-magnitude form. See
//! docs/src/reference/protocols.md, 1.2.

/// Sign bit of the high byte.
const SIGN: u8 = 0x80;

/// Returns the two bytes of a number from -32767 to 32767; -32768 becomes -32767.
#[must_use]
pub(crate) fn signed(number: i16) -> [u8; 2] {
    let [low, high] = number.unsigned_abs().min(i16::MAX as u16).to_le_bytes();
    [low, if number < 0 { high | SIGN } else { high }]
}

/// Decodes the number in two bytes. Zero has two representations.
#[must_use]
pub(crate) fn read([low, high]: [u8; 2]) -> i16 {
    // Without the sign bit, the value is below 32768.
    let magnitude = u16::from_le_bytes([low, high & !SIGN]) as i16;
    if high & SIGN == 0 { magnitude } else { -magnitude }
}

#[cfg(test)]
mod tests {
    use super::{read, signed};

    #[test]
    fn signs_stand_beside_magnitudes() {
        assert_eq!([signed(-1), signed(-567), signed(1234)], [[0x01, 0x80], [0x37, 0x82], [0xD2, 0x04]]);
        assert_eq!([read([0x00, 0x80]), signed(i16::MIN).map(i16::from)[1]], [0, 0xFF]);
        assert!((-i16::MAX..=i16::MAX).all(|number| read(signed(number)) == number));
    }
}
