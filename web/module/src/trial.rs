//! Performs a complete run and reports only its end, for batches of runs.

use mdle_runtime::{Nanos, Turn};
use serde_json::{Value, json};

use crate::course::{Course, CourseEnd};
use crate::plan::Plan;
use crate::setup::PageSetup;

/// Performs a run, and returns the way it ended: `over`, `limit` or `fault`. If there is a goal, also returns the
/// result that `mdle run --goal` reports: `arrived`, `bumped` or `astray`.
pub(crate) fn trial(setup: &PageSetup) -> Result<Value, String> {
    let plan = Plan::of(&setup.draft, setup.plan.as_deref())?;
    let ready = setup.ready()?;
    let mut course = Course::new(&plan, &ready, false)?;
    let mut atom = None;
    while course.end.is_none() {
        let Some(exchange) = course.exchange() else { break };
        let Some(made) = course.turn(&exchange.y) else { break };
        if matches!(made.turn, Turn::Law(_)) {
            atom = course.machine.as_ref().and_then(|machine| machine.atom());
        }
    }
    let t = Nanos(course.turns.saturating_sub(1).saturating_mul(crate::setup::PERIOD.0));
    course.release();
    course.stop();
    let (end, fault) = match &course.end {
        Some(CourseEnd::Over) => ("over", None),
        Some(CourseEnd::Fault(sentence)) => ("fault", Some(sentence.clone())),
        Some(CourseEnd::Limit) | None => ("limit", None),
    };
    let pose = course.robot.pose();
    let judged = course.judged(ready.goal.as_ref());
    let at = [pose.x.0, pose.y.0, pose.theta.degrees()];
    Ok(json!({
        "seed": setup.seed, "end": end, "fault": fault, "t": t.seconds(), "contacts": course.contacts,
        "judged": judged, "pose": at, "atom": atom,
    }))
}
