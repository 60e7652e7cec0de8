//! Draws a picture of dots with the characters of a terminal: each character has two by four dots and one colour.

/// Colour of a character. A colour covers all colours that are declared before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) enum Ink {
    /// No dot is drawn.
    #[default]
    None,
    Goal,
    Charger,
    Way,
    Wall,
    Echo,
}

impl Ink {
    /// Returns the escape sequence that switches the terminal to this colour.
    fn code(self) -> &'static str {
        match self {
            Self::None | Self::Wall => "\x1b[0m",
            Self::Goal => "\x1b[0;32m",
            Self::Charger => "\x1b[0;35m",
            Self::Way => "\x1b[0;94m",
            Self::Echo => "\x1b[0;33m",
        }
    }
}

/// A drawing in Braille characters, each of which is a block of 2 by 4 dots.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Canvas {
    pub(super) columns: usize,
    pub(super) rows: usize,
    letters: Vec<(u8, Ink)>,
}

impl Canvas {
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, letters: vec![(0, Ink::None); columns * rows] }
    }

    /// Draws a dot if it is on the canvas; coordinates count from the upper left corner.
    pub(super) fn dot(&mut self, x: i64, y: i64, ink: Ink) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= 2 * self.columns || y >= 4 * self.rows {
            return;
        }
        // Bit order of Unicode's Braille patterns: three dots downwards in each column, then the fourth dot of each.
        let bit = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]][y % 4][x % 2];
        let Some(letter) = self.letters.get_mut(y / 4 * self.columns + x / 2) else { return };
        letter.0 |= bit;
        letter.1 = letter.1.max(ink);
    }

    /// Returns the rows as text, with `sign` in place of one character.
    pub(super) fn text(&self, sign: Option<((usize, usize), &str)>) -> Vec<String> {
        let rows = self.letters.chunks(self.columns.max(1)).enumerate();
        rows.map(|(row, letters)| {
            let mut text = String::new();
            let mut last = Ink::None;
            for (column, (dots, ink)) in letters.iter().enumerate() {
                if let Some((_, sign)) = sign.filter(|(at, _)| *at == (column, row)) {
                    text += sign;
                    text += last.code();
                    continue;
                }
                if *ink != last && *ink != Ink::None {
                    text += ink.code();
                    last = *ink;
                }
                text.push(if *dots == 0 { ' ' } else { char::from_u32(0x2800 + u32::from(*dots)).unwrap_or(' ') });
            }
            text.trim_end_matches(' ').to_owned()
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_become_braille() {
        let mut canvas = Canvas::new(3, 2);
        for y in 0..8 {
            canvas.dot(0, y, Ink::Wall);
        }
        canvas.dot(5, 7, Ink::Echo);
        for (x, y) in [(-1, 0), (6, 0), (0, 8), (i64::MIN, i64::MAX)] {
            canvas.dot(x, y, Ink::Wall);
        }
        assert_eq!(canvas.text(None), ["\u{1b}[0m⡇", "\u{1b}[0m⡇ \u{1b}[0;33m⢀"]);
        assert_eq!(canvas.text(Some(((1, 0), "@"))), ["\u{1b}[0m⡇@\u{1b}[0m", "\u{1b}[0m⡇ \u{1b}[0;33m⢀"]);
        assert_eq!(Canvas::new(0, 5).text(None), [""; 0]);
    }
}
