//! The image of a map: a portable grey map in text form (P2) or binary form (P5).

/// Maximum number of pixels: a floor of 500 m by 500 m at 5 cm.
const PIXELS_MOST: usize = 100_000_000;

/// Rows of grey values, from the top; 0 is black.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Value of white.
    white: u16,
    grey: Vec<u16>,
}

impl Image {
    /// Parses the bytes of an image file.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut words = Words(bytes);
        let kind = words.next().unwrap_or_default();
        if ![&b"P2"[..], b"P5"].contains(&kind) {
            return Err(
                "that is no portable grey map (PGM); `convert map.png map.pgm` makes one of another image".into()
            );
        }
        let mut number = |what: &str| {
            let word = std::str::from_utf8(words.next()?).ok()?;
            word.parse::<usize>().ok().filter(|number| *number > 0).ok_or(what).ok()
        };
        let size = (number("width"), number("height"), number("white"));
        let (Some(width), Some(height), Some(white)) = size else {
            return Err("the image's width, height and white must be whole numbers above 0".into());
        };
        let white = u16::try_from(white).map_err(|_| format!("a white of {white}; expected at most 65535"))?;
        let count = width.checked_mul(height).filter(|count| *count <= PIXELS_MOST);
        let count = count.ok_or_else(|| format!("{width} by {height} pixels are too many; expected 100 million"))?;
        let grey = if kind == b"P2" { words.numbers(count) } else { words.bytes(count, white) };
        if grey.len() < count {
            return Err(format!("the image ends after {} of its {count} pixels", grey.len()));
        }
        Ok(Self { width, height, white, grey })
    }

    /// Returns, for each pixel, `true` if its darkness, from 0 to 1, exceeds `than`. If `negate` is `true`, white is
    /// treated as dark.
    pub(super) fn darker(&self, than: f64, negate: bool) -> Vec<bool> {
        let is_dark = |grey: u16| {
            let bright = f64::from(grey) / f64::from(self.white);
            let darkness = if negate { bright } else { 1.0 - bright };
            darkness > than
        };
        // Each grey value is converted once, since there are far more pixels than grey values.
        let greys: Vec<bool> = (0..=u16::MAX).map(is_dark).collect();
        self.grey.iter().map(|grey| greys.get(usize::from(*grey)).copied().unwrap_or(false)).collect()
    }
}

/// The part of the file that is not read yet. Its words exclude comments, which extend from `#` to the end of the line.
struct Words<'b>(&'b [u8]);

impl<'b> Words<'b> {
    fn next(&mut self) -> Option<&'b [u8]> {
        loop {
            let blanks = self.0.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            self.0 = self.0.get(blanks..)?;
            if self.0.first() != Some(&b'#') {
                break;
            }
            let comment = self.0.iter().take_while(|byte| **byte != b'\n').count();
            self.0 = self.0.get(comment..)?;
        }
        let length = self.0.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        let (word, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }

    fn numbers(&mut self, count: usize) -> Vec<u16> {
        let numbers = std::iter::from_fn(|| std::str::from_utf8(self.next()?).ok()?.parse().ok());
        numbers.take(count).collect()
    }

    /// Reads one byte per pixel, or two bytes (big-endian), after one white-space character.
    fn bytes(&mut self, count: usize, white: u16) -> Vec<u16> {
        let bytes = self.0.get(1..).unwrap_or_default();
        if white < 256 {
            return bytes.iter().take(count).map(|byte| u16::from(*byte)).collect();
        }
        bytes
            .chunks_exact(2)
            .take(count)
            .map(|pair| pair.iter().fold(0, |grey, byte| grey << 8 | u16::from(*byte)))
            .collect()
    }
}
