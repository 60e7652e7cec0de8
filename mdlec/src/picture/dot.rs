//! A plan for Graphviz: scopes and loops as clusters, atoms as nodes, exits as edges.

use mdle_runtime::fsm::Bracket;
use mdle_runtime::{Printable, is_printable};

use super::exits::{Exit, exits};
use super::measure::wrapped;
use super::texts::{Texts, What, bounded, exponent, passes};
use super::{can_be_shown, too_many};
use crate::diagnostic::Diagnostic;
use crate::fsm::Machine;
use crate::plan::frame_text;

/// How many letters a line of a label has, and how many lines it has.
const LETTERS: usize = 30;
const LINES: usize = 3;
/// The most edges: loops that end together have one each.
const EDGES: usize = 10_000;

/// The plan in Graphviz's language.
///
/// # Errors
/// E0502 for a plan of more than 1,000 atoms, or of as many scopes and loops.
pub fn dot(lowered: &Machine) -> Result<String, Diagnostic> {
    can_be_shown(lowered)?;
    let mut graph = Graph { texts: Texts(lowered), text: String::new(), edges: 0 };
    graph.head();
    graph.clusters();
    for bracket in 0..lowered.brackets.len() {
        graph.edges(bracket);
        if graph.edges > EDGES {
            return Err(too_many(lowered, graph.edges, "transitions", EDGES));
        }
    }
    graph.text += "}\n";
    Ok(graph.text)
}

struct Graph<'l> {
    texts: Texts<'l>,
    text: String,
    edges: usize,
}

impl Graph<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        let indent = 2 * depth.min(20);
        self.text += &format!("{:indent$}{text}\n", "");
    }

    fn head(&mut self) {
        let name = self.texts.0.scopes.iter().flatten().next().map_or("", |plan| plan.name.as_str());
        self.line(0, &format!("digraph {} {{", quoted(name)));
        self.line(1, "compound=true; rankdir=LR; fontname=\"sans-serif\";");
        self.line(1, "node [shape=box, style=\"rounded,filled\", fillcolor=\"#ffffff\", fontname=\"sans-serif\"];");
        self.line(1, "edge [fontname=\"sans-serif\", fontsize=10];");
        self.line(1, "begin [shape=circle, style=filled, fillcolor=\"#000000\", label=\"\", width=0.15];");
        self.line(1, "over [shape=doublecircle, style=filled, fillcolor=\"#000000\", label=\"\", width=0.12];");
        self.line(1, &format!("begin -> {} [lhead=cluster0];", atom(0)));
    }

    /// All brackets, each inside the one around it.
    fn clusters(&mut self) {
        let mut open: Vec<usize> = Vec::new();
        for (number, bracket) in self.texts.0.brackets.iter().enumerate() {
            self.close(&mut open, |holder| holder != bracket.parent as usize);
            let depth = open.len() + 1;
            match self.texts.what(number) {
                What::Atom(place, _, law) => {
                    let (state, labels) = (self.texts.state(place), self.texts.labels(number));
                    let title = format!("{state}: {labels}{}{}", frame_text(law.frame), self.texts.law(law));
                    let label = label(&title);
                    let tooltip = quoted(&self.texts.tooltip(number));
                    self.line(depth, &format!("{} [label={label}, tooltip={tooltip}];", atom(place)));
                }
                What::Scope(scope) => {
                    let title = format!("{}{}", self.texts.labels(number), scope.name);
                    self.open(depth, number, &title, "#e9f0f7", "rounded,filled");
                    open.push(number);
                }
                What::Loop(times) => {
                    let title = format!("{}{} ({})", self.texts.labels(number), exponent(times), passes(times));
                    self.open(depth, number, &title, "#555555", "rounded,dashed");
                    open.push(number);
                }
            }
        }
        self.close(&mut open, |_| true);
    }

    fn open(&mut self, depth: usize, number: usize, title: &str, colour: &str, style: &str) {
        let tooltip = quoted(&self.texts.tooltip(number));
        let colour =
            if style.contains("filled") { format!("fillcolor=\"{colour}\"") } else { format!("color=\"{colour}\"") };
        self.line(depth, &format!("subgraph cluster{number} {{"));
        self.line(depth + 1, &format!("label={}; style=\"{style}\"; {colour}; tooltip={tooltip};", label(title)));
    }

    /// Ends clusters, the innermost first, as long as they are to end.
    fn close(&mut self, open: &mut Vec<usize>, ends: impl Fn(usize) -> bool) {
        while open.pop_if(|number| ends(*number)).is_some() {
            self.line(open.len() + 1, "}");
        }
    }

    /// Where the bracket leads by its own condition.
    fn edges(&mut self, number: usize) {
        let until = self.texts.until(number);
        if !until.ends() {
            return;
        }
        let bracket = self.texts.0.brackets[number];
        let is_scope = matches!(self.texts.what(number), What::Scope(_));
        for exit in exits(self.texts.0, number) {
            let (to, when) = match exit {
                Exit::Behind { atom: behind, last_pass } => (atom(behind), last(last_pass)),
                Exit::Over { last_pass } => ("over".into(), last(last_pass)),
                Exit::Again { bracket, times } => {
                    (atom(self.texts.0.brackets[bracket].first as usize), format!(", next pass of {}", exponent(times)))
                }
            };
            let mut attributes = vec![format!("label={}", label(&format!("{}{when}", until.text())))];
            attributes.push(format!("tooltip={}", quoted(&bounded(&until.text()))));
            if is_scope {
                // Which cluster is left also where it cannot be drawn, since the edge leads into it again.
                attributes.push(format!("class=\"cluster{number}\", color=\"#c2410c\", fontcolor=\"#c2410c\""));
                if !self.is_inside(exit, bracket) {
                    attributes.push(format!("ltail=cluster{number}"));
                }
            }
            self.edges += 1;
            let from = atom(bracket.last as usize);
            self.line(1, &format!("{from} -> {to} [{}];", attributes.join(", ")));
        }
    }

    /// Whether this leads into the bracket itself: an edge cannot begin at a cluster that it ends in.
    fn is_inside(&self, exit: Exit, bracket: Bracket) -> bool {
        match exit {
            Exit::Behind { .. } | Exit::Over { .. } => false,
            Exit::Again { bracket: again, .. } => self.texts.0.brackets[again].first >= bracket.first,
        }
    }
}

fn last(last_pass: bool) -> String {
    if last_pass { ", last pass".into() } else { String::new() }
}

fn atom(number: usize) -> String {
    format!("a{}", number + 1)
}

/// A text on a few lines, as a label.
fn label(text: &str) -> String {
    let lines = wrapped(text, LETTERS, LINES);
    let lines: Vec<_> = lines.iter().map(|line| escaped(line)).collect();
    format!("\"{}\"", lines.join("\\n"))
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// In a string of Graphviz's a backslash begins an escape sequence, and `&` an HTML entity.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '"' => escaped.push_str("\\\""),
            '\\' => escaped.push_str("\\\\"),
            '&' => escaped.push_str("&amp;"),
            '\n' => escaped.push_str("\\n"),
            letter if !is_printable(letter) => escaped += &Printable(letter).to_string(),
            letter => escaped.push(letter),
        }
    }
    escaped
}
