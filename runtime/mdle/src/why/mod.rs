//! `mdle why`: explains a turn of a recorded run. To do this, it replays the run up to that turn.

mod explanation;
mod json;
mod lack;
mod never;
mod never_text;
mod operands;
mod part_text;
mod scopes;
mod text;

use std::io::{self, Write as _};
use std::process::ExitCode;

use mdle_host::{Clocked, quoted};
use mdle_record::Begin;
use mdle_runtime::{Nanos, PrintableLines};

use explanation::{AtomWords, Explainer, Explanation};

use crate::arguments::{Question, Why};
use crate::examined::{ExaminedRun, ExaminedStop, ExaminedTurn};
use crate::failure::{self, Failure};
use crate::replay::{self, WantedPlan};
use crate::run_time::run_time;

/// The answer to a question about a turn.
#[derive(Debug)]
struct TurnAnswer {
    explanation: Explanation,
    /// Time that the question names.
    asked: Nanos,
    next: NextEvents,
    /// Safety rule that changed the input, and the effect of the rule; `None` if no rule changed the input.
    safety: Option<String>,
}

/// The events after a turn.
#[derive(Debug)]
enum NextEvents {
    /// The next turn with transitions. Contains the causes of the transitions, and the atoms to which they led.
    Turn { turn: u64, t: Nanos, steps: Vec<(String, Option<AtomWords>)> },
    /// There is no further transition in the record. Contains the time of the record's end, and the reason for the end.
    End { t: Nanos, why: String },
}

/// Explains a turn of a record.
///
/// # Errors
/// Fails if the record or the plan cannot be read, or if the record has no such turn.
pub(crate) fn why(arguments: &Why) -> Result<ExitCode, Failure> {
    let (begin, record) = replay::record(&arguments.log)?;
    let name = arguments.log.display().to_string();
    let call = match &arguments.question {
        Question::At(time) => format!("mdle why {name} {time}"),
        Question::Not(atom) => format!("mdle why {name} --not {}", quoted(atom)),
    };
    let (log, file) = (arguments.log.as_path(), arguments.plan.as_deref());
    let wanted = WantedPlan { log, file, begin: &begin, call: &call, has_run: true };
    let mut run = ExaminedRun::of(&wanted, record)?;
    let with_laws = !begin.beside.is_empty();
    let asked = RecordQuery { name: &name, begin: &begin, with_laws };
    let answer = match &arguments.question {
        Question::At(time) => {
            let answer = at(&asked, time, &mut run)?;
            answer.map(|answer| if arguments.is_json { json::object(&answer).to_string() } else { text::text(&answer) })
        }
        Question::Not(atom) => {
            let target = mdle_files::target(Some(&begin.target))?;
            let never = never::never(&target, atom, &mut run).map_err(Failure::Usage)?;
            never.map(|never| {
                if arguments.is_json { json::absence(&never).to_string() } else { never_text::text(&never, &name) }
            })
        }
    };
    match answer {
        Ok(answer) => {
            let text = PrintableLines(answer.trim_end()).to_string();
            writeln!(io::stdout().lock(), "{text}").map_err(|error| failure::unprinted(&error))?;
            Ok(ExitCode::SUCCESS)
        }
        Err(stop) => stop.tell(&name, arguments.plan.as_deref()),
    }
}

/// A record, and the question about it.
struct RecordQuery<'a> {
    name: &'a str,
    begin: &'a Begin,
    with_laws: bool,
}

/// Explains the turn at the time `time`.
fn at(asked: &RecordQuery<'_>, time: &str, run: &mut ExaminedRun) -> Result<Result<TurnAnswer, ExaminedStop>, Failure> {
    let time = run_time(time)?;
    let mut explainer = Explainer::default();
    let mut last = None;
    let found = loop {
        let turn = match run.turn() {
            Some(Ok(turn)) => turn,
            Some(Err(stop)) => return Ok(Err(stop)),
            None => return Err(outside(asked, time, last, run.is_whole())),
        };
        let (t, next) = (turn.recorded.t, turn.next);
        if t > time {
            return Err(Failure::Usage(format!("the record {} begins at {}", asked.name, Clocked(t))));
        }
        explainer.begin(&turn);
        if next.is_some_and(|next| next > time) || next.is_none() && time.since(t) < asked.begin.period.max(Nanos(1)) {
            break turn;
        }
        if let Some(plan) = run.plan() {
            explainer.pass(&turn, &*plan.texts);
        }
        last = Some((turn.recorded.number, t));
    };
    let replaced = explainer.replaced().and_then(|number| run.plan_of(number)).map(|plan| &**plan);
    let explanation = explainer.explained(&found, run.plan().map(|plan| &**plan), replaced, asked.with_laws);
    let safety = Some(found.safety.clone()).filter(|text| !text.is_empty());
    let next = match next(&mut explainer, found, run) {
        Ok(next) => next,
        Err(stop) => return Ok(Err(stop)),
    };
    if asked.begin.files.is_empty()
        && let Some(stop) = differing(run)
    {
        return Ok(Err(stop));
    }
    Ok(Ok(TurnAnswer { explanation, asked: time, next, safety }))
}

/// Replays the turns up to the end of the record. Returns the reason if a turn does not match the record, or if a plan
/// of the record cannot be compiled.
fn differing(run: &mut ExaminedRun) -> Option<ExaminedStop> {
    loop {
        match run.turn()? {
            Ok(_) => {}
            Err(stop @ (ExaminedStop::Differs(..) | ExaminedStop::Failed(_))) => return Some(stop),
            Err(ExaminedStop::Unread(_)) => return None,
        }
    }
}

/// Finds the next turn with a transition, or in which another plan takes over.
///
/// # Errors
/// Fails if the plan is not the plan of the record.
fn next(explainer: &mut Explainer, found: ExaminedTurn, run: &mut ExaminedRun) -> Result<NextEvents, ExaminedStop> {
    let (mut t, mut end) = (found.recorded.t, found.end);
    let mut had_plan = run.plan().is_some();
    loop {
        match run.turn() {
            Some(Ok(turn)) => {
                let is_other = explainer.begin(&turn);
                let begins = !std::mem::replace(&mut had_plan, run.plan().is_some()) && had_plan;
                let plan = run.plan().filter(|_| is_other || begins || !turn.transitions.is_empty());
                let Some(plan) = plan else {
                    (t, end) = (turn.recorded.t, turn.end);
                    continue;
                };
                let mut steps = Vec::new();
                if is_other || begins {
                    let first = turn.moments.first().map(|moment| explainer.atom(&*plan.texts, moment.atom));
                    let began = explainer.began();
                    steps.push((if began.is_empty() { "the start of the plan".to_owned() } else { began }, first));
                }
                steps.extend(explainer.steps(&turn, &*plan.texts));
                return Ok(NextEvents::Turn { turn: turn.recorded.number, t: turn.recorded.t, steps });
            }
            Some(Err(stop @ (ExaminedStop::Differs(..) | ExaminedStop::Failed(_)))) => return Err(stop),
            Some(Err(stop @ ExaminedStop::Unread(_))) => {
                return Ok(NextEvents::End { t, why: format!(": {}", stop.sentence()) });
            }
            None => {
                let why = end.map_or_else(String::new, |why| format!(": {why}"));
                return Ok(NextEvents::End { t, why });
            }
        }
    }
}

/// Returns the message about a time after the end of the record.
fn outside(asked: &RecordQuery<'_>, time: Nanos, last: Option<(u64, Nanos)>, is_whole: bool) -> Failure {
    let (name, time) = (asked.name, Clocked(time));
    let Some((turn, t)) = last else { return Failure::Usage(format!("the record {name} has no turns")) };
    let end = if is_whole { "ends" } else { "was cut short, and ends" };
    Failure::Usage(format!(
        "the record {name} {end} with turn {turn} at {}: it has no turn at {time}\nhelp: `mdle why {name} {}`",
        Clocked(t),
        mdle_host::rounded(t.0)
    ))
}
