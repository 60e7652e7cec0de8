//! Finds the module attributes that a plan reads (docs/src/reference/semantics.md, 2.5).

use std::collections::BTreeSet;

use super::Machine;
use crate::alphabet::{Alphabet, Declaration, DeclarationKind, ParameterKind};
use crate::plan::{Quark, Value};

/// An attribute that a plan reads from a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct AttributeRead<'m> {
    /// Name of the module, as the plan gives it.
    pub module: &'m str,
    /// Name of the attribute, as the alphabet gives it.
    pub attribute: &'m str,
    /// SI unit of the attribute's values; `None` if the alphabet declares no module signal with the attribute's name.
    pub unit: Option<&'static str>,
}

/// Returns the module attributes that the quarks of a machine read; each attribute is listed once.
#[must_use]
pub fn module_reads<'m>(machine: &'m Machine, alphabet: &'m Alphabet) -> BTreeSet<AttributeRead<'m>> {
    machine.quarks().iter().flat_map(|quark| reads_of(quark, alphabet)).collect()
}

fn reads_of<'m>(quark: &'m Quark, alphabet: &'m Alphabet) -> Vec<AttributeRead<'m>> {
    let declaration = alphabet.declarations_of(&quark.name).nth(quark.overload);
    let declaration = declaration.filter(|_| quark.comparison.is_none());
    let arguments = declaration.iter().flat_map(|declaration| quark.args.iter().zip(&declaration.params));
    let modules = arguments.filter_map(|(argument, param)| match argument {
        Value::Name(ParameterKind::Module, module) => Some((module.as_str(), param)),
        Value::Name(..)
        | Value::Quantity { .. }
        | Value::Infinity(_)
        | Value::Bits(_)
        | Value::Integer(_)
        | Value::Sonar(_) => None,
    });
    let read = |module, attribute| AttributeRead { module, attribute, unit: unit(attribute, alphabet) };
    let reads = modules.flat_map(|(module, param)| {
        let own = declaration.filter(|declaration| declaration.kind == DeclarationKind::Signal);
        let own = own.filter(|_| param.with.is_empty()).map(|declaration| declaration.name.as_str());
        param.with.iter().map(String::as_str).chain(own).map(move |attribute| read(module, attribute))
    });
    reads.collect()
}

/// Returns the SI unit of an attribute, which is the unit of the module signal with the attribute's name; `None` if
/// there is no such signal.
fn unit(attribute: &str, alphabet: &Alphabet) -> Option<&'static str> {
    let is_read = |declaration: &&Declaration| {
        let own = |param: &crate::alphabet::Param| param.kind == ParameterKind::Module && param.with.is_empty();
        declaration.kind == DeclarationKind::Signal && declaration.params.iter().any(own)
    };
    let signal = alphabet.declarations_of(attribute).find(is_read)?;
    signal.unit.and_then(|(unit, _)| unit.kind.base_unit()).map(|unit| unit.name)
}
