//! Plans that robots of a scenario send to each other at given times.

use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::When;
use mdle_engine::link::LONGEST_TEXT;
use mdle_runtime::Nanos;

use super::file::{ScenarioError, ScenarioText, SentPlanText, duration};
use crate::input_files::InputFiles;

/// A plan that a robot sends.
#[derive(Debug, Clone)]
pub(super) struct SentPlan {
    /// Time at which the plan is sent.
    pub(super) at: Nanos,
    /// Name of the robot to which the plan is sent.
    pub(super) to: String,
    /// Name of the plan's file, as the scenario gives it.
    pub(super) name: String,
    pub(super) text: String,
    /// Moment at which the plan takes over.
    pub(super) when: When,
}

/// Returns the plans that the robot `own` sends, sorted by time.
///
/// # Errors
/// Fails if a value is invalid, or if a file cannot be read.
pub(super) fn sent_by(own: &str, file: &ScenarioText, files: &InputFiles) -> Result<Vec<SentPlan>, ScenarioError> {
    let names: Vec<&str> = file.robot.iter().map(|robot| robot.name.get_ref().as_str()).collect();
    let mut plans = Vec::new();
    for text in &file.sent_plan {
        if let Some(unknown) = [&text.from, &text.to].into_iter().find(|name| !names.contains(&name.get_ref().as_str()))
        {
            let (name, near) = (unknown.get_ref(), did_you_mean(unknown.get_ref(), &names));
            let message = format!("the scenario has no robot `{name}`{near}");
            let help = format!("the robots of the scenario are {}", names.join(", "));
            return Err(ScenarioError::at(unknown.span(), message).help(help));
        }
        if text.from.get_ref() == text.to.get_ref() {
            let error = ScenarioError::at(text.to.span(), "a robot sends no plan to itself");
            return Err(error.help("name another robot; a robot's own plan is the `file` of its `[[robot]]`"));
        }
        if text.from.get_ref() == own {
            plans.push(sent_plan(text, files)?);
        }
    }
    plans.sort_by_key(|plan: &SentPlan| plan.at);
    Ok(plans)
}

fn sent_plan(text: &SentPlanText, files: &InputFiles) -> Result<SentPlan, ScenarioError> {
    let at = duration(&text.at, 0.0, 1e9)?;
    let file = files.named(text.file.get_ref());
    let unread = |error| format!("the plan {} cannot be read: {error}", file.display());
    let plan = files.text(&file, LONGEST_TEXT as u64);
    let help = format!("name a file of at most {LONGEST_TEXT} bytes, by its path from the folder of the scenario");
    let plan = plan.map_err(|error| ScenarioError::at(text.file.span(), unread(error)).help(help))?;
    let when = match &text.when {
        None => When::Now,
        Some(word) => {
            let found = When::ALL.iter().find(|(name, _)| name == word.get_ref()).map(|(_, when)| *when);
            found.ok_or_else(|| ScenarioError::at(word.span(), "expected `now`, `atom` or `plan`"))?
        }
    };
    let at = Nanos(u64::try_from(at.as_nanos()).unwrap_or(u64::MAX));
    let (to, name) = (text.to.get_ref().clone(), text.file.get_ref().display().to_string());
    Ok(SentPlan { at, to, name, text: plan, when })
}
