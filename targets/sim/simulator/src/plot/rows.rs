//! The rows of a legend: each atom of the plan's text, with the number of its runs and their total duration.

use mdle_runtime::Printable;

use super::sizes::{LETTER, LETTERS};
use crate::trail::{Trail, TrailAtom};

/// Maximum number of atoms that are marked and listed.
pub(super) const ROWS_MOST: usize = 40;
/// Maximum number of characters of a displayed law.
const LAW_MOST: usize = 44;
/// Distance between two columns, in pixels.
const APART: f64 = 22.0;

/// An atom in the legend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LegendRow {
    /// Number of the atom; empty in the line for all omitted atoms.
    pub(super) number: String,
    pub(super) law: String,
    /// Number of times that the atom ran; empty if every atom ran once.
    pub(super) times: String,
    /// Total time for which the atom ran.
    pub(super) total: String,
}

/// Returns the rows of the legend of a run.
pub(super) fn of(trail: &Trail) -> Vec<LegendRow> {
    let ways = &trail.ways;
    let again = ways.atoms.iter().any(|atom| atom.times > 1);
    let listed = ways.atoms.iter().take(ROWS_MOST).map(|atom| LegendRow {
        number: atom.number.to_string(),
        law: shortened(&atom.law),
        times: if again { format!("{} ×", atom.times) } else { String::new() },
        total: total(atom),
    });
    let left = ways.atoms.len().saturating_sub(ROWS_MOST).saturating_add(ways.uncounted);
    let more = (left > 0).then(|| LegendRow {
        number: String::new(),
        law: format!("and {left} more"),
        times: String::new(),
        total: String::new(),
    });
    listed.chain(more).collect()
}

fn total(atom: &TrailAtom) -> String {
    format!("{:.1} s", atom.total.seconds())
}

/// Returns the width of the column of total times, including the space before it, in pixels.
pub(super) fn last_column(rows: &[LegendRow]) -> f64 {
    column(rows.iter().map(|row| &row.total))
}

/// Returns the total width of both columns with numbers, in pixels.
pub(super) fn columns(rows: &[LegendRow]) -> f64 {
    last_column(rows) + column(rows.iter().map(|row| &row.times))
}

fn column<'r>(texts: impl Iterator<Item = &'r String>) -> f64 {
    let letters = texts.map(|text| text.chars().count()).max().unwrap_or(0);
    if letters == 0 { 0.0 } else { letters as f64 * f64::from(LETTERS) * LETTER + APART }
}

/// Returns the text of a law, shortened so that it fits. Its numbers are rounded to a thousandth.
pub(super) fn shortened(law: &str) -> String {
    let words = law.split(' ').map(|word| match (word.split_once('.'), word.parse::<f64>()) {
        (Some((_, decimals)), Ok(number)) if decimals.len() > 3 => format!("{}", libm::round(number * 1e3) / 1e3),
        (_, Ok(_) | Err(_)) => word.to_owned(),
    });
    let law = Printable(words.collect::<Vec<_>>().join(" ")).to_string();
    if law.chars().count() <= LAW_MOST { law } else { law.chars().take(LAW_MOST - 1).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_laws_are_shown_to_a_thousandth() {
        assert_eq!(shortened("go 20 -0.3490658503988659"), "go 20 -0.349");
        assert_eq!(shortened("path \"a.bcdef 1.25\" 0.5"), "path \"a.bcdef 1.25\" 0.5");
        assert_eq!(shortened(&"goAvoid 90 40 20 ".repeat(4)), "goAvoid 90 40 20 goAvoid 90 40 20 goAvoid 9…");
    }
}
