//! Random plans, as text: scopes, loops and atoms in every notation that the compiler reads.

use std::fmt;

use crate::chance::Chance;
use crate::random_condition::{Forms, condition, law};

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
    body: Vec<Element>,
}

/// What stands in a string.
#[derive(Debug, Clone)]
enum Element {
    Atom {
        condition: String,
        law: String,
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
    forms: Forms,
    atoms: usize,
    /// Whether loops may have thousands of passes.
    long: bool,
    other: Option<&'static str>,
    /// Whether the other plan has parameters.
    given: bool,
    /// Whether this one has.
    own: bool,
}

impl RandomPlan {
    /// The plan that this source of chance grows. `atoms` is about how many it may have; `long` allows long searches.
    pub fn new(chance: &mut Chance, forms: Forms, atoms: usize, long: bool) -> Self {
        let mut definitions = Vec::new();
        let other = chance.percent(25).then_some("Other");
        let given = chance.percent(50);
        if let Some(name) = other {
            let mut growth = Growth { chance, forms, atoms: atoms / 2, long: false, other: None, given, own: given };
            let scope = growth.scope(3);
            definitions.push((name, scope));
        }
        let mut growth = Growth { chance, forms, atoms, long, other, given, own: false };
        let scope = growth.scope(5);
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
        Scope { name, condition, body: self.body(depth) }
    }

    fn condition(&mut self) -> String {
        if self.own && self.chance.percent(30) {
            return self.chance.pick(OF_PARAMETERS).to_owned();
        }
        condition(self.chance, self.forms)
    }

    fn law(&mut self) -> String {
        if self.own && self.chance.percent(20) { "drive v".to_owned() } else { law(self.chance) }
    }

    fn arguments(&mut self) -> String {
        GIVEN.map(|choices| self.chance.pick(choices)).join(", ")
    }

    fn body(&mut self, depth: usize) -> Vec<Element> {
        (0..=self.chance.below(3)).map(|_| self.element(depth)).collect()
    }

    fn element(&mut self, depth: usize) -> Element {
        if depth == 0 || self.atoms == 0 || self.chance.percent(35) {
            self.atoms = self.atoms.saturating_sub(1);
            return Element::Atom { condition: self.condition(), law: self.law() };
        }
        match (self.chance.below(10), self.other) {
            (0 | 1, Some(name)) => Element::Reference(name, self.given.then(|| self.arguments())),
            (2, _) => Element::String(self.body(depth - 1)),
            (0..=5, _) => Element::Scope(self.scope(depth - 1)),
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
    fn write(&self, name: &str, parameters: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{ {name}{parameters}")?;
        match (&self.condition, self.body.first()) {
            (Some(condition), _) => write!(f, " ({condition})")?,
            (None, Some(Element::Atom { .. } | Element::Scope(_)) | None) => {}
            // An open string there would be read as the condition.
            (None, Some(Element::Loop { .. } | Element::String(_) | Element::Reference(..))) => write!(f, " (null)")?,
        }
        write_all(&self.body, f)?;
        f.write_str(" }")
    }
}

fn write_all(elements: &[Element], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    elements.iter().try_for_each(|element| write!(f, " {element}"))
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Atom { condition, law } => write!(f, "(Atom ({condition}) {law})"),
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
