//! Chooses every identifier in generated files.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Ident;
use quote::format_ident;

/// Names of types that a generated file uses without a module path; the robot's types are written with a path.
const TYPES: &[&str] = &[
    "At", "Atom", "Begin", "Bracket", "Cursor", "Debug", "Default", "FnMut", "Fsm", "Input", "Nanos", "None", "Option",
    "Output", "Plan", "Running", "Self", "Some",
];
/// Names in a bound alphabet other than the names of its quarks, and Rust names that its text uses.
const BOUND: &[&str] = &[
    "Input",
    "Output",
    "Alphabet",
    "AnyInterrupt",
    "AnySignal",
    "AnyControl",
    "AnyLaw",
    "Comparison",
    "Debug",
    "None",
    "Option",
    "Self",
    "Some",
];
/// Names of the constants of every emitted plan.
const CONSTANTS: &[&str] = &["FSM", "LAWS", "CONDITIONS", "NAMES", "OPERANDS", "SOURCE"];
/// Names of an emitted plan's functions, arguments and variables, which other functions must not shadow, and a keyword
/// that syn does not know yet.
const FUNCTIONS: &[&str] = &["gen", "cursor", "y", "t", "tell", "law", "atom", "begin", "scope"];

/// Returns the name of a plan's type, which is the plan's name in camel case.
#[must_use]
pub fn plan_type(plan: &str) -> String {
    let name = camel_case(plan);
    if TYPES.contains(&name.as_str()) { format!("{name}Plan") } else { name }
}

/// Returns the name of a quark's type in its target's crate. This is the quark's name in camel case, followed by a
/// number for further declarations of the same name: `GoAvoid`, `GoAvoid2`.
pub(super) fn quark_type(name: &str, overload: usize) -> Ident {
    let name = camel_case(name);
    let name = if BOUND.contains(&name.as_str()) { format!("{name}Quark") } else { name };
    if overload == 0 { format_ident!("{name}") } else { format_ident!("{name}{}", overload + 1) }
}

/// Returns the name of the variant for the law of an atom; atoms are numbered from 1 in the order of the plan's text.
pub(super) fn atom_variant(atom: usize) -> Ident {
    format_ident!("Atom{}", atom + 1)
}

/// A set of names that differ from each other.
#[derive(Debug)]
pub(super) struct Distinct {
    names: BTreeSet<String>,
    /// For each name, the last number that was appended to it; the search for the next number begins there.
    numbers: BTreeMap<String, usize>,
}

impl Distinct {
    /// Returns the names that every plan's constants already use.
    pub(super) fn constants() -> Self {
        Self::beside(CONSTANTS)
    }

    /// Returns the names that every plan's functions already use.
    pub(super) fn functions() -> Self {
        Self::beside(FUNCTIONS)
    }

    /// Returns the names that a function for a quark cannot have: a keyword, and the names of the functions that create
    /// rows.
    pub(super) fn quark_functions() -> Self {
        Self::beside(&["gen", "guard", "law", "follows", "degrees"])
    }

    /// Returns an empty set of names, for the parameters of a function.
    pub(super) fn parameters() -> Self {
        Self::beside(&[])
    }

    fn beside(names: &[&str]) -> Self {
        Self { names: names.iter().map(|name| (*name).to_owned()).collect(), numbers: BTreeMap::new() }
    }

    /// Returns a name for the constant of a quark with its arguments, derived from the quark text: `GO_0_0_36`.
    pub(super) fn constant(&mut self, quark_text: &str) -> Ident {
        let words = quark_text
            .replace('-', "minus_")
            .replace(|letter: char| letter.is_ascii() && !letter.is_ascii_alphanumeric(), "_");
        self.distinct(&snake_case(&words).to_ascii_uppercase())
    }

    /// Returns a name for the function that checks whether a scope or an enclosing scope has ended, derived from the
    /// scope's name.
    pub(super) fn scope_function(&mut self, scope: &str) -> Ident {
        let name = if scope.is_empty() { "unnamed".to_owned() } else { snake_case(scope) };
        let name = if syn::parse_str::<Ident>(&name).is_ok() { name } else { format!("{name}_scope") };
        self.distinct(&name)
    }

    /// Returns a name for a quark's parameter, derived from the parameter's name in the alphabet.
    pub(super) fn parameter(&mut self, name: &str) -> Ident {
        let name = snake_case(name);
        let name = if syn::parse_str::<Ident>(&name).is_ok() { name } else { format!("{name}_") };
        self.distinct(&name)
    }

    /// Returns `name` if it is not in use, or else the first unused name among `name_2`, `name_3`, ….
    fn distinct(&mut self, name: &str) -> Ident {
        let mut distinct = name.to_owned();
        while !self.names.insert(distinct.clone()) {
            let number = self.numbers.entry(name.to_owned()).or_insert(1);
            *number += 1;
            distinct = format!("{name}_{number}");
        }
        format_ident!("{distinct}")
    }
}

fn ascii(name: &str) -> String {
    name.chars().fold(String::new(), |mut text, letter| {
        if letter.is_ascii_alphanumeric() || letter == '_' {
            text.push(letter);
        } else {
            text.push_str(&format!("_u{:x}", u32::from(letter)));
        }
        text
    })
}

fn camel_case(name: &str) -> String {
    let mut camel = String::new();
    for word in ascii(name).split('_').filter(|word| !word.is_empty()) {
        let (first, rest) = word.split_at(1);
        camel.push_str(&first.to_ascii_uppercase());
        camel.push_str(rest);
    }
    if camel.starts_with(|letter: char| letter.is_ascii_alphabetic()) { camel } else { format!("P{camel}") }
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    let mut after_lower = false;
    for letter in ascii(name).chars() {
        if letter.is_ascii_uppercase() && after_lower {
            snake.push('_');
        }
        after_lower = letter.is_ascii_lowercase() || letter.is_ascii_digit();
        snake.push(letter.to_ascii_lowercase());
    }
    let snake = words(&snake, '_');
    if snake.starts_with(|letter: char| letter.is_ascii_alphabetic()) { snake } else { format!("scope_{snake}") }
}

/// Returns the non-empty parts of `name` between underscores, joined with `joint`.
fn words(name: &str, joint: char) -> String {
    let parts: Vec<_> = name.split('_').filter(|part| !part.is_empty()).collect();
    parts.join(&joint.to_string())
}

#[cfg(test)]
mod tests {
    use super::{Distinct, plan_type};

    #[test]
    fn names_are_rust_identifiers_and_differ() {
        assert_eq!(plan_type("lab_tour"), "LabTour");
        assert_eq!(plan_type("Lab2ToLab1Plan"), "Lab2ToLab1Plan");
        assert_eq!(plan_type("self"), "SelfPlan");
        assert_eq!(plan_type("Cursor"), "CursorPlan");
        assert_eq!(plan_type("größe"), "GrUf6Udfe");
        assert_eq!(plan_type("_1"), "P1");
        let mut names = Distinct::constants();
        let mut constant = |text| names.constant(text).to_string();
        assert_eq!(constant("go 0 0.36"), "GO_0_0_36");
        assert_eq!(constant("go 0.0 36"), "GO_0_0_36_2");
        assert_eq!(constant("go -5 0"), "GO_MINUS_5_0");
        assert_eq!(constant("laws"), "LAWS_2");
        let mut names = Distinct::functions();
        let mut scope = |name| names.scope_function(name).to_string();
        assert_eq!(scope("Lab2ToLab1Plan"), "lab2_to_lab1_plan");
        assert_eq!(scope("loop"), "loop_scope");
        assert_eq!(scope("Shake"), "shake");
        assert_eq!(scope("shake_2"), "shake_2");
        assert_eq!(scope("shake"), "shake_3");
        assert_eq!(scope("T"), "t_2");
        assert_eq!([scope(""), scope("")], ["unnamed", "unnamed_2"]);
    }
}
