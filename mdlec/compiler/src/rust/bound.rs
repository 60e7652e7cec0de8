//! A quark of an alphabet, and its names in Rust code.

use std::collections::BTreeMap;

use mdle_runtime::Printable;
use proc_macro2::Ident;
use quote::format_ident;

use super::names::{Distinct, quark_type};
use crate::alphabet::{Alphabet, Capability, Declaration, DeclarationKind, Origin, ParameterKind};
use crate::plan::{is_time, is_way, signature};

/// A quark that the robot can run, with the names of its type and of the function that constructs it.
pub(super) struct Bound<'a> {
    pub(super) declaration: &'a Declaration,
    pub(super) kind: Ident,
    pub(super) function: Ident,
}

impl<'a> Bound<'a> {
    /// Returns the quarks of an alphabet that need code. `wait`, `t` and `way` need none, because the machine evaluates
    /// them. Quarks whose capability the robot lacks, and shared quarks whose capability has no trait, are excluded
    /// too.
    pub(super) fn all(alphabet: &'a Alphabet) -> Vec<Self> {
        let mut overloads = BTreeMap::<&str, usize>::new();
        let mut functions = Distinct::quark_functions();
        let is_shared = alphabet.crate_name.is_empty();
        let mut quarks = Vec::new();
        for declaration in alphabet.declarations() {
            let overload = overloads.entry(&declaration.name).or_default();
            let kind = quark_type(&declaration.name, *overload);
            *overload += 1;
            let is_counted = match declaration.kind {
                DeclarationKind::Interrupt => declaration.name == "wait",
                DeclarationKind::Signal => is_time(declaration) || is_way(declaration),
                DeclarationKind::Control => false,
            };
            let is_offered = |need| if is_shared { capability_trait(need).is_some() } else { alphabet.has(need) };
            if !is_counted && declaration.needs.iter().all(is_offered) {
                let function = functions.scope_function(&kind.to_string());
                quarks.push(Self { declaration, kind, function });
            }
        }
        quarks
    }

    pub(super) fn doc(&self) -> String {
        format!(" `{}`: {}", signature(self.declaration), Printable(&self.declaration.docs))
    }

    /// Returns the names and kinds of the quark's parameters.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (Ident, ParameterKind)> {
        let mut names = Distinct::parameters();
        self.declaration.params.iter().map(move |param| (names.parameter(&param.name), param.kind))
    }

    /// Returns the path of the function that constructs the quark, in the form that the target's tables use.
    pub(super) fn path(&self) -> String {
        match &self.declaration.origin {
            Origin::Target => self.function.to_string(),
            Origin::Shared(alphabet) => format!("{alphabet}::{}", self.function),
        }
    }
}

/// Returns the trait that represents a capability; `None` if there is no such trait.
pub(super) fn capability_trait(capability: &Capability) -> Option<Ident> {
    let name = match capability.name.as_str() {
        "odometry" => "Odometry",
        "bumper" => "Bumpers",
        "diff_drive" => "DiffDrive",
        "sonar" => "SonarRing",
        "paths" => "Paths",
        "power" => "Power",
        "modules" => "Modules",
        "state_link" => "StateLink",
        _ => return None,
    };
    Some(format_ident!("{name}"))
}
