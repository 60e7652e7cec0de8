//! Random plans, as text: scopes, loops and atoms in every notation that the compiler reads.

use std::fmt;

use crate::chance::Chance;
use crate::random_condition::{AFTER, condition, law, operands};

/// A file with a plan `Main`, and perhaps one that it refers to.
#[derive(Debug, Clone)]
pub struct RandomPlan {
    definitions: Vec<(&'static str, Scope)>,
    /// Whether the plan that it refers to has [`PARAMETERS`].
    parameters: bool,
}

/// A closed string.
#[derive(Debug, Clone)]
struct Scope {
    name: &'static str,
    /// Its condition as text; `None` if it has none.
    condition: Option<String>,
    /// Its timer, if it is written in formal notation, which has no name.
    formal: Option<&'static str>,
    body: Vec<Element>,
}

/// What stands in a string.
#[derive(Debug, Clone)]
enum Element {
    /// An element with a label.
    Labelled(String, Box<Element>),
    Atom {
        condition: String,
        law: String,
        /// As for a scope.
        formal: Option<&'static str>,
    },
    Scope(Scope),
    Loop {
        times: &'static str,
        body: Vec<Element>,
        exec: bool,
    },
    /// An open string without a count.
    String(Vec<Element>),
    /// A plan by name, with what its parameters stand for.
    Reference(&'static str, Option<String>),
}

/// Names that scopes may have, some of which emitted code has uses of its own for.
const NAMES: &[&str] = &[
    "P", "Shake", "shake", "Running", "text", "turned", "fn", "Output", "None", "größe", "Atom1", "x_", "t", "Y",
    "law", "cursor", "Self_", "loop",
];

/// Passes: small ones mostly, for others make long searches in one turn.
const TIMES: &[&str] = &["1", "1", "2", "2", "2", "2", "3", "3", "3", "3", "5", "7", "inf"];

/// The parameters of the plan that another refers to.
const PARAMETERS: &str = "(n: count, far: length, T: time, v: speed)";
/// What they may stand for: such that all quarks made of them are among the target's texts.
const GIVEN: [&[&str]; 4] =
    [&["1", "2", "3", "inf"], &["2", "200cm", "0.25m", "25cm"], &["0.1", "250ms", "1", "inf"], &["20", "0.2m/s"]];
/// Conditions made of them.
const OF_PARAMETERS: &[&str] = &["wait T", "farOff far", "farOff(far) OR wait T", "t > T AND a", "NOT wait T"];

/// What a plan may still grow to.
struct Growth<'c> {
    chance: &'c mut Chance,
    atoms: usize,
    /// Whether loops may have thousands of passes.
    long: bool,
    other: Option<&'static str>,
    /// Whether the other plan has parameters.
    given: bool,
    /// Whether this one has.
    own: bool,
    /// How many labels there are.
    labels: usize,
}

impl RandomPlan {
    /// The plan that this source of chance grows. `atoms` is about how many it may have; `long` allows long searches.
    pub fn new(chance: &mut Chance, atoms: usize, long: bool) -> Self {
        let mut definitions = Vec::new();
        let other = chance.percent(25).then_some("Other");
        let given = chance.percent(50);
        if let Some(name) = other {
            let mut growth =
                Growth { chance, atoms: atoms / 2, long: false, other: None, given, own: given, labels: 0 };
            let mut scope = growth.scope(3);
            scope.ask(growth.chance);
            definitions.push((name, scope));
        }
        let mut growth = Growth { chance, atoms, long, other, given, own: false, labels: 0 };
        let mut scope = growth.scope(5);
        scope.ask(growth.chance);
        definitions.push(("Main", scope));
        if growth.chance.percent(50) {
            definitions.reverse();
        }
        Self { definitions, parameters: given }
    }

    /// The same with another name in place of `Main`.
    #[must_use]
    pub fn named(mut self, name: &'static str) -> Self {
        for (plan, _) in &mut self.definitions {
            if *plan == "Main" {
                *plan = name;
            }
        }
        self
    }
}

impl Growth<'_> {
    fn scope(&mut self, depth: usize) -> Scope {
        let name = self.chance.pick(NAMES);
        let condition = self.chance.percent(85).then(|| self.condition());
        Scope { name, condition, formal: None, body: self.body(depth) }
    }

    fn condition(&mut self) -> String {
        if self.own && self.chance.percent(30) {
            return self.chance.pick(OF_PARAMETERS).to_owned();
        }
        condition(self.chance)
    }

    /// Whether an element is written in formal notation, and with which timer.
    fn formal(&mut self) -> Option<&'static str> {
        self.chance.percent(20).then(|| self.chance.pick(&["", ", 0.25", ", 100ms", ", 1s", ", inf"]))
    }

    fn law(&mut self) -> String {
        if self.own && self.chance.percent(20) { "drive(v)".to_owned() } else { law(self.chance) }
    }

    fn arguments(&mut self) -> String {
        GIVEN.map(|choices| self.chance.pick(choices)).join(", ")
    }

    fn body(&mut self, depth: usize) -> Vec<Element> {
        (0..=self.chance.below(3)).map(|_| self.element(depth)).collect()
    }

    fn element(&mut self, depth: usize) -> Element {
        if self.chance.percent(25) {
            self.labels += 1;
            let label = format!("s{}", self.labels);
            return Element::Labelled(label, Box::new(self.unlabelled(depth)));
        }
        self.unlabelled(depth)
    }

    fn unlabelled(&mut self, depth: usize) -> Element {
        if depth == 0 || self.atoms == 0 || self.chance.percent(35) {
            self.atoms = self.atoms.saturating_sub(1);
            return Element::Atom { condition: self.condition(), law: self.law(), formal: self.formal() };
        }
        match (self.chance.below(10), self.other) {
            (0 | 1, Some(name)) => Element::Reference(name, self.given.then(|| self.arguments())),
            (2, _) => Element::String(self.body(depth - 1)),
            (0..=5, _) => Element::Scope(Scope { formal: self.formal(), ..self.scope(depth - 1) }),
            _ => self.repeated(depth),
        }
    }

    /// A loop; often one that holds or ends in a scope, where leaving the scope and ending the pass must not be mixed up.
    fn repeated(&mut self, depth: usize) -> Element {
        let times = match self.long && self.chance.percent(40) {
            true => self.chance.pick(&["3000", "5000", "1000000"]),
            false if self.own && self.chance.percent(30) => "n",
            false => self.chance.pick(TIMES),
        };
        let mut body = if self.chance.percent(50) { self.body(depth - 1) } else { Vec::new() };
        if body.is_empty() || self.chance.percent(40) {
            body.push(Element::Scope(self.scope(depth - 1)));
        }
        Element::Loop { times, body, exec: self.chance.percent(30) }
    }
}

/// Labels with the conditions of their elements, where these have one.
type Labels = Vec<(String, Option<String>)>;

impl Scope {
    /// Makes every [`AFTER`] ask one of the labels of this definition.
    fn ask(&mut self, chance: &mut Chance) {
        let mut labels = Labels::new();
        self.body.iter().for_each(|element| element.labels(&mut labels));
        self.fill(chance, &labels);
    }

    fn fill(&mut self, chance: &mut Chance, labels: &Labels) {
        self.condition.iter_mut().for_each(|condition| fill(condition, chance, labels));
        self.body.iter_mut().for_each(|element| element.fill(chance, labels));
    }
}

impl Element {
    fn labels(&self, labels: &mut Labels) {
        match self {
            Self::Labelled(label, element) => {
                let condition = match &**element {
                    Self::Atom { condition, .. } => Some(condition.clone()),
                    Self::Scope(scope) => scope.condition.clone(),
                    Self::Labelled(..) | Self::Loop { .. } | Self::String(_) | Self::Reference(..) => None,
                };
                labels.push((label.clone(), condition));
                element.labels(labels);
            }
            Self::Scope(Scope { body, .. }) | Self::Loop { body, .. } | Self::String(body) => {
                body.iter().for_each(|element| element.labels(labels));
            }
            Self::Atom { .. } | Self::Reference(..) => {}
        }
    }

    fn fill(&mut self, chance: &mut Chance, labels: &Labels) {
        match self {
            Self::Labelled(_, element) => element.fill(chance, labels),
            Self::Atom { condition, .. } => fill(condition, chance, labels),
            Self::Scope(scope) => scope.fill(chance, labels),
            Self::Loop { body, .. } | Self::String(body) => {
                body.iter_mut().for_each(|element| element.fill(chance, labels));
            }
            Self::Reference(..) => {}
        }
    }
}

/// Makes every [`AFTER`] of a condition ask one of these labels, with or without a cause.
fn fill(condition: &mut String, chance: &mut Chance, labels: &Labels) {
    while let Some(at) = condition.find(AFTER) {
        let after = if labels.is_empty() { "a".to_owned() } else { asked(chance, labels) };
        condition.replace_range(at..at + AFTER.len(), &after);
    }
}

fn asked(chance: &mut Chance, labels: &Labels) -> String {
    let (label, condition) = &labels[chance.below(labels.len())];
    let mut operands = condition.as_deref().map(operands).unwrap_or_default();
    // Parentheses around the whole of it are none of an operand.
    operands
        .retain(|operand| *operand != "null" && !(operand.starts_with('(') && Some(*operand) == condition.as_deref()));
    // An operand that asks a label itself is not written out yet.
    let operands: Vec<_> = operands.into_iter().filter(|operand| !operand.contains(AFTER)).collect();
    if operands.is_empty() || chance.percent(40) {
        return format!("(after {label})");
    }
    format!("(after {label} ({}))", operands[chance.below(operands.len())])
}

impl fmt::Display for RandomPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, scope) in &self.definitions {
            let parameters = if self.parameters && *name == "Other" { PARAMETERS } else { "" };
            scope.write(name, parameters, f)?;
            writeln!(f)?;
        }
        Ok(())
    }
}

impl Scope {
    fn write_formally(&self, time: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        write_all(&self.body, f)?;
        write!(f, ", {}{time})", self.condition.as_deref().unwrap_or("null"))
    }

    fn write(&self, name: &str, parameters: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{ {name}{parameters}")?;
        match (&self.condition, self.body.first()) {
            (Some(condition), _) => write!(f, " ({condition})")?,
            (None, Some(Element::Atom { .. } | Element::Scope(_)) | None) => {}
            // An open string there would be read as the condition.
            (
                None,
                Some(Element::Labelled(..) | Element::Loop { .. } | Element::String(_) | Element::Reference(..)),
            ) => write!(f, " (null)")?,
        }
        write_all(&self.body, f)?;
        f.write_str(" }")
    }
}

/// A law without parentheses around it.
fn bare(law: &str) -> &str {
    law.strip_prefix('(').map_or(law, |law| law.trim_end_matches(')'))
}

fn write_all(elements: &[Element], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    elements.iter().try_for_each(|element| write!(f, " {element}"))
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Labelled(label, element) => write!(f, "{label}: {element}"),
            Self::Atom { condition, law, formal: Some(time) } => {
                write!(f, "({}, {condition}{time})", bare(law))
            }
            Self::Atom { condition, law, formal: None } => write!(f, "(Atom ({condition}) {law})"),
            Self::Scope(scope @ Scope { formal: Some(time), .. }) => scope.write_formally(time, f),
            Self::Scope(scope) => scope.write(scope.name, "", f),
            Self::Reference(name, None) => f.write_str(name),
            Self::Reference(name, Some(arguments)) => write!(f, "{name}({arguments})"),
            Self::String(body) => {
                f.write_str("(")?;
                write_all(body, f)?;
                f.write_str(")")
            }
            Self::Loop { times, body, exec: true } => {
                write!(f, "ExecPlan {times} {{")?;
                write_all(body, f)?;
                f.write_str(" }")
            }
            Self::Loop { times, body, exec: false } => {
                match body.as_slice() {
                    [one @ (Self::Atom { .. } | Self::Scope(_) | Self::Reference(..))] => write!(f, "{one}")?,
                    _ => {
                        f.write_str("(")?;
                        write_all(body, f)?;
                        f.write_str(" )")?;
                    }
                }
                write!(f, "^{times}")
            }
        }
    }
}
