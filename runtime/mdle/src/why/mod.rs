//! `mdle why`: explains a turn of a recorded run, which is made again up to that turn.

mod explanation;
mod json;
mod lack;
mod never;
mod never_text;
mod operands;
mod text;

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use mdle_compiler::fsm::Machine;
use mdle_host::{Clocked, quoted};
use mdle_record::{Begin, ReadError};
use mdle_runtime::{Nanos, Printable, PrintableLines};

use explanation::{AtomWords, Explainer, Explanation};

use crate::arguments::{Question, Why};
use crate::failure::{self, Failure};
use crate::record::Record;
use crate::replay::{self, WantedPlan};
use crate::rerun::{Rerun, RerunLaws, RerunTurn, Stop};
use crate::run_time::run_time;
use crate::targets;

/// Exit status of a record that is not that of its plan.
const DIFFERS: u8 = 1;

/// The answer about a turn.
#[derive(Debug)]
struct Answer {
    explanation: Explanation,
    /// The time that was asked about.
    asked: Nanos,
    next: Next,
    /// The rule that changed the input, and how.
    safety: Option<String>,
}

/// What came after a turn.
#[derive(Debug)]
enum Next {
    /// The next turn with transitions: causes, and the atoms to which they led.
    Turn { turn: u64, t: Nanos, steps: Vec<(String, Option<AtomWords>)> },
    /// No transition up to the end of the record.
    End { t: Nanos, why: String },
}

/// Explains a turn of a record.
///
/// # Errors
/// The record or the plan cannot be read, or the record has no such turn.
pub(crate) fn why(arguments: &Why) -> Result<ExitCode, Failure> {
    let (begin, record) = replay::record(&arguments.log)?;
    let name = arguments.log.display().to_string();
    let call = match &arguments.question {
        Question::At(time) => format!("mdle why {name} {time}"),
        Question::Not(atom) => format!("mdle why {name} --not {}", quoted(atom)),
    };
    let (log, file) = (arguments.log.as_path(), arguments.plan.as_deref());
    let wanted = WantedPlan { log, file, begin: &begin, call: &call, has_run: true };
    let (machine, mut rerun) = reruns(&wanted, record)?;
    let with_laws = !begin.beside.is_empty();
    let asked = Asked { name: &name, begin: &begin, machine: &machine, with_laws };
    let answer = match &arguments.question {
        Question::At(time) => {
            let answer = at(&asked, time, &mut *rerun)?;
            answer.map(|answer| if arguments.is_json { json::object(&answer).to_string() } else { text::text(&answer) })
        }
        Question::Not(atom) => {
            let target = mdle_files::target(Some(&begin.target))?;
            let never = never::never(&machine, &target, atom, &mut *rerun).map_err(Failure::Usage)?;
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
        Err(stop) => stopped(&stop, &name, arguments.plan.as_deref()),
    }
}

/// Loads the plan that has run, to make the turns of the record again.
///
/// # Errors
/// The plan cannot be read, has errors or is not that of the record, or the run depended on more than the record has.
pub(crate) fn reruns(wanted: &WantedPlan<'_>, record: Record) -> Result<(Machine, Box<dyn Rerun>), Failure> {
    let begin = wanted.begin;
    if begin.beside.contains("modules") {
        return Err(Failure::Usage(
            "the record cannot be explained: the run depended on modules as well, which a record does not have"
                .to_owned(),
        ));
    }
    let linked = targets::linked(&begin.target).map_err(Failure::Usage)?;
    let target = mdle_files::target(Some(&begin.target))?;
    let (machine, sources) = replay::plan(wanted, &target)?;
    let laws = match (begin.beside.is_empty(), begin.files.is_empty()) {
        (true, true) => RerunLaws::Compared,
        (true, false) => RerunLaws::Needed,
        (false, _) => RerunLaws::All,
    };
    let rerun = (linked.rerun)(&machine, &sources, &target, record, laws)?;
    Ok((machine, rerun))
}

/// A record that is asked about.
struct Asked<'a> {
    name: &'a str,
    begin: &'a Begin,
    machine: &'a Machine,
    with_laws: bool,
}

/// Explains the turn at a time.
fn at(asked: &Asked<'_>, time: &str, rerun: &mut dyn Rerun) -> Result<Result<Answer, Stop>, Failure> {
    let time = run_time(time)?;
    let mut explainer = Explainer::new(asked.machine);
    let mut last = None;
    let found = loop {
        let turn = match rerun.turn(&mut |_, next| next.is_none_or(|next| next > time)) {
            Some(Ok(turn)) => turn,
            Some(Err(stop)) => return Ok(Err(stop)),
            None => return Err(outside(asked, time, last, rerun.is_whole())),
        };
        let (t, next) = (turn.recorded.t, turn.next);
        if t > time {
            return Err(Failure::Usage(format!("the record {} begins at {}", asked.name, Clocked(t))));
        }
        if next.is_some_and(|next| next > time) || next.is_none() && time.since(t) < asked.begin.period.max(Nanos(1)) {
            break turn;
        }
        explainer.pass(&turn, rerun.texts());
        last = Some((turn.recorded.number, t));
    };
    let explanation = explainer.explained(&found, rerun.texts(), asked.with_laws);
    let safety = event(&found.event, "safety").filter(|text| !text.is_empty());
    let next = match next(&mut explainer, found, rerun) {
        Ok(next) => next,
        Err(stop) => return Ok(Err(stop)),
    };
    if asked.begin.files.is_empty()
        && let Some(stop) = differing(rerun)
    {
        return Ok(Err(stop));
    }
    Ok(Ok(Answer { explanation, asked: time, next, safety }))
}

/// Makes the turns up to the end of the record; returns the reason if the plan is another one.
fn differing(rerun: &mut dyn Rerun) -> Option<Stop> {
    loop {
        match rerun.turn(&mut |_, _| false)? {
            Ok(_) => {}
            Err(stop @ Stop::Differs(..)) => return Some(stop),
            Err(Stop::Unread(_) | Stop::OtherPlan(_)) => return None,
        }
    }
}

/// Finds the next turn with a transition.
///
/// # Errors
/// The plan is another one.
fn next(explainer: &mut Explainer<'_>, found: RerunTurn, rerun: &mut dyn Rerun) -> Result<Next, Stop> {
    let (mut t, mut last) = (found.recorded.t, found.event);
    loop {
        match rerun.turn(&mut |_, _| false) {
            Some(Ok(turn)) if !turn.transitions.is_empty() => {
                let (number, t) = (turn.recorded.number, turn.recorded.t);
                return Ok(Next::Turn { turn: number, t, steps: explainer.steps(&turn, rerun.texts()) });
            }
            Some(Ok(turn)) => (t, last) = (turn.recorded.t, turn.event),
            Some(Err(stop @ Stop::Differs(..))) => return Err(stop),
            Some(Err(stop)) => return Ok(Next::End { t, why: format!(": {}", sentence(&stop)) }),
            None => {
                let why = event(&last, "end").map_or_else(String::new, |why| format!(": {why}"));
                return Ok(Next::End { t, why });
            }
        }
    }
}

/// Returns the text of an event if it is of this kind.
fn event(json: &str, kind: &str) -> Option<String> {
    let event: serde_json::Value = serde_json::from_str(json).ok()?;
    (event.get("kind")?.as_str()? == kind).then(|| event.get("text")?.as_str().map(str::to_owned))?
}

/// The message about a time after the end of the record.
fn outside(asked: &Asked<'_>, time: Nanos, last: Option<(u64, Nanos)>, is_whole: bool) -> Failure {
    let (name, time) = (asked.name, Clocked(time));
    let Some((turn, t)) = last else { return Failure::Usage(format!("the record {name} has no turns")) };
    let end = if is_whole { "ends" } else { "was cut short, and ends" };
    Failure::Usage(format!(
        "the record {name} {end} with turn {turn} at {}: it has no turn at {time}\nhelp: `mdle why {name} {}`",
        Clocked(t),
        mdle_host::rounded(t.0)
    ))
}

/// Reason why the turns up to the one that was asked about are not made again.
fn sentence(stop: &Stop) -> String {
    match stop {
        Stop::Unread(error) => error.to_string(),
        Stop::Differs(turn, difference) => format!("turn {turn} is not that of this plan: {difference}"),
        Stop::OtherPlan(t) => format!("from {} on another plan ran, which the record does not have", Clocked(*t)),
    }
}

/// Prints why the turns of the record of this name are not made again, with the plan in this file or that of the
/// record.
///
/// # Errors
/// The record cannot be read.
pub(crate) fn stopped(stop: &Stop, name: &str, plan: Option<&Path>) -> Result<ExitCode, Failure> {
    let sentence = sentence(stop);
    match stop {
        Stop::Unread(ReadError::System(_)) => {
            return Err(Failure::Usage(format!("the record {name} cannot be read: {sentence}")));
        }
        Stop::Unread(_) | Stop::OtherPlan(_) => failure::error(&format!("the record {}: {sentence}", Printable(name))),
        Stop::Differs(..) => {
            let help = match plan {
                Some(_) => "`--plan` has to name the plan that ran".to_owned(),
                None => format!("`mdle replay {name}` prints what differs"),
            };
            failure::error(&format!("the record {}: {sentence}\nhelp: {help}", Printable(name)));
        }
    }
    Ok(ExitCode::from(DIFFERS))
}
