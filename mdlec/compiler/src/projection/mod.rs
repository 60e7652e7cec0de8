//! Projects the plan of a group of robots: creates a plan for each robot (docs/src/reference/semantics.md, 2.7; paper,
//! sections II-C and III-G).
//!
//! A projected plan is a tree with spans in the group's text, so later stages do not depend on groups.

mod build;
mod conditions;
mod elements;
mod formation;
mod owners;
mod print;
mod robots;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use crate::alphabet::{Alphabet, Capability};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::Plan;
use crate::syntax::{Arena, Files};

pub use print::projected;

/// The plan of one robot of a group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RobotPlan {
    /// Name of the group's plan.
    pub group: String,
    /// Name of the robot.
    pub robot: String,
    /// Name of the robot's own plan.
    pub plan: String,
    /// Meetings as written in the group's plan, such as `all rendezvous`, each with the interrupts that replace it in
    /// the first robot's plan; empty for all other robots.
    pub meetings: BTreeMap<String, BTreeSet<String>>,
}

impl RobotPlan {
    /// Translates a text of the group's plan to texts of the robot's own plan: `a.x > 7m` becomes `x > 7m`, and a
    /// meeting becomes all interrupts that replace it in the robot's plan.
    #[must_use]
    pub fn own_words(&self, text: &str) -> Vec<String> {
        let words: Vec<_> = text.split_whitespace().collect();
        if let Some(meeting) = self.meetings.get(&words.join(" ")) {
            return meeting.iter().cloned().collect();
        }
        let text = text.trim();
        let of_robot = text.strip_prefix(&*self.robot).and_then(|rest| rest.strip_prefix('.'));
        let of_any = text.strip_prefix(owners::ANY).filter(|rest| rest.starts_with(char::is_whitespace));
        vec![of_robot.or(of_any).map_or(text, str::trim_start).to_owned()]
    }
}

/// Replaces the plan of each group with the plans of its robots. Returns a [`RobotPlan`] for each of the new plans, and
/// the errors in groups.
pub fn project<'s>(files: &mut Files<'s>, arena: &'s Arena, alphabet: &Alphabet) -> (Vec<RobotPlan>, Vec<Diagnostic>) {
    let mut found = robots::misplaced(files);
    if files.plans.iter().all(|plan| plan.group.is_none()) {
        return (Vec::new(), found);
    }
    let uses = robots::uses_of_groups(files);
    // Uses of groups are reported here, so that they are not reported again as uses of missing plans.
    files.is_incomplete |= !uses.is_empty();
    found.extend(uses);
    found.extend(robots::equal_names(files));
    let (mut plans, mut parts, mut own) = (Vec::new(), Vec::new(), 0);
    for (index, plan) in files.plans.iter().enumerate() {
        let before = plans.len();
        match plan.group {
            None => plans.push(*plan),
            Some(_) if lacks_link(alphabet) => found.push(no_link(plan)),
            Some(written) => match robots::named(plan, written, &mut found) {
                Some(robots) => {
                    let (projected, mut meetings) = elements::plans(plan, &robots, arena, alphabet, &mut found);
                    parts.extend(projected.iter().zip(&robots).map(|(own, robot)| RobotPlan {
                        group: plan.name.node.to_owned(),
                        robot: robot.node.to_owned(),
                        plan: own.name.node.to_owned(),
                        // Only the first robot has meetings.
                        meetings: std::mem::take(&mut meetings),
                    }));
                    plans.extend(projected);
                }
                None => files.is_incomplete = true,
            },
        }
        if index < files.own {
            own += plans.len() - before;
        }
    }
    files.is_incomplete |= found.iter().any(|diagnostic| diagnostic.code == Code::E0403);
    (files.plans, files.own) = (plans, own);
    (parts, found)
}

/// Returns the name of the plan of `robot` in the group called `group`.
#[must_use]
pub fn part_name(group: &str, robot: &str) -> String {
    format!("{group}_{robot}")
}

/// Returns `true` if the plan is for an executable of a robot that has the state link only in an engine.
fn lacks_link(alphabet: &Alphabet) -> bool {
    let link = Capability { name: "state_link".to_owned(), size: None };
    !alphabet.has(&link) && alphabet.needs_engine(&link)
}

/// Reports a group whose plan would have to become an executable.
fn no_link(plan: &Plan<'_>) -> Diagnostic {
    let name = plan.name.node;
    let message = format!("the group `{name}` needs the state link, and an executable has none");
    Diagnostic::new(Code::E0403, message, plan.name.span, "needs an engine").help(
        "`mdle run PLAN --target TARGET --link LINK.toml` runs the part of the robot that LINK.toml names, and with `--engine` \
         mdlec builds an executable that does; `mdle run --help` lists the targets; `mdle run SCENARIO.toml` runs all of \
         them, simulated",
    )
}
