//! The clock of a session: pauses and resumes the run, runs single turns, and sets the pace of stepped time.

use std::time::Duration;

use mdle_host::{Break, Lateness, Pace, Pilot, Time};
use mdle_quantity::Quantity;
use mdle_runtime::Nanos;

use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value, ValueKind, read};

/// Kind of attributes in seconds.
const SECONDS: ValueKind = ValueKind::Quantity(Quantity::Time, "s");
/// Kind of attributes in milliseconds.
const MILLISECONDS: ValueKind = ValueKind::Quantity(Quantity::Time, "ms");

/// The clock of a session.
#[derive(Debug)]
pub(super) struct SessionClock {
    period: Duration,
    /// Requested pace of stepped time; `None` in real time.
    pace: Option<Pace>,
    /// Requested pace that the run has not adopted yet; `None` if the run has adopted the last requested pace.
    pub(super) ordered: Option<Pace>,
    pub(super) is_paused: bool,
    /// Number of turns of the run after which the clock is paused again, and the reply to send then; `None` if no
    /// request for single turns is pending.
    steps: Option<(u64, Reply)>,
    /// Requests that wait for a time or for the end of the plan. Each contains the time, `true` if the clock is to be
    /// paused then, and the reply.
    waits: Vec<(Nanos, bool, Reply)>,
    /// Number of turns, and time of the last turn, as answers show them.
    now: String,
}

impl SessionClock {
    pub(super) fn new(period: Duration, time: Time, is_paused: bool) -> Self {
        let pace = match time {
            Time::Wall => None,
            Time::Stepped(pace) => Some(pace),
        };
        let is_paused = is_paused && pace.is_some();
        Self { period, pace, ordered: None, is_paused, steps: None, waits: Vec::new(), now: String::new() }
    }

    /// Answers requests that have waited for this turn or time.
    pub(super) fn made<B: Pilot>(&mut self, moment: &Break<'_, B>) {
        let now = said(moment);
        if let Some((_, reply)) = self.steps.take_if(|(turns, _)| moment.turns >= *turns || moment.is_over) {
            self.is_paused = true;
            reply.answer(Answer::Done(now.clone()));
        }
        let waits = std::mem::take(&mut self.waits);
        for (until, stands, reply) in waits {
            if moment.is_over || moment.turns > 0 && moment.t >= until {
                self.is_paused |= stands;
                reply.answer(Answer::Done(now.clone()));
            } else {
                self.waits.push((until, stands, reply));
            }
        }
    }

    /// Saves the last state of a run that has ended before its plan.
    pub(super) fn at_end<B: Pilot>(&mut self, moment: &Break<'_, B>) {
        self.now = said(moment);
    }

    /// Answers the pending requests at the end of the run, with the reason for the end and the exit status.
    pub(super) fn ended(&mut self, why: &str, status: u8) {
        let steps = self.steps.take().map(|(_, reply)| reply);
        let waits = std::mem::take(&mut self.waits).into_iter().map(|(_, _, reply)| reply);
        let colon = if why.is_empty() { "" } else { ": " };
        let sentence = format!("{}, and the run has ended with exit status {status}{colon}{why}", self.now);
        steps.into_iter().chain(waits).for_each(|reply| reply.answer(Answer::Done(sentence.clone())));
    }

    fn step<B: Pilot>(&mut self, arguments: &[String], moment: &Break<'_, B>, reply: Reply) {
        let count = match arguments {
            [] => Ok(1),
            [count] => match read(count, ValueKind::Integer) {
                Ok(Value::Integer(count @ 1..)) => Ok(count.unsigned_abs()),
                Ok(_) => Err("`step` takes a number of turns from 1".to_owned()),
                Err(refusal) => Err(format!("`step`: {refusal}")),
            },
            [_, _, ..] => Err("`step` takes one number of turns".to_owned()),
        };
        match count {
            Err(refusal) => reply.answer(Answer::Refused(refusal)),
            Ok(_) if self.pace.is_none() => reply.answer(Answer::Refused(REAL.to_owned())),
            Ok(count) => {
                self.is_paused = false;
                self.steps = Some((moment.turns.saturating_add(count), reply));
            }
        }
    }

    fn wait<B: Pilot>(&mut self, arguments: &[String], moment: &Break<'_, B>, reply: Reply) {
        let time = match arguments {
            [] => Ok(Nanos::MAX),
            [time] => match read(time, SECONDS) {
                Ok(Value::Quantity(seconds, _)) => Duration::try_from_secs_f64(seconds)
                    .map(|time| Nanos(moment.t.0.saturating_add(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))))
                    .map_err(|_| format!("`wait` takes a time of at least 0s; found `{time}`")),
                Ok(_) => Err("`wait` takes a time".to_owned()),
                Err(refusal) => Err(format!("`wait`: {refusal}")),
            },
            [_, _, ..] => Err("`wait` takes one time".to_owned()),
        };
        match time {
            Err(refusal) => reply.answer(Answer::Refused(refusal)),
            Ok(until) => self.waits.push((until, std::mem::take(&mut self.is_paused), reply)),
        }
    }

    fn set_pace(&mut self, text: &str) -> Answer {
        let number = text.parse().ok().filter(|times: &f64| times.is_finite() && *times > 0.0);
        let pace = if text == "max" { Some(Pace::Max) } else { number.map(Pace::Times) };
        match (pace, &mut self.pace) {
            (_, None) => Answer::Refused(REAL.to_owned()),
            (None, Some(_)) => {
                Answer::Refused(format!("`/clock/pace`: expected a number above 0 or `max`, found `{text}`"))
            }
            (Some(pace), Some(kept)) => {
                (*kept, self.ordered) = (pace, Some(pace));
                Answer::Done(String::new())
            }
        }
    }
}

/// Answer to a request to change the clock in real time.
const REAL: &str = "the time of a real robot goes on by itself";

/// Returns the number of turns and the time at a turn break, as shown in answers.
fn said<B: Pilot>(moment: &Break<'_, B>) -> String {
    let (turns, t) = (moment.turns, Value::Quantity(moment.t.seconds(), "s"));
    let word = if turns == 1 { "turn" } else { "turns" };
    let over = if moment.is_over { ", and the plan is over" } else { "" };
    format!("{turns} {word}, {t}{over}")
}

/// Returns the values that describe how late turns begin; a simulated robot has no such values.
fn late(lateness: Option<Lateness>) -> [Option<Value>; 4] {
    let Some(Lateness { p50, p99, max, missed }) = lateness else { return [const { None }; 4] };
    let [p50, p99, max] = [p50, p99, max].map(|time| Some(Value::milliseconds(time)));
    [p50, p99, max, Some(Value::count(missed))]
}

impl<B: Pilot> Served<Break<'_, B>> for SessionClock {
    fn nodes(&self, _: &Break<'_, B>) -> Vec<(String, Node)> {
        let nodes = [
            ("now", Node::reading(SECONDS, "time of the last turn")),
            ("turns", Node::reading(ValueKind::Integer, "number of turns that have been made")),
            ("period", Node::reading(SECONDS, "time from the start of a turn to the start of the next")),
            (
                "pace",
                Node::setting(ValueKind::Text, Role::Tune, "pace of simulated time: a multiple of real time, or `max`"),
            ),
            ("state", Node::reading(ValueKind::Text, "`runs` or `stands`")),
            ("late/p50", Node::reading(MILLISECONDS, "half of the turns of a real robot began at most this late")),
            ("late/p99", Node::reading(MILLISECONDS, "99 of 100 turns of a real robot began at most this late")),
            ("late/max", Node::reading(MILLISECONDS, "maximum time by which a turn of a real robot began late")),
            ("missed", Node::reading(ValueKind::Integer, "number of turns that the turn before them left no time for")),
            ("pause", Node::method(Role::Tune, "stops simulated time after this turn")),
            ("resume", Node::method(Role::Tune, "lets simulated time go on")),
            ("step", Node::method(Role::Tune, "makes one turn, or as many as the argument says, and stops the time")),
            (
                "wait",
                Node::method(
                    Role::Tune,
                    "answers after a time, or at the end of the plan; a clock that stands goes on until then",
                ),
            ),
        ];
        nodes.map(|(name, node)| (format!("/clock/{name}"), node)).into()
    }

    fn values(&self, moment: &Break<'_, B>, to: &mut Vec<Option<Value>>) {
        let pace = match self.pace {
            None => "real".to_owned(),
            Some(Pace::Max) => "max".to_owned(),
            Some(Pace::Times(times)) => times.to_string(),
        };
        let state = if self.is_paused { "stands" } else { "runs" };
        to.extend([
            Some(Value::Quantity(moment.t.seconds(), "s")),
            Some(Value::count(moment.turns)),
            Some(Value::Quantity(self.period.as_secs_f64(), "s")),
            Some(Value::Text(pace.into())),
            Some(Value::text(state)),
        ]);
        to.extend(late(moment.lateness()));
        to.extend([const { None }; 4]);
    }

    fn change(&mut self, path: &str, change: &Change, moment: &mut Break<'_, B>, reply: Reply) {
        match (path, change) {
            ("/clock/step", Change::Call(arguments)) => return self.step(arguments, moment, reply),
            ("/clock/wait", Change::Call(arguments)) => return self.wait(arguments, moment, reply),
            (_, Change::Set(text)) => return reply.answer(self.set_pace(text)),
            (_, Change::Call(arguments)) if !arguments.is_empty() => {
                return reply.answer(Answer::Refused(format!("`{path}` takes no arguments")));
            }
            (_, Change::Call(_)) if self.pace.is_none() => return reply.answer(Answer::Refused(REAL.to_owned())),
            (_, Change::Call(_)) => self.is_paused = path == "/clock/pause",
        }
        reply.answer(Answer::Done(said(moment)));
    }
}
