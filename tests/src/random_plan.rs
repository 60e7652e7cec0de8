//! Generates random plans as text, with scopes, loops and atoms in every notation that the compiler reads.

mod labels;
mod write;

use crate::chance::Chance;
use crate::random_condition::{condition, law};

/// A file with a plan `Main`, and possibly a plan that `Main` refers to.
#[derive(Debug, Clone)]
pub struct RandomPlan {
    definitions: Vec<(&'static str, Scope)>,
    /// `true` if the plan that `Main` refers to has [`PARAMETERS`].
    parameters: bool,
    /// `true` if the plan uses the file [`LIBRARY_FILE`](crate::pipeline::LIBRARY_FILE).
    uses: bool,
}

/// A closed string of the plan.
#[derive(Debug, Clone)]
struct Scope {
    /// Label of the scope as a plan, with the separator after it; empty if the scope has no label.
    label: String,
    name: &'static str,
    /// Condition of the scope as text; `None` if it has no condition.
    condition: Option<String>,
    /// Text of the timer of a scope in formal notation, in which a scope has no name; `None` in the other notations.
    formal: Option<&'static str>,
    body: Vec<Element>,
    /// Text after the body.
    end: &'static str,
}

/// An element of a string.
#[derive(Debug, Clone)]
enum Element {
    /// An element with a label.
    Labelled(String, Box<Element>),
    /// An element with a frame.
    Framed(&'static str, Box<Element>),
    Atom {
        condition: String,
        law: String,
        /// Text of the timer of an atom in formal notation; `None` in the other notations.
        formal: Option<&'static str>,
    },
    Scope(Scope),
    Loop {
        times: &'static str,
        body: Vec<Element>,
        exec: bool,
    },
    /// An open string without a loop count.
    String(Vec<Element>),
    /// A reference to a plan by its name, with the arguments for the plan's parameters.
    Reference(&'static str, Option<String>),
}

/// Names of scopes, including names that emitted code uses itself.
const NAMES: &[&str] = &[
    "P", "Shake", "shake", "Running", "text", "turned", "fn", "Output", "None", "größe", "Atom1", "x_", "t", "Y",
    "law", "cursor", "Self_", "loop",
];

/// Loop counts. Most of them are small, because large counts lead to long searches in a turn.
const TIMES: &[&str] = &["1", "1", "2", "2", "2", "2", "3", "3", "3", "3", "5", "7", "inf"];

/// Parameters of the plan that `Main` refers to.
const PARAMETERS: &str = "(n: count, far: length, T: time, v: speed, mask: bits[4], leader: module, tune: file)";
/// Arguments for each parameter, chosen so that all resulting quarks are in the target's list.
const GIVEN: [&[&str]; 7] = [
    &["1", "2", "3", "inf"],
    &["2", "200cm", "0.25m", "25cm"],
    &["0.1", "250ms", "1", "inf"],
    &["20", "0.2m/s"],
    &["0100", "1011"],
    &["sun module"],
    &["\"bell.mid\""],
];
/// Arguments for the parameter of `Stroll`, a plan in the used file.
const OF_STROLL: &[&[&str]] = &[&["0.25", "100ms", "inf"]];
/// Conditions that use the parameters.
const OF_PARAMETERS: &[&str] =
    &["wait T", "farOff far", "farOff(far) OR stuck 1", "t > T AND a", "NOT wait T", "pattern mask OR played tune"];
/// Laws that use the parameters.
const LAWS_OF_PARAMETERS: &[&str] = &["drive(v)", "chase(leader)", "replay(tune)"];

/// Frames of elements.
const FRAMES: &[&str] = &["90deg", "-45", "0.5rad", "180", "here", "here", "here"];

/// State of the generation of a plan, which limits the plan's size.
struct Growth<'c> {
    chance: &'c mut Chance,
    atoms: usize,
    /// `true` if loops may have thousands of passes.
    long: bool,
    /// Plans to which this plan may refer, each with the possible values of its arguments.
    others: Vec<(&'static str, &'static [&'static [&'static str]])>,
    /// `true` if this plan has [`PARAMETERS`].
    own: bool,
    /// Number of labels so far.
    labels: usize,
}

impl RandomPlan {
    /// Returns a random plan. `atoms` is the approximate maximum number of atoms; `long` allows loops with long
    /// searches.
    pub fn new(chance: &mut Chance, atoms: usize, long: bool) -> Self {
        let mut definitions = Vec::new();
        let uses = chance.percent(10);
        let mut others: Vec<(_, &[&[&str]])> = Vec::new();
        if uses {
            others.extend([("Stroll", OF_STROLL), ("Pause", &[])]);
        }
        let (has_other, parameters) = (chance.percent(25), chance.percent(50));
        if has_other {
            let (atoms, known) = (atoms / 2, others.clone());
            let growth = Growth { chance, atoms, long: false, others: known, own: parameters, labels: 0 };
            definitions.push(("Other", growth.definition(3)));
            others.push(("Other", if parameters { &GIVEN } else { &[] }));
        }
        definitions.push(("Main", Growth { chance, atoms, long, others, own: false, labels: 0 }.definition(5)));
        if chance.percent(50) {
            definitions.reverse();
        }
        Self { definitions, parameters, uses }
    }

    /// Returns this plan with another name in place of `Main`.
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
    /// Returns the scope of a definition. The operands of `after` are filled in once all labels of the definition are
    /// known.
    fn definition(mut self, depth: usize) -> Scope {
        let mut scope = self.scope(depth);
        scope.ask(self.chance);
        scope
    }

    fn scope(&mut self, depth: usize) -> Scope {
        let name = self.chance.pick(NAMES);
        let label = self.chance.percent(10).then(|| self.label("Γ_lab")).map(|label| format!("{label}^b = "));
        let condition = self.chance.percent(85).then(|| self.condition());
        let end = if self.chance.percent(10) { self.chance.pick(&[" sigma_null", " σ_null"]) } else { "" };
        Scope { label: label.unwrap_or_default(), name, condition, formal: None, body: self.body(depth), end }
    }

    /// Returns a label that differs from all earlier ones.
    fn label(&mut self, start: &str) -> String {
        self.labels += 1;
        format!("{start}{}", self.labels)
    }

    fn condition(&mut self) -> String {
        if self.own && self.chance.percent(30) {
            return self.chance.pick(OF_PARAMETERS).to_owned();
        }
        condition(self.chance)
    }

    /// Returns the text of the timer of an element in formal notation, or `None` if the element is written in another
    /// notation.
    fn formal(&mut self) -> Option<&'static str> {
        let times = ["", ", 0.25", ", 100ms", ", 1s", ", inf", ", T"];
        let times = if self.own { &times[..] } else { &times[..5] };
        self.chance.percent(20).then(|| self.chance.pick(times))
    }

    fn law(&mut self, is_formal: bool) -> String {
        match self.own && self.chance.percent(20) {
            true => self.chance.pick(LAWS_OF_PARAMETERS).to_owned(),
            false => law(self.chance, is_formal),
        }
    }

    /// Returns a reference to another plan, with arguments if the plan takes any.
    fn reference(&mut self) -> Element {
        let (name, choices) = self.others[self.chance.below(self.others.len())];
        let arguments: Vec<_> = choices.iter().map(|choices| self.chance.pick(choices)).collect();
        let is_empty = arguments.is_empty() && self.chance.percent(80);
        Element::Reference(name, (!is_empty).then(|| arguments.join(", ")))
    }

    fn body(&mut self, depth: usize) -> Vec<Element> {
        (0..=self.chance.below(3)).map(|_| self.element(depth)).collect()
    }

    fn element(&mut self, depth: usize) -> Element {
        let label = self.chance.percent(25).then(|| self.label("s"));
        let frame = self.chance.percent(20).then(|| self.chance.pick(FRAMES));
        let element = self.unmarked(depth);
        let element = match frame {
            Some(angle) => Element::Framed(angle, Box::new(element)),
            None => element,
        };
        match label {
            Some(label) => Element::Labelled(label, Box::new(element)),
            None => element,
        }
    }

    fn unmarked(&mut self, depth: usize) -> Element {
        if depth == 0 || self.atoms == 0 || self.chance.percent(35) {
            self.atoms = self.atoms.saturating_sub(1);
            let formal = self.formal();
            return Element::Atom { condition: self.condition(), law: self.law(formal.is_some()), formal };
        }
        match self.chance.below(10) {
            0 | 1 if !self.others.is_empty() => self.reference(),
            2 => Element::String(self.body(depth - 1)),
            0..=5 => Element::Scope(Scope { formal: self.formal(), ..self.scope(depth - 1) }),
            _ => self.repeated(depth),
        }
    }

    /// Returns a loop. Many loops consist of a scope or end with one, to test that the end of the scope is
    /// distinguished from the end of the pass.
    fn repeated(&mut self, depth: usize) -> Element {
        let times = match self.long && self.chance.percent(40) {
            true => self.chance.pick(&["3000", "5000", "1000000"]),
            false if self.own && self.chance.percent(30) => "n",
            false => self.chance.pick(TIMES),
        };
        if !self.others.is_empty() && self.chance.percent(20) {
            return Element::Loop { times, body: vec![self.reference()], exec: self.chance.percent(70) };
        }
        let mut body = if self.chance.percent(50) { self.body(depth - 1) } else { Vec::new() };
        if body.is_empty() || self.chance.percent(40) {
            body.push(Element::Scope(self.scope(depth - 1)));
        }
        Element::Loop { times, body, exec: self.chance.percent(30) }
    }
}
