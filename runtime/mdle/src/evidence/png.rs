//! A grey image as PNG (ISO/IEC 15948), without compression: a map is small.

/// First bytes of every file.
const SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
/// Grey of 8 bits, by rows, without interlacing.
const GREY: [u8; 5] = [8, 0, 0, 0, 0];
/// Maximum length of a block without compression, in bytes.
const BLOCK: usize = 65_535;

/// Returns the file of an image whose rows have `width` pixels each, the uppermost row first.
pub(crate) fn png(width: usize, greys: &[u8]) -> Vec<u8> {
    let rows = greys.chunks_exact(width.max(1));
    let size = [width as u32, rows.len() as u32].map(u32::to_be_bytes).concat();
    // Each row begins with its filter, of which 0 is none.
    let bytes: Vec<u8> = rows.flat_map(|row| std::iter::once(&0).chain(row)).copied().collect();
    let mut file = SIGNATURE.to_vec();
    chunk(&mut file, *b"IHDR", &[&size[..], &GREY].concat());
    chunk(&mut file, *b"IDAT", &zlib(&bytes));
    chunk(&mut file, *b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, name: [u8; 4], content: &[u8]) {
    file.extend((content.len() as u32).to_be_bytes());
    let checked = [&name[..], content].concat();
    file.extend(&checked);
    file.extend(crc32fast::hash(&checked).to_be_bytes());
}

/// Returns bytes as a zlib stream (RFC 1950) of blocks without compression (RFC 1951, 3.2.4).
fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01];
    let blocks = bytes.chunks(BLOCK);
    let last = blocks.len().saturating_sub(1);
    for (number, block) in blocks.enumerate() {
        let length = block.len() as u16;
        stream.push(u8::from(number == last));
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend(block);
    }
    stream.extend(adler32(bytes).to_be_bytes());
    stream
}

/// Returns the checksum of a zlib stream.
fn adler32(bytes: &[u8]) -> u32 {
    const MODULUS: u32 = 65_521;
    let (low, high) = bytes.iter().fold((1, 0), |(low, high), byte| {
        let low = (low + u32::from(*byte)) % MODULUS;
        (low, (high + low) % MODULUS)
    });
    high << 16 | low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_of_two_pixels_has_these_bytes() {
        // As Python's zlib and binascii compute the checksums.
        let expected: &[&[u8]] = &[
            &SIGNATURE,
            &[0, 0, 0, 13],
            b"IHDR",
            &[0, 0, 0, 1, 0, 0, 0, 2, 8, 0, 0, 0, 0],
            &0xbcea_e9fb_u32.to_be_bytes(),
            &[0, 0, 0, 15],
            b"IDAT",
            &[0x78, 0x01, 1, 4, 0, 0xfb, 0xff, 0, 7, 0, 200],
            &0x00e1_00d0_u32.to_be_bytes(),
            &0x2776_aefd_u32.to_be_bytes(),
            &[0, 0, 0, 0],
            b"IEND",
            &0xae42_6082_u32.to_be_bytes(),
        ];
        assert_eq!(png(1, &[7, 200]), expected.concat());
    }

    #[test]
    fn a_large_image_has_several_blocks() {
        let stream = zlib(&[1; BLOCK + 1]);
        let second = 2 + 5 + BLOCK;
        assert_eq!((stream[2], &stream[second..second + 6]), (0, &[1, 1, 0, 0xfe, 0xff, 1][..]));
    }
}
