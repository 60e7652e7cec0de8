//! The plan of a robot of a scenario: compiled, with the names of other robots in it checked.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::diagnostic::judged;
use mdle_compiler::load::{self, Loaded};
use mdle_files::{InputError, RobotGroup, Spelling};
use mdle_host::Target as _;
use mdle_runtime::Alphabet;
use mdle_sim::Sim;

use super::file::{At, RobotText, ScenarioError};
use super::room;
use super::setup_error::SetupError;
use crate::failure::{self, Failure};
use crate::input_files::InputFiles;
use crate::plans::texts;
/// A plan, and the names and texts of its files; the plan's own file comes first.
pub(super) type PlanWithFiles<A> = (Arc<Loaded<A>>, Vec<(String, String)>);

/// Compiles and loads the plan of a robot; if the file contains a group's plan, the plan for this robot of the group.
/// `robot` contains the robot and all robots of the scenario; `None` for a crowd. `A` is bound to the alphabet of the
/// simulated robot.
pub(super) fn plan<A: Alphabet>(
    file: &At<PathBuf>,
    plan_name: Option<&At<String>>,
    files: &InputFiles,
    robot: Option<(&RobotText, &[RobotText])>,
) -> Result<PlanWithFiles<A>, SetupError> {
    let (place, file) = (file.span(), files.named(file.get_ref()));
    let target = files.settings(&file)?.target(Some(Sim::NAME))?;
    let mut input = files.plan(&file, &target).map_err(|error| placed(place.clone(), error))?;
    let named = plan_name.map(|plan| plan.get_ref().as_str());
    if let (None, Some(group)) = (robot, input.group(named)) {
        let message = format!("the robots of the group `{}` have names, and those of a crowd have none", group.name);
        let help = "write a `[[robot]]` with this file for each of them, in place of the crowd";
        return Err(ScenarioError::at(place, message).help(help).into());
    }
    let group = robot.and_then(|robot| Some((robot, input.group(named)?)));
    let part = group.map(|((text, robots), group)| part(text, &names(robots), &group)).transpose()?;
    let wanted = part.as_deref().or(named);
    if let Some(name) = wanted {
        let place = plan_name.map_or(place.clone(), At::span);
        input.must_have(name).map_err(|error| placed(place, error))?;
    }
    let (plans, diagnostics) = input.compile(&target.alphabet, wanted);
    files.compiled(&input, &diagnostics);
    if let Err(sentence) = judged(&diagnostics, false) {
        failure::error(&sentence);
        return Err(SetupError::Plan(Failure::Plan));
    }
    let named = plans.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine)).collect();
    let machine = input.only(named).map_err(|error| placed(place, error))?;
    if let Some((text, robots)) = robot {
        room::check(&machine, text, robots)?;
    }
    Ok((Arc::new(load::load(&machine, &input.sources, &target.alphabet)?), texts(&input)))
}

/// Returns the error with its place in the scenario, unless the error is in the plan's own file.
fn placed(place: Range<usize>, error: InputError) -> SetupError {
    if let InputError::Faulty(_) | InputError::NamedAt { .. } = error {
        return SetupError::Plan(error.into());
    }
    let message = error.message(Spelling::Entry);
    let (message, help) = message.split_once("\nhelp: ").unwrap_or((&message, ""));
    ScenarioError::at(place, message).help(help).into()
}

/// Returns the name of the plan for this robot in a group's plan. The scenario must have all robots of the group.
fn part(text: &RobotText, names: &[&str], group: &RobotGroup) -> Result<String, ScenarioError> {
    let (own, name) = (text.name.get_ref(), &group.name);
    let robots = group.robots.join(", ");
    let Some(part) = group.plan_of(own) else {
        let known: Vec<&str> = group.robots.iter().map(String::as_str).collect();
        let message = format!("the group `{name}` has no robot `{own}`{}", did_you_mean(own, &known));
        return Err(ScenarioError::at(text.name.span(), message).help(format!("the robots of the group are {robots}")));
    };
    match group.robots.iter().find(|robot| !names.contains(&robot.as_str())) {
        None => Ok(part),
        Some(lacking) => {
            // Another robot of the group is in the scenario under its own name, so it cannot be meant.
            let is_own = |name: &str| group.robots.iter().any(|robot| robot == name);
            let strangers: Vec<&str> = names.iter().copied().filter(|name| !is_own(name)).collect();
            let near = did_you_mean(lacking, &strangers);
            let message = format!("the group `{name}` has the robot `{lacking}`, and the scenario has none{near}");
            Err(ScenarioError::at(text.file.span(), message).help(format!("the robots of the group are {robots}")))
        }
    }
}

pub(super) fn names(robots: &[RobotText]) -> Vec<&str> {
    robots.iter().map(|robot| robot.name.get_ref().as_str()).collect()
}

/// Checks that the robots that a plan names, and those whose plans the robot accepts, are other robots of the scenario.
pub(super) fn check_peers(text: &RobotText, named: &[&str], names: &[&str]) -> Result<(), ScenarioError> {
    let name = text.name.get_ref();
    let is_other = |other: &str| other != name && names.contains(&other);
    if let Some(other) = named.iter().find(|other| !is_other(other)) {
        return Err(unknown_peer(text, other, names));
    }
    let stranger = text.plans_from.iter().find(|other| !is_other(other.get_ref()));
    stranger.map_or(Ok(()), |other| Err(no_other_robot(other, name, names)))
}

/// Returns the error about a name that is not the name of another robot of the scenario.
fn no_other_robot(other: &At<String>, own: &str, names: &[&str]) -> ScenarioError {
    let others: Vec<&str> = names.iter().copied().filter(|name| *name != own).collect();
    let near = did_you_mean(other.get_ref(), &others);
    let message = format!("there is no other robot `{}`{near}", other.get_ref());
    ScenarioError::at(other.span(), message).help(format!("the other robots of the scenario are {}", others.join(", ")))
}

/// Returns the error about a robot that a plan names but that the scenario does not contain.
fn unknown_peer(text: &RobotText, other: &str, names: &[&str]) -> ScenarioError {
    let name = text.name.get_ref();
    if other == name {
        return ScenarioError::at(text.file.span(), format!("the plan of the robot `{name}` names that robot itself"));
    }
    let others: Vec<&str> = names.iter().copied().filter(|known| known != name).collect();
    let near = did_you_mean(other, &others);
    let message = format!("the plan of `{name}` names the robot `{other}`, and the scenario has none{near}");
    ScenarioError::at(text.file.span(), message).help(format!("the robots of the scenario are {}", names.join(", ")))
}
