//! Finds the other robots whose states a plan reads over the state link (docs/src/reference/semantics.md, 2.6).

use std::collections::BTreeSet;

use super::Machine;
use crate::alphabet::ParameterKind;
use crate::plan::{Quark, Value};

/// A `rendezvous` that occurs in the interrupt of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rendezvous<'m> {
    /// Number of the element.
    pub element: u32,
    /// Name of the other robot.
    pub robot: &'m str,
}

/// A place that a robot keeps relative to another robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormationPlace<'m> {
    /// Name of the other robot.
    pub robot: &'m str,
    /// Distance ahead of the other robot, in metres.
    pub ahead: f64,
    /// Distance to the left of the other robot, in metres.
    pub left: f64,
}

/// Returns the names of other robots that occur in the quarks of a machine; each name is listed once.
#[must_use]
pub fn other_robots(machine: &Machine) -> BTreeSet<&str> {
    machine.quarks().iter().flat_map(robots_of).collect()
}

/// Returns the `rendezvous` in the interrupt of each element of a machine. If an interrupt contains several with the
/// same robot, only one is returned.
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

/// Returns the places that the `slot` laws of a machine keep.
pub fn formation_places(machine: &Machine) -> impl Iterator<Item = FormationPlace<'_>> {
    machine.quarks().iter().filter(|quark| quark.name == "slot").filter_map(|quark| {
        let [_, ahead, left] = &quark.args[..] else { return None };
        Some(FormationPlace { robot: robots_of(quark).next()?, ahead: ahead.in_si(), left: left.in_si() })
    })
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
