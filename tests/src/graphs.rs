//! Strict parsers of mdlec's output for Graphviz and mermaid: anything that the grammars do not allow is an error.

use std::collections::{BTreeMap, BTreeSet};

/// A graph of Graphviz.
#[derive(Debug, Default)]
pub struct Graph {
    /// Declared nodes, each with its attributes.
    pub nodes: BTreeMap<String, BTreeMap<String, String>>,
    /// Edges, each as the node that it leaves, the node that it enters, and its attributes.
    pub edges: Vec<(String, String, BTreeMap<String, String>)>,
    /// Nodes in each cluster, including the nodes of nested clusters.
    pub clusters: BTreeMap<String, BTreeSet<String>>,
}

/// Parses a graph `digraph ID { … }`.
#[must_use]
pub fn read_dot(text: &str) -> Graph {
    let tokens = tokens(text);
    let mut tokens = tokens.iter().map(String::as_str).peekable();
    let mut graph = Graph::default();
    assert_eq!(tokens.next(), Some("digraph"));
    is_id(tokens.next().expect("a name"));
    assert_eq!(tokens.next(), Some("{"));
    let mut open: Vec<String> = Vec::new();
    while let Some(token) = tokens.next() {
        match token {
            ";" => {}
            "}" => {
                if open.pop().is_none() {
                    assert_eq!(tokens.next(), None, "behind the graph");
                    return graph;
                }
            }
            "subgraph" => {
                let name = tokens.next().expect("a name").to_owned();
                assert!(name.starts_with("cluster") && tokens.next() == Some("{"));
                assert!(graph.clusters.insert(name.clone(), BTreeSet::new()).is_none(), "{name} twice");
                open.push(name);
            }
            name => {
                is_id(name);
                if tokens.next_if_eq(&"=").is_some() {
                    is_id(tokens.next().expect("a value"));
                } else if tokens.next_if_eq(&"->").is_some() {
                    let to = tokens.next().expect("a node").to_owned();
                    is_id(&to);
                    graph.edges.push((name.to_owned(), to, attributes(&mut tokens)));
                } else {
                    let attributes = attributes(&mut tokens);
                    if !["node", "edge", "graph"].contains(&name) {
                        assert!(graph.nodes.insert(name.to_owned(), attributes).is_none(), "{name} twice");
                        for cluster in &open {
                            graph.clusters.get_mut(cluster).unwrap().insert(name.to_owned());
                        }
                    }
                }
            }
        }
    }
    panic!("the graph does not end");
}

/// Parses the attributes `[a=b, …]`, if there are any.
fn attributes<'t>(tokens: &mut std::iter::Peekable<impl Iterator<Item = &'t str>>) -> BTreeMap<String, String> {
    let mut attributes = BTreeMap::new();
    if tokens.next_if_eq(&"[").is_none() {
        return attributes;
    }
    loop {
        let key = tokens.next().expect("an attribute");
        is_id(key);
        assert_eq!(tokens.next(), Some("="));
        let value = tokens.next().expect("a value");
        is_id(value);
        assert!(attributes.insert(key.to_owned(), value.trim_matches('"').to_owned()).is_none(), "{key} twice");
        match tokens.next() {
            Some(",") => {}
            Some("]") => return attributes,
            other => panic!("{other:?} in attributes"),
        }
    }
}

/// Asserts that a token is a name, a number or a string in quotes.
fn is_id(token: &str) {
    let is_name = token.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
        && !token.starts_with(|digit: char| digit.is_ascii_digit());
    assert!(token.starts_with('"') || token.parse::<f64>().is_ok() || (is_name && !token.is_empty()), "{token:?}");
}

fn tokens(text: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        let mut token = String::from(letter);
        match letter {
            ' ' | '\n' => continue,
            '"' => loop {
                let next = letters.next().expect("a string ends");
                assert!(next != '\n', "a string on two lines");
                token.push(next);
                if next == '"' {
                    break;
                }
                if next == '\\' {
                    token.push(letters.next().expect("an escape"));
                }
            },
            '-' => token.push(letters.next_if_eq(&'>').expect("an arrow")),
            '{' | '}' | '[' | ']' | ';' | ',' | '=' => {}
            _ => {
                while let Some(next) = letters.next_if(|next| next.is_ascii_alphanumeric() || "_.".contains(*next)) {
                    token.push(next);
                }
            }
        }
        tokens.push(token);
    }
    tokens
}

/// A state diagram of mermaid, with the states and transitions inside each composite state. The key of the top level is
/// the empty name.
#[derive(Debug, Default)]
pub struct Diagram {
    /// States in each composite state.
    pub states: BTreeMap<String, BTreeSet<String>>,
    /// Transitions in each composite state: from, to and label.
    pub transitions: BTreeMap<String, Vec<(String, String, String)>>,
}

/// Parses a `stateDiagram-v2`. A transition from inside a composite state to the outside is an error.
#[must_use]
pub fn read_mermaid(text: &str) -> Diagram {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("stateDiagram-v2"));
    let mut diagram = Diagram::default();
    let mut open = vec![String::new()];
    for line in lines.map(str::trim) {
        let here = open.last().expect("a diagram").clone();
        if line == "}" {
            open.pop();
        } else if let Some(state) = line.strip_prefix("state \"") {
            let (title, state) = state.split_once("\" as ").expect("a name");
            assert_plain(title);
            let name = state.strip_suffix(" {").unwrap_or(state);
            assert!(name.chars().all(|letter| letter.is_ascii_alphanumeric()), "{name:?}");
            let states = diagram.states.entry(here).or_default();
            assert!(states.insert(name.to_owned()), "{name} twice");
            if state != name {
                open.push(name.to_owned());
            }
        } else {
            let (from, to) = line.split_once(" --> ").unwrap_or_else(|| panic!("{line:?}"));
            let (to, text) = to.split_once(" : ").unwrap_or((to, ""));
            assert_plain(text);
            let transitions = diagram.transitions.entry(here).or_default();
            transitions.push((from.to_owned(), to.to_owned(), text.to_owned()));
        }
    }
    assert_eq!(open, [""], "a composite state does not end");
    for (composite, transitions) in &diagram.transitions {
        let inside = &diagram.states[composite];
        for (from, to, _) in transitions {
            assert!(
                [from, to].iter().all(|end| *end == "[*]" || inside.contains(*end)),
                "{from} --> {to} in {composite:?}"
            );
        }
    }
    diagram
}

/// Asserts that characters with a meaning in mermaid occur in a text only as numeric entities.
fn assert_plain(text: &str) {
    let mut parts = text.split('#');
    let first = parts.next().unwrap_or_default();
    let others = parts.map(|part| {
        let (number, rest) = part.split_once(';').expect("a number ends");
        assert!(number.parse::<u32>().is_ok(), "{number:?}");
        rest
    });
    for plain in [first].into_iter().chain(others) {
        assert!(!plain.contains(['"', ';', ':', '<', '>', '{', '}', '%', '\\']), "{plain:?}");
    }
}
