//! Compares a replay with its record: finds the first turn that differs, and its differences.

use mdle_record::{Message, MessageKind, ReadError};
use mdle_runtime::Nanos;

use crate::failure::Failure;
use crate::record::{DifferingPart, OVER};
use crate::replayer::{RecordedRun, ReplayStop, ReplayedTurn};

/// Outcome of a replay.
#[derive(Debug)]
pub(crate) enum ReplayOutcome {
    /// All turns match the record.
    Same {
        /// Number of turns.
        turns: u64,
        /// `true` if the record has an end, or if the replay ended earlier as requested.
        is_whole: bool,
    },
    /// A turn differs from the record.
    Differs(Difference),
    /// The turns up to this number match the record; the next turn cannot be read.
    Unread(u64, ReadError),
}

/// The first turn that differs from the record.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// Number of the turn, counted from 0.
    pub(crate) turn: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// The parts of the turn that differ.
    pub(crate) parts: Vec<DifferingPart>,
    /// This turn and the later turns that have transitions; empty unless they were requested.
    pub(crate) after: Vec<Parting>,
}

/// The transitions of a turn in the record and in the replay, each represented by the law that began.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Parting {
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// Laws that began in the record; `plan over` at the end of the plan.
    pub(crate) recorded: Vec<String>,
    /// Laws that began in the replay.
    pub(crate) replayed: Vec<String>,
}

/// The part of a record to replay, and the extent of the comparison.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReplayTerms {
    /// Time of the last turn to replay; `None` to replay all turns.
    pub(crate) until: Option<Nanos>,
    /// `true` if the plan continues after the first turn that differs.
    pub(crate) goes_on: bool,
}

/// Replays the turns of a record, and compares them with the record.
///
/// # Errors
/// Fails if a plan that replaced another plan during the run cannot be compiled.
pub(crate) fn replayed(replay: &mut dyn RecordedRun, terms: ReplayTerms) -> Result<ReplayOutcome, Failure> {
    let (mut turns, mut difference) = (0, None::<Difference>);
    while let Some(turn) = replay.turn() {
        let turn = match turn {
            Ok(turn) => turn,
            Err(ReplayStop::Failed(failure)) => return Err(failure),
            Err(ReplayStop::Unread(error)) if difference.is_none() => return Ok(ReplayOutcome::Unread(turns, error)),
            Err(ReplayStop::Unread(_)) => break,
        };
        let ReplayedTurn { recorded, messages, parts, laws, .. } = turn;
        let (number, t) = (recorded.number, recorded.t);
        if terms.until.is_some_and(|until| t > until) {
            return Ok(difference.map_or(ReplayOutcome::Same { turns, is_whole: true }, ReplayOutcome::Differs));
        }
        if difference.is_none() {
            if parts.is_empty() {
                turns += 1;
                continue;
            }
            difference = Some(Difference { turn: number, t, parts, after: Vec::new() });
        }
        if !terms.goes_on {
            break;
        }
        let recorded: Vec<_> = messages.iter().filter_map(law_of).collect();
        if let Some(Difference { after, .. }) = &mut difference
            && !(recorded.is_empty() && laws.is_empty())
        {
            after.push(Parting { t, recorded, replayed: laws });
        }
    }
    Ok(difference.map_or(ReplayOutcome::Same { turns, is_whole: replay.is_whole() }, ReplayOutcome::Differs))
}

/// Returns the law that began with a transition of the record, or [`OVER`] for the end of the plan; `None` for any
/// other message.
fn law_of(message: &Message) -> Option<String> {
    let transition: serde_json::Value = serde_json::from_str(&message.json).ok()?;
    (message.kind == MessageKind::Transition)
        .then(|| transition.get("law").and_then(serde_json::Value::as_str).unwrap_or(OVER).to_owned())
}
