//! A plan's meaning with the names that its constants and functions have.

use proc_macro2::Ident;

use super::names::Distinct;
use crate::fsm::{Element, Machine};
use crate::plan::Condition;

/// A plan's meaning with the names that its constants and functions have.
pub(super) struct Meaning<'a> {
    pub(super) machine: &'a Machine,
    /// The constant of each quark.
    pub(super) constants: Vec<Ident>,
    /// The function of each element that is a scope, but no atom, with an interrupt that can fire.
    functions: Vec<Option<Ident>>,
}

impl<'a> Meaning<'a> {
    pub(super) fn new(machine: &'a Machine) -> Self {
        let mut names = Distinct::constants();
        let constants = machine.quarks().iter().map(|quark| names.constant(&quark.text)).collect();
        let mut names = Distinct::functions();
        let functions = machine.elements().map(|element| {
            let has_function = element.is_scope() && *element.condition() != Condition::Null;
            has_function.then(|| names.scope_function(element.name()))
        });
        Self { machine, constants, functions: functions.collect() }
    }

    /// The function of an element, if it has one.
    pub(super) fn function(&self, element: Element<'_>) -> Option<&Ident> {
        self.functions.get(element.index())?.as_ref()
    }
}
