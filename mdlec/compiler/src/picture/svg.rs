//! Draws a plan as nested boxes, with atoms in rows and exits as red lines. A browser can show the drawing without
//! other tools.

use std::fmt::Write;

use super::arrows::{Arrow, MARGIN, Polyline, arrows};
use super::can_be_shown;
use super::layout::{Placed, Style, places};
use super::measure::{LINE, letters, wrapped};
use super::texts::{tooltip, until};
use super::xml::escaped;
use crate::diagnostic::Diagnostic;
use crate::fsm::{Element, ElementKind, Machine};

/// Style sheet: colours for a light and a dark background, and fonts.
const STYLE: &str = include_str!("style.css");
/// Height above the plan's box for the title, in pixels.
const TITLE: i64 = 46;
/// Height below the plan's box, including one line of the legend, in pixels.
const FOOT: i64 = 40;
/// Maximum number of lines of the legend that explains the signs.
const MEANINGS: usize = 4;
/// Radius of the rounded corners of a line, in pixels.
const ROUND: i64 = 8;
/// Number of colours for nested scopes.
const COLOURS: usize = 4;

/// Returns the picture of a plan as SVG.
///
/// # Errors
/// Fails with E0502 for a plan of more than 1,000 atoms, or of more than 1,000 scopes and loops together.
pub fn svg(machine: &Machine) -> Result<String, Diagnostic> {
    drawn(machine, None)
}

/// Returns the picture of a plan. It also shows how many times each atom began in some runs; atoms that never began are
/// faint.
///
/// # Errors
/// Fails with E0502 as for [`svg`].
pub fn counted_svg(machine: &Machine, began: &[u64]) -> Result<String, Diagnostic> {
    drawn(machine, Some(began))
}

fn drawn(machine: &Machine, began: Option<&[u64]>) -> Result<String, Diagnostic> {
    can_be_shown(machine)?;
    let mut all = places(machine);
    for placed in &mut all {
        placed.x += MARGIN;
        placed.y += TITLE;
    }
    let mut picture = SvgPicture { machine, all: &all, began, text: String::new() };
    picture.draw();
    Ok(picture.text)
}

struct SvgPicture<'p> {
    machine: &'p Machine,
    all: &'p [Placed],
    /// Number of times that each atom began; `None` if the picture does not show these numbers.
    began: Option<&'p [u64]>,
    text: String,
}

impl SvgPicture<'_> {
    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn draw(&mut self) {
        let Some(root) = self.all.first() else { return };
        let width = (root.width + 2 * MARGIN).max(640);
        let meanings = wrapped(&self.meanings(), letters(width - MARGIN - root.x), MEANINGS);
        let height = root.height + TITLE + FOOT + LINE * (meanings.len() as i64 - 1).max(0);
        let name = escaped(self.machine.root().name());
        let count = self.machine.atoms().len();
        let atoms = if count == 1 { "1 atom".to_owned() } else { format!("{count} atoms") };
        self.line(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"The plan {name}, {atoms}\">"
        ));
        self.line(&format!("<title>{name}</title>"));
        self.line(&format!("<style>\n{STYLE}</style>"));
        self.line("<defs>");
        for (id, class) in [("flow", "tip"), ("exit", "tip exit")] {
            self.line(&format!(
                "<marker id=\"{id}\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
                 orient=\"auto\" markerUnits=\"userSpaceOnUse\"><path class=\"{class}\" d=\"M0 0L8 4L0 8z\"/></marker>"
            ));
        }
        self.line("</defs>");
        self.line(&format!("<rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>"));
        self.line(&format!("<text class=\"title\" x=\"{}\" y=\"28\">{name}</text>", root.x));
        let right = width - MARGIN;
        self.line(&format!("<text class=\"quiet\" x=\"{right}\" y=\"28\" text-anchor=\"end\">{atoms}</text>"));
        self.boxes();
        arrows(self.machine, self.all).iter().for_each(|line| self.arrow(line));
        self.ends(root, height, &meanings);
        self.line("</svg>");
    }

    /// Draws the signs for the beginning and the end of the plan, and the legend.
    fn ends(&mut self, root: &Placed, height: i64, meanings: &[String]) {
        let (begin, end) = (root.x - MARGIN + 16, root.x + root.width + MARGIN - 12);
        self.line(&format!("<circle class=\"end\" cx=\"{begin}\" cy=\"{}\" r=\"6\"/>", root.y + root.enters));
        if root.ends {
            let y = root.y + root.leaves;
            self.line(&format!("<circle class=\"ring\" cx=\"{end}\" cy=\"{y}\" r=\"8\"/>"));
            self.line(&format!("<circle class=\"end\" cx=\"{end}\" cy=\"{y}\" r=\"4\"/>"));
        }
        for (number, line) in (1..).zip(meanings) {
            let (x, y) = (root.x, height - 14 - LINE * (meanings.len() as i64 - number));
            self.line(&format!("<text class=\"quiet\" x=\"{x}\" y=\"{y}\">{line}</text>"));
        }
    }

    /// Returns the text of the legend, which explains the signs that occur in this picture.
    fn meanings(&self) -> String {
        let mut meanings = Vec::new();
        if self.machine.elements().any(|element| element.is_scope() && until(element).ends()) {
            meanings.push("A red line leaves a box whose own condition fires, the outermost first.");
        }
        if self.machine.elements().any(|element| matches!(element.kind(), ElementKind::Loop { .. })) {
            meanings.push("A dashed line begins the next pass.");
        }
        meanings.join(" ")
    }

    /// Draws all boxes. Outer boxes are drawn first, so that inner boxes cover them.
    fn boxes(&mut self) {
        for (element, placed) in self.machine.elements().zip(self.all) {
            let (x, y, width, height) = (placed.x, placed.y, placed.width, placed.height);
            let (class, round) = match element.kind() {
                ElementKind::Atom(_) => ("atom".to_owned(), 6),
                ElementKind::Loop { .. } => ("loop".to_owned(), 18),
                ElementKind::Scope => (format!("scope s{}", placed.depth % COLOURS), 10),
            };
            self.line(&format!("<g><title>{}</title>", escaped(&tooltip(element))));
            let faint = if self.count(element) == Some(0) { " style=\"opacity:.35;stroke-dasharray:4 3\"" } else { "" };
            self.line(&format!(
                "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"{round}\"{faint}/>"
            ));
            self.words(element, placed);
            self.line("</g>");
        }
    }

    /// Returns the number of times that an atom began; `None` if the picture does not show this number.
    fn count(&self, element: Element<'_>) -> Option<u64> {
        self.began?.get(element.atom()?.index()).copied()
    }

    /// Draws the text in a box.
    fn words(&mut self, element: Element<'_>, placed: &Placed) {
        for (place, (style, text)) in (0..).zip(&placed.lines) {
            let class = match style {
                Style::Law => "law",
                Style::Name => "name",
                Style::Until => "until",
                Style::Quiet => "quiet",
            };
            let x = placed.x + if element.atom().is_some() { 10 } else { 14 };
            let y = placed.y + 10 + LINE * place + 12;
            self.line(&format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{}</text>", escaped(text)));
        }
        if let Some(atom) = element.atom() {
            let state = atom.state().to_string();
            let wide = 10 + 7 * state.len() as i64;
            let (x, y) = (placed.x + placed.width - wide + 6, placed.y - 8);
            self.line(&format!(
                "<rect class=\"number\" x=\"{x}\" y=\"{y}\" width=\"{wide}\" height=\"16\" rx=\"8\"/><text class=\"count\" \
                 x=\"{}\" y=\"{}\" text-anchor=\"middle\">{state}</text>",
                x + wide / 2,
                y + 12
            ));
        }
        if let Some(count) = self.count(element) {
            let (x, y) = (placed.x + placed.width - 6, placed.y + placed.height - 6);
            self.line(&format!("<text class=\"quiet\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\">{count}×</text>"));
        }
    }

    fn arrow(&mut self, line: &Polyline) {
        let (class, tip) = match line.arrow {
            Arrow::Flow => ("flow", " marker-end=\"url(#flow)\""),
            Arrow::Port => ("flow", ""),
            Arrow::Exit => ("flow exit", " marker-end=\"url(#exit)\""),
            Arrow::Again => ("flow again", " marker-end=\"url(#flow)\""),
        };
        let path = rounded(&line.points);
        self.line(&format!("<path class=\"{class}\" d=\"{path}\"{tip}/>"));
    }
}

/// Returns the path through these points with rounded corners.
fn rounded(points: &[(i64, i64)]) -> String {
    let mut points = points.to_vec();
    points.dedup();
    let Some((x, y)) = points.first() else { return String::new() };
    let mut path = format!("M{x} {y}");
    for corner in points.windows(3) {
        let (before, here, behind) = (corner[0], corner[1], corner[2]);
        let (start, end) = (towards(here, before), towards(here, behind));
        // Writing to a string cannot fail.
        let _ = write!(path, "L{} {}Q{} {} {} {}", start.0, start.1, here.0, here.1, end.0, end.1);
    }
    if let Some((x, y)) = points.last().filter(|_| points.len() > 1) {
        let _ = write!(path, "L{x} {y}");
    }
    path
}

/// Returns the point on the line from `from` to `to` at which a rounded corner begins. The point is at most halfway.
fn towards(from: (i64, i64), to: (i64, i64)) -> (i64, i64) {
    let step = |from: i64, to: i64| from + (to - from).signum() * ROUND.min((to - from).abs() / 2);
    (step(from.0, to.0), step(from.1, to.1))
}
