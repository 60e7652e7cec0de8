//! Checks the heads of groups. Also checks that no other plan contains or uses the plan of a group.

use std::collections::BTreeSet;

use mdle_runtime::PEERS;

use super::part_name;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Files;
use crate::syntax::tree::{Arg, Call, Element, Name, Plan, Primary};

/// Returns the robots of a group, beginning with the robot that makes the decisions; `None` if there are fewer than two
/// or too many. Reports errors in the head of the group.
pub(super) fn named<'s>(plan: &Plan<'s>, written: &[Arg<'s>], found: &mut Vec<Diagnostic>) -> Option<Vec<Name<'s>>> {
    let first = found.len();
    if let [param, ..] = plan.params {
        let report =
            Diagnostic::new(Code::E0208, "the plan of a group has no parameters", param.name.span, "a parameter");
        found.push(report.help("write the value in each place"));
    }
    let mut robots: Vec<Name<'s>> = Vec::new();
    for robot in written {
        let Arg::Name(name) = robot else {
            let report = Diagnostic::new(Code::E0208, "expected the name of a robot", robot.span(), "not a name");
            found.push(report.help("a group names its robots: `{ Group [robot1 robot2] Name … }`"));
            continue;
        };
        match robots.iter().find(|known| known.node == name.node) {
            Some(known) => {
                let message = format!("the group names `{}` twice", name.node);
                let report = Diagnostic::new(Code::E0208, message, name.span, "the second time");
                found.push(report.also(known.span, "the first time").help("give each robot a name of its own"));
            }
            None => robots.push(*name),
        }
    }
    if let ([] | [_], true) = (robots.as_slice(), found.len() == first) {
        let name = plan.name.node;
        let (count, span) = robots.first().map_or(("no robot", plan.name.span), |only| ("one robot", only.span));
        let message = format!("the group `{name}` has {count}, and a group has two or more");
        let report = Diagnostic::new(Code::E0208, message, span, "no other robot");
        found.push(report.help(format!(
            "for one robot leave out the group, `any`, `all` and the name of the robot before a dot: `{{ {name} … }}`"
        )));
    }
    // The state link of a robot keeps the states of `PEERS` other robots.
    if let Some(extra) = robots.get(1 + PEERS) {
        let (name, count, most) = (plan.name.node, robots.len(), 1 + PEERS);
        let message = format!("the group `{name}` has {count} robots, and a group has {most} at most");
        let report = Diagnostic::new(Code::E0208, message, extra.span, "one robot too many");
        found.push(report.help("make several groups, each with a plan of its own"));
        return None;
    }
    (robots.len() > 1).then_some(robots)
}

/// Reports each group plan that is written inside another plan.
pub(super) fn misplaced(files: &Files<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for plan in &files.plans {
        visit(plan.elements, &mut |element| {
            if let Primary::Plan(inner) = element.primary
                && inner.group.is_some()
            {
                let message = format!("the group `{}` is within the plan `{}`", inner.name.node, plan.name.node);
                let report = Diagnostic::new(Code::E0208, message, inner.name.span, "not expected here");
                found.push(report.help("the plan of a group is not part of another one: put it outside of all braces"));
            }
        });
    }
    found
}

/// Reports plans that use a group's plan, or the plan of one of the group's robots, by name.
pub(super) fn uses_of_groups(files: &Files<'_>) -> Vec<Diagnostic> {
    let (mut groups, mut parts) = (BTreeSet::new(), BTreeSet::new());
    for plan in &files.plans {
        let Some(robots) = plan.group else { continue };
        groups.insert(plan.name.node);
        parts.extend(robots.iter().filter_map(|robot| match robot {
            Arg::Name(robot) => Some(part_name(plan.name.node, robot.node)),
            Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) | Arg::Module(_) => None,
        }));
    }
    let mut found = Vec::new();
    for plan in files.plans.iter().filter(|plan| plan.group.is_none()) {
        visit(plan.elements, &mut |element| match element.primary {
            Primary::Ref(call) if groups.contains(call.name) => found.push(used(call)),
            Primary::Ref(call) if parts.contains(call.name) => found.push(part_used(call)),
            Primary::Ref(_)
            | Primary::Atom(_)
            | Primary::Plan(_)
            | Primary::Exec(_)
            | Primary::String(_)
            | Primary::Formal(_)
            | Primary::Broken => {}
        });
    }
    found
}

/// Reports a group and a plan with the same name. Later stages see only the plans of the robots, which have other
/// names.
pub(super) fn equal_names(files: &Files<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, plan) in files.plans.iter().enumerate() {
        let before = files.plans.get(..index).unwrap_or(&[]);
        let first = before
            .iter()
            .find(|other| other.name.node == plan.name.node && (other.group.is_some() != plan.group.is_some()));
        if let Some(first) = first {
            let message = format!("there are two plans called `{}`", plan.name.node);
            let report = Diagnostic::new(Code::E0203, message, plan.name.span, "the second one");
            found.push(report.also(first.name.span, "the first one").help("give one of them another name"));
        }
    }
    found
}

/// Reports the use of a group's plan by name.
pub(super) fn used(call: &Call<'_>) -> Diagnostic {
    let message = format!("the group `{}` cannot be part of a plan", call.name);
    let report = Diagnostic::new(Code::E0208, message, call.name_span(), "the plan of a group");
    report.help("a group has plans for several robots, and runs by itself")
}

/// Reports the use by name of a plan that is for one robot of a group. Such a plan must run by itself, because the
/// other robots count its atoms from the beginning.
pub(super) fn part_used(call: &Call<'_>) -> Diagnostic {
    let message = format!("`{}` is the plan of a robot of a group, and cannot be part of a plan", call.name);
    let report = Diagnostic::new(Code::E0208, message, call.name_span(), "the plan of a robot of a group");
    report.help("the other robots of the group count its atoms from the start: it runs by itself")
}

/// Calls `act` with each of these elements and with all elements inside them.
fn visit<'s>(elements: &[Element<'s>], act: &mut impl FnMut(&Element<'s>)) {
    for element in elements {
        act(element);
        match element.primary {
            Primary::Plan(plan) => visit(plan.elements, act),
            Primary::Exec(exec) => visit(exec.body, act),
            Primary::String(body) => visit(body, act),
            Primary::Formal(formal) => visit(formal.body, act),
            Primary::Atom(_) | Primary::Ref(_) | Primary::Broken => {}
        }
    }
}
