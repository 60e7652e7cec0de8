//! The chart of a run over time. It has a row for each atom, with a band for each period in which the atom ran, and
//! curves of signals below.

use mdle_runtime::Nanos;
use svg::Document;
use svg::node::element::{Group, Rectangle, Style, Title};

use super::colours::{class, style};
use super::layout::round_step;
use super::shapes::{Pixel, line, polyline, simplified, tenths, text};
use super::sizes::MARGIN;

/// Width of a chart, in pixels.
const WIDTH: f64 = 960.0;
/// Width of the column of names at the left, in pixels.
const NAMES: f64 = 190.0;
/// Maximum number of characters of a displayed name.
const LETTERS_MOST: usize = 24;
/// Height of the row of an atom, in pixels.
const ROW: f64 = 22.0;
/// Height of a signal's curve, and vertical distance between two curves, in pixels.
const CURVE: (f64, f64) = (84.0, 22.0);
/// Minimum distance between two labels of the time axis, in pixels.
const APART: f64 = 80.0;
/// Maximum number of rows for atoms. All further atoms share the last row.
const ROWS_MOST: usize = 24;

/// Data of a run over time.
#[derive(Debug, Clone, Default)]
pub struct TimeChart {
    /// Title of the chart.
    pub title: String,
    /// Text of each atom's law. The chart has one row per atom.
    pub atoms: Vec<String>,
    /// Periods in which atoms ran. Each contains the index of the atom, the beginning and the end.
    pub stays: Vec<(usize, Nanos, Nanos)>,
    /// Signals of the run. The chart has one curve per signal.
    pub signals: Vec<SignalCurve>,
    /// End of the run.
    pub end: Nanos,
}

/// A signal over time.
#[derive(Debug, Clone, Default)]
pub struct SignalCurve {
    /// Name of the signal, with its unit.
    pub name: String,
    /// Times and values of the signal. A value that is not finite leaves a gap in the curve.
    pub values: Vec<(Nanos, f64)>,
}

impl TimeChart {
    /// Draws the chart as an SVG picture.
    #[must_use]
    pub fn picture(&self) -> String {
        let rows = self.atoms.len().min(ROWS_MOST) as f64;
        let top = MARGIN + 24.0;
        let axis = top + rows * ROW;
        let height = axis + 36.0 + self.signals.len() as f64 * (CURVE.0 + CURVE.1) + MARGIN;
        let document = Document::new().set("viewBox", (0, 0, WIDTH, tenths(height))).set("width", WIDTH);
        let document = document.set("height", tenths(height)).set("font-family", "sans-serif").set("font-size", 13);
        let document = document.add(Title::new(&self.title)).add(Style::new(style()));
        let paper = Rectangle::new().set("width", WIDTH).set("height", tenths(height)).set("class", "paper");
        let mut document = document.add(paper).add(text(&self.title, (MARGIN, MARGIN + 4.0), "start"));
        document = document.add(self.ticks(top, axis)).add(self.bands(top));
        for (number, signal) in self.signals.iter().enumerate() {
            let above = axis + 36.0 + number as f64 * (CURVE.0 + CURVE.1);
            document = document.add(self.curve(signal, above));
        }
        format!("{document}\n")
    }

    /// Returns the horizontal position of a time, in pixels from the left.
    fn at(&self, t: Nanos) -> f64 {
        let part = t.seconds() / self.end.seconds().max(1e-9);
        NAMES + (WIDTH - MARGIN - NAMES) * part
    }

    /// Draws lines at round times, and labels with these times below the bands.
    fn ticks(&self, top: f64, axis: f64) -> Group {
        let least = self.end.seconds() * APART / (WIDTH - MARGIN - NAMES);
        let step = round_step(least.max(1e-3));
        let count = libm::floor(self.end.seconds() / step + 1e-9) as u32;
        (0..=count).fold(Group::new(), |group, number| {
            let seconds = f64::from(number) * step;
            let x = self.at(Nanos(libm::round(seconds * 1e9) as u64));
            let words = format!("{} s", libm::round(seconds * 1e3) / 1e3);
            let group = group.add(line((x, top), (x, axis + 4.0)).set("class", "faint").set("stroke-opacity", 0.4));
            group.add(text(&words, (x, axis + 16.0), "middle").set("class", "quiet"))
        })
    }

    /// Draws the name of each atom, and a band for each period in which the atom ran.
    fn bands(&self, top: f64) -> Group {
        let row = |atom: usize| top + atom.min(ROWS_MOST - 1) as f64 * ROW;
        let mut group = Group::new();
        for (number, law) in self.atoms.iter().enumerate().take(ROWS_MOST) {
            let is_rest = number == ROWS_MOST - 1 && self.atoms.len() > ROWS_MOST;
            let name = if is_rest { "others".to_owned() } else { shortened(law) };
            group = group.add(text(&name, (NAMES - 8.0, row(number) + ROW / 2.0), "end"));
        }
        for (atom, from, to) in &self.stays {
            let (left, right) = (self.at(*from), self.at(*to));
            let band = Rectangle::new().set("x", tenths(left)).set("y", tenths(row(*atom) + 3.0));
            let band = band.set("width", tenths((right - left).max(0.8))).set("height", ROW - 6.0);
            group = group.add(band.set("class", class("disc", *atom)));
        }
        group
    }

    /// Draws the curve of a signal, scaled to the range from its minimum to its maximum.
    fn curve(&self, signal: &SignalCurve, above: f64) -> Group {
        let (height, below) = (CURVE.0, above + CURVE.0);
        let finite = || signal.values.iter().filter(|(_, value)| value.is_finite());
        let (least, most) = super::view::range(finite().map(|(_, value)| *value));
        let frame = Rectangle::new().set("x", NAMES).set("y", tenths(above)).set("width", WIDTH - MARGIN - NAMES);
        let frame = frame.set("height", height).set("class", "shade").set("fill-opacity", 0.5);
        let name = text(&shortened(&signal.name), (NAMES - 8.0, above + height / 2.0), "end");
        let group = Group::new().add(frame).add(name);
        if finite().next().is_none() {
            return group;
        }
        let number = |value: f64| format!("{}", libm::round(value * 1e3) / 1e3 + 0.0);
        let group = group.add(text(&number(most), (NAMES - 8.0, above + 6.0), "end").set("class", "quiet"));
        let group = group.add(text(&number(least), (NAMES - 8.0, below - 6.0), "end").set("class", "quiet"));
        let span = if most > least { most - least } else { 1.0 };
        let place = |(t, value): &(Nanos, f64)| (self.at(*t), below - 3.0 - (height - 6.0) * (value - least) / span);
        let mut group = group;
        for part in signal.values.split(|(_, value)| !value.is_finite()).filter(|part| !part.is_empty()) {
            let pixels: Vec<Pixel> = simplified(part.iter().map(place));
            group = group.add(polyline(pixels).set("class", "ink").set("stroke-width", 1.4));
        }
        group
    }
}

/// Returns `name`, shortened to the maximum length.
fn shortened(name: &str) -> String {
    if name.chars().count() <= LETTERS_MOST {
        return name.to_owned();
    }
    name.chars().take(LETTERS_MOST - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_has_a_band_for_each_stay_and_a_gap_without_a_value() {
        let second = |seconds: u64| Nanos(seconds * 1_000_000_000);
        let values = [(0, 1.0), (1, 2.0), (2, f64::INFINITY), (3, 1.5), (4, 0.5)];
        let chart = TimeChart {
            title: "Square".to_owned(),
            atoms: vec!["go 20 0".to_owned(), "turn 90".to_owned()],
            stays: vec![(0, second(0), second(3)), (1, second(3), second(4)), (0, second(4), second(4))],
            signals: vec![SignalCurve {
                name: "r0 [m]".to_owned(),
                values: values.map(|(t, value)| (second(t), value)).into(),
            }],
            end: second(4),
        };
        let picture = chart.picture();
        assert_eq!(picture.matches("class=\"disc0\"").count(), 2);
        assert_eq!(picture.matches("class=\"disc1\"").count(), 1);
        assert_eq!(picture.matches("<path").count(), 2, "{picture}");
        let has = |words: &str| picture.lines().any(|line| line == words);
        assert!(has("0.5") && has("2") && has("turn 90"), "{picture}");
    }
}
