//! The title of a plot (the plan, the world, the body, and the end of the run), broken into lines that fit.

use mdle_runtime::Printable;
use svg::node::element::Group;

use super::shapes::text;
use super::sizes::{LEFT, LETTER, MARGIN};
use crate::trail::About;

/// Font sizes, in pixels, of the plan's name and of the lines below it.
const NAME: u32 = 18;
const REST: u32 = 14;
/// Maximum number of characters of the whole title. A viewer shows the whole title as the name of the picture.
const WHOLE: usize = 400;
/// Maximum number of lines into which a text is broken.
const LINES: usize = 3;

/// A title, broken into lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Title {
    /// Lines of the title, each with its font size in pixels.
    lines: Vec<(u32, String)>,
    /// The whole title in one line.
    pub(super) whole: String,
}

impl Title {
    /// Creates the title of a run, with lines of at most `width` pixels.
    pub(super) fn of(about: &About, width: f64) -> Self {
        let About { setup, plan, end } = about;
        let all = [(NAME, plan), (REST, end), (REST, setup)].map(|(size, text)| (size, Printable(text).to_string()));
        let texts = || all.iter().filter(|(_, text)| !text.is_empty());
        let whole: String =
            texts().map(|(_, text)| text.as_str()).collect::<Vec<_>>().join(": ").chars().take(WHOLE).collect();
        let lines = texts().flat_map(|(size, text)| {
            let letters = (width / f64::from(*size) / LETTER).max(8.0) as usize;
            wrapped(text, letters).into_iter().map(|line| (*size, line))
        });
        Self { lines: lines.collect(), whole: if whole.is_empty() { "A run".to_owned() } else { whole } }
    }

    /// Returns the height of all lines, including the space below them.
    pub(super) fn height(&self) -> f64 {
        let lines = self.lines.iter().map(|(size, _)| height(*size)).sum::<f64>();
        if self.lines.is_empty() { 0.0 } else { lines + MARGIN / 2.0 }
    }

    pub(super) fn drawn(&self) -> Group {
        let mut y = MARGIN;
        self.lines.iter().fold(Group::new(), |group, (size, line)| {
            let middle = y + height(*size) / 2.0;
            y += height(*size);
            let line = text(line, (MARGIN + LEFT, middle), "start").set("font-size", *size);
            group.add(if *size == NAME { line.set("font-weight", "bold") } else { line })
        })
    }
}

fn height(size: u32) -> f64 {
    f64::from(size) * 1.4
}

/// Breaks a text between words into at most [`LINES`] lines of at most `letters` characters. A text that does not fit
/// ends with `…`.
fn wrapped(text: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let full = lines.len() == LINES;
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                line.push(' ');
                line.push_str(word);
            }
            Some(line) if full => {
                line.push_str(" …");
                break;
            }
            Some(_) | None => lines.push(word.to_owned()),
        }
    }
    let cut = |line: String| {
        if line.chars().count() <= letters { line } else { line.chars().take(letters - 1).chain(['…']).collect() }
    };
    lines.into_iter().map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_broken_between_words_and_cut_where_they_are_too_long() {
        assert_eq!(wrapped("world hall, body scout, seed 1", 18), ["world hall, body", "scout, seed 1"]);
        assert_eq!(wrapped(&"bumper OR ".repeat(20), 12), ["bumper OR", "bumper OR", "bumper OR …"]);
        assert_eq!(wrapped("aVeryLongNameOfAPlan", 8), ["aVeryLo…"]);
        assert_eq!(wrapped("", 8), [""; 0]);
    }

    #[test]
    fn a_title_has_the_end_and_the_setup_and_no_control_characters() {
        let about = About { setup: "world a\u{1b}, seed 1".into(), plan: "P".into(), end: "3.0 s  over".into() };
        assert_eq!(Title::of(&about, 600.0).whole, "P: 3.0 s  over: world aU+001B, seed 1");
        assert_eq!(Title::of(&About::default(), 600.0).height(), 0.0);
    }
}
