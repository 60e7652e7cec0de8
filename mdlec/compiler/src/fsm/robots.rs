//! Finds the other robots whose states a plan reads through the state link (docs/src/reference/semantics.md, 2.6).

use std::collections::BTreeSet;

use super::Machine;
use crate::alphabet::ParameterKind;
use crate::plan::{Quark, Value};

/// A `rendezvous` in the interrupt of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rendezvous<'m> {
    /// Number of the element.
    pub element: u32,
    /// Name of the other robot.
    pub robot: &'m str,
}

/// Returns the names of the robots that the quarks of a machine name, each once.
#[must_use]
pub fn other_robots(machine: &Machine) -> BTreeSet<&str> {
    machine.quarks().iter().flat_map(robots_of).collect()
}

/// Returns the `rendezvous` of each element of a machine; several with the same robot in one interrupt count
/// once.
#[must_use]
pub fn meetings(machine: &Machine) -> BTreeSet<Rendezvous<'_>> {
    let mut meetings = BTreeSet::new();
    for element in machine.elements() {
        element.condition().each_quark(&mut |id| {
            let quark = machine.quark(id);
            let robots = robots_of(quark).filter(|_| quark.name == "rendezvous");
            meetings.extend(robots.map(|robot| Rendezvous { element: element.number(), robot }));
        });
    }
    meetings
}

fn robots_of(quark: &Quark) -> impl Iterator<Item = &str> {
    quark.args.iter().filter_map(|argument| match argument {
        Value::Name(ParameterKind::Robot, robot) => Some(robot.as_str()),
        Value::Name(..)
        | Value::Quantity { .. }
        | Value::Infinity(_)
        | Value::Bits(_)
        | Value::Integer(_)
        | Value::Sonar(_) => None,
    })
}
