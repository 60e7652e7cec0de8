//! Returns the data from which a page draws a turn. Numbers are rounded for drawing; the files of a run contain all
//! digits.

use std::collections::BTreeMap;

use mdle_compiler::load::PlanMoment;
use mdle_runtime::capability::SonarRing as _;
use mdle_runtime::{Cause, Nanos, SONARS, SonarId};
use mdle_simulator::{Point, echoes};
use serde_json::{Value, json};

use crate::causes::cause;
use crate::course::{Course, CourseExchange, CourseTurn};

/// Maximum number of transitions per turn that a page receives.
const TRANSITIONS_MOST: usize = 40;

/// Returns a turn as JSON; `before` is the time of the previous exchange.
pub(crate) fn frame(course: &Course, exchange: &CourseExchange, made: &CourseTurn, before: Option<Nanos>) -> Value {
    let CourseExchange { t, y, .. } = exchange;
    let pose = course.robot.pose();
    let ranges: Vec<Value> = (0..SONARS).map(|number| range(exchange, number)).collect();
    let heard = echoes(&pose, y, before).into_iter().flatten().map(|Point { x, y }| json!([round(x), round(y)]));
    let gone: Vec<Value> =
        course.robot.gone().map(|gone| gone.map_or(Value::Null, |at| json!([round(at.x), round(at.y)]))).collect();
    json!({
        "t": t.seconds(),
        "pose": [round(pose.x.0), round(pose.y.0), round(pose.theta.0)],
        "velocity": [round(y.velocity.v.0), round(y.velocity.omega.0)],
        "odometry": [round(y.odometry.x.0), round(y.odometry.y.0), round(y.odometry.theta.0)],
        "battery": round(y.supply.battery.0),
        "touches": course.touches,
        "ranges": ranges,
        "echoes": heard.collect::<Vec<_>>(),
        "gone": gone,
        "atom": course.machine.as_ref().and_then(|machine| machine.atom()),
        "began": made.began.is_some(),
        "since": since(made.moments.last()),
        "skipped": skipped(&made.moments),
        "made": course.seen.transitions.len(),
        "fired": fired(course),
    })
}

/// Returns the range of the newest ping of a sonar; null if there was no echo.
fn range(exchange: &CourseExchange, number: usize) -> Value {
    let sonar = SonarId::new(u8::try_from(number).unwrap_or(0));
    let newest = exchange.y.pings(sonar).newest_first().next();
    newest.and_then(|ping| ping.range).map_or(Value::Null, |range| json!(round(range.0)))
}

/// Returns two times: the time since the entry of the innermost scope that encloses the current atom, and the time
/// since the entry of the atom. Returns an empty list if the atom has ended.
fn since(moment: Option<&PlanMoment>) -> Value {
    let scopes = moment.filter(|moment| moment.cause.is_none()).map_or(&[][..], |moment| &moment.scopes);
    let inner = scopes.get(scopes.len().saturating_sub(2)..).unwrap_or(scopes);
    inner.iter().map(|scope| round(scope.since.seconds())).collect()
}

/// Returns the atoms that ended in the turn in which they were entered, each with the number of times that this
/// happened.
fn skipped(moments: &[PlanMoment]) -> Value {
    let mut times = BTreeMap::<u32, u32>::new();
    for moment in moments.iter().filter(|moment| moment.cause.is_some() && moment.is_new()) {
        *times.entry(moment.atom).or_default() += 1;
    }
    times.into_iter().map(|(atom, times)| json!([atom, times])).collect()
}

/// Returns the transitions of the turn, each with the scope that ended, the cause, and the atom that followed. If there
/// are too many, only the first ones and the last one are returned.
fn fired(course: &Course) -> Value {
    let Some(machine) = &course.machine else { return json!([]) };
    let all = &course.seen.transitions;
    let shown = all.iter().enumerate().filter(|(number, _)| *number < TRANSITIONS_MOST || number + 1 == all.len());
    let transition = |(_, (transition, operands)): (_, &(mdle_runtime::Transition, Vec<_>))| {
        json!({
            "scope": transition.scope,
            "completed": matches!(transition.cause, Cause::Completed(_)),
            "by": cause(machine.plan(), transition, operands),
            "to": transition.atom,
        })
    };
    shown.map(transition).collect()
}

/// Rounds a number to four decimal places: to a tenth of a millimetre or of a milliradian.
fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
