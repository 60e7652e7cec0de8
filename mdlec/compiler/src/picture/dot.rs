//! Writes a plan in Graphviz's language. Scopes and loops become clusters, atoms become nodes, and exits become edges.

use mdle_runtime::{Printable, is_printable};

use super::exits::{Destination, destinations};
use super::measure::wrapped;
use super::texts::{bounded, exponent, labels, law, passes, tooltip, until};
use super::{can_be_shown, place, too_many};
use crate::diagnostic::Diagnostic;
use crate::fsm::{Atom, Element, ElementKind, Machine, Visit};

/// Maximum number of characters in a line of a label.
const LETTERS: usize = 30;
/// Maximum number of lines of a label.
const LINES: usize = 3;
/// Maximum number of edges. If several loops can end together with an element, the element has an edge for each of
/// them.
const EDGES: usize = 10_000;

/// Returns the plan in Graphviz's language.
///
/// # Errors
/// Fails with E0502 for a plan of more than 1,000 atoms, or of more than 1,000 scopes and loops together.
pub fn dot(machine: &Machine) -> Result<String, Diagnostic> {
    can_be_shown(machine)?;
    let mut graph = Graph { text: String::new(), depth: 0, edges: 0 };
    graph.head(machine.root());
    machine.walk().for_each(|visit| graph.cluster(visit));
    for element in machine.elements() {
        graph.edges(element);
        if graph.edges > EDGES {
            return Err(too_many(place(machine), graph.edges, "transitions", EDGES));
        }
    }
    graph.text += "}\n";
    Ok(graph.text)
}

struct Graph {
    text: String,
    /// Number of open clusters.
    depth: usize,
    edges: usize,
}

impl Graph {
    fn line(&mut self, depth: usize, text: &str) {
        let indent = 2 * depth.min(20);
        self.text += &format!("{:indent$}{text}\n", "");
    }

    fn head(&mut self, plan: Element<'_>) {
        self.line(0, &format!("digraph {} {{", quoted(plan.name())));
        self.line(1, "compound=true; rankdir=LR; fontname=\"sans-serif\";");
        self.line(1, "node [shape=box, style=\"rounded,filled\", fillcolor=\"#ffffff\", fontname=\"sans-serif\"];");
        self.line(1, "edge [fontname=\"sans-serif\", fontsize=10];");
        self.line(1, "begin [shape=circle, style=filled, fillcolor=\"#000000\", label=\"\", width=0.15];");
        self.line(1, "over [shape=doublecircle, style=filled, fillcolor=\"#000000\", label=\"\", width=0.12];");
        self.line(1, &format!("begin -> {} [lhead=cluster0];", id(plan.first())));
    }

    /// Writes the beginning or the end of the cluster of a scope or a loop, or the node of an atom.
    fn cluster(&mut self, visit: Visit<'_>) {
        let (Visit::Enter(element) | Visit::Leave(element)) = visit;
        let (labels, tooltip) = (labels(element), quoted(&tooltip(element)));
        let (title, style) = match element.kind() {
            ElementKind::Atom(atom) => {
                if let Visit::Enter(_) = visit {
                    let label = label(&format!("{}: {labels}{}", atom.state(), law(atom)));
                    self.line(self.depth + 1, &format!("{} [label={label}, tooltip={tooltip}];", id(atom)));
                }
                return;
            }
            ElementKind::Scope => {
                (format!("{labels}{}", element.name()), "style=\"rounded,filled\"; fillcolor=\"#e9f0f7\"")
            }
            ElementKind::Loop { times } => {
                let title = format!("{labels}{} ({})", exponent(times), passes(times));
                (title, "style=\"rounded,dashed\"; color=\"#555555\"")
            }
        };
        if let Visit::Leave(_) = visit {
            self.line(self.depth, "}");
            self.depth -= 1;
            return;
        }
        self.depth += 1;
        self.line(self.depth, &format!("subgraph cluster{} {{", element.number()));
        self.line(self.depth + 1, &format!("label={}; {style}; tooltip={tooltip};", label(&title)));
    }

    /// Writes the edges for the end of an element by its own condition, one edge for each destination.
    fn edges(&mut self, element: Element<'_>) {
        let until = until(element);
        if !until.ends() {
            return;
        }
        for destination in destinations(element) {
            let (to, when) = match destination {
                Destination::After { next, last_pass } => (id(next.first()), last(last_pass)),
                Destination::Over { last_pass } => ("over".into(), last(last_pass)),
                Destination::Again { repeated, times } => {
                    (id(repeated.first()), format!(", next pass of {}", exponent(times)))
                }
            };
            let mut attributes = vec![format!("label={}", label(&format!("{}{when}", until.text())))];
            attributes.push(format!("tooltip={}", quoted(&bounded(&until.text()))));
            if element.is_scope() {
                let number = element.number();
                // The class names the cluster that the edge leaves even if this cannot be drawn, because the edge leads
                // back into the cluster.
                attributes.push(format!("class=\"cluster{number}\", color=\"#c2410c\", fontcolor=\"#c2410c\""));
                if !leads_inside(destination, element) {
                    attributes.push(format!("ltail=cluster{number}"));
                }
            }
            self.edges += 1;
            self.line(1, &format!("{} -> {to} [{}];", id(element.last()), attributes.join(", ")));
        }
    }
}

/// Returns `true` if a destination is inside the element itself. Such an edge cannot be drawn, because an edge cannot
/// end inside the cluster at which it begins.
fn leads_inside(destination: Destination<'_>, element: Element<'_>) -> bool {
    match destination {
        Destination::After { .. } | Destination::Over { .. } => false,
        Destination::Again { repeated, .. } => repeated.first().number() >= element.first().number(),
    }
}

fn last(last_pass: bool) -> String {
    if last_pass { ", last pass".into() } else { String::new() }
}

fn id(atom: Atom<'_>) -> String {
    format!("a{}", atom.number() + 1)
}

/// Converts a text to a label of a few lines.
fn label(text: &str) -> String {
    let lines = wrapped(text, LETTERS, LINES);
    let lines: Vec<_> = lines.iter().map(|line| escaped(line)).collect();
    format!("\"{}\"", lines.join("\\n"))
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// Escapes `text` for a string in Graphviz's language, in which a backslash begins an escape sequence and `&` begins an
/// HTML entity.
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
