//! Names the constants and functions of a plan that is emitted as inline code.

use proc_macro2::Ident;

use super::names::Distinct;
use crate::fsm::{Element, Machine};
use crate::plan::Condition;

/// A plan that is emitted as inline code, with the names of its constants and functions.
pub(super) struct Meaning<'a> {
    pub(super) machine: &'a Machine,
    /// Name of the constant of each quark.
    pub(super) constants: Vec<Ident>,
    /// Name of the function for each element that is a scope and whose interrupt can fire; `None` for atoms and all
    /// other elements.
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

    /// Returns the name of the function for an element; `None` if the element has no function.
    pub(super) fn function(&self, element: Element<'_>) -> Option<&Ident> {
        self.functions.get(element.index())?.as_ref()
    }
}
