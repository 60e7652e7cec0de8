//! Writes and reads a turn of a record: the output, the input that was sent, the transitions and the plan's state.

use mdle_runtime::{Cause, Nanos, Sensed, Transition, Twist};

use crate::bytes::{ByteReader, put_u32, put_u64};
use crate::change::{put_changes, put_overruled, take_changes, take_overruled};
use crate::exact::{self, put_twist, take_twist};
use crate::{Constants, Overruled, RecordedChange};

/// A turn of a current run, without its output.
#[derive(Debug, Clone, Copy)]
pub struct TurnMade<'a> {
    /// Number of the turn, counted from 0.
    pub number: u64,
    /// Time of the turn in the run.
    pub t: Nanos,
    /// Input that was sent after the output.
    pub sent: Twist,
    /// Source of the input.
    pub applied: Applied,
    /// Number of the plan that ran, counting from 1.
    pub plan: u64,
    /// State of the plan at the end of the turn; 0 if no plan ran.
    pub state: u64,
    /// Changes that influence the turn, in addition to its output.
    pub changes: &'a [RecordedChange],
    /// Input that a safety rule changed; `None` if no rule changed it.
    pub overruled: Option<&'a Overruled>,
}

/// Reason why a turn cannot be decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Undecoded {
    /// The checksum over this content and all earlier contents differs: bytes were changed.
    Changed,
    /// The bytes are neither the beginning of a record nor a turn.
    Unreadable,
}

/// A turn of a recorded run.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedTurn {
    /// Number of the turn, counted from 0.
    pub number: u64,
    /// Time of the turn in the run.
    pub t: Nanos,
    /// Output of the robot.
    pub y: Sensed,
    /// Input that was sent after the output.
    pub sent: Twist,
    /// Source of the input.
    pub applied: Applied,
    /// Number of the plan that ran, counting from 1.
    pub plan: u64,
    /// State of the plan at the end of the turn; 0 if no plan ran.
    pub state: u64,
    /// Transitions of the turn, in order.
    pub steps: Vec<RecordedTransition>,
    /// Changes that influenced the turn, in addition to its output, in order.
    pub changes: Vec<RecordedChange>,
    /// Input that a safety rule changed; `None` if no rule changed it.
    pub overruled: Option<Overruled>,
}

/// Source of the input of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Applied {
    /// The law of the current atom was applied.
    Law,
    /// The null input, because the turn had too many transitions.
    Cut,
    /// The null input, because the plan had ended.
    Over,
}

/// A transition of a turn, with the numbers of the operands that fired.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedTransition {
    /// State that the transition leaves.
    pub from: u64,
    /// Number of the bracket of the scope that ended.
    pub scope: u32,
    /// Cause of the scope's end.
    pub cause: Cause,
    /// State that the transition enters.
    pub to: u64,
    /// Numbers of the operands that fired.
    pub operands: Vec<u32>,
}

impl RecordedTransition {
    /// Creates the recorded form of a transition.
    #[must_use]
    pub fn new(transition: &Transition, operands: impl IntoIterator<Item = u32>) -> Self {
        let Transition { from, scope, cause, to, .. } = *transition;
        Self { from, scope, cause, to, operands: operands.into_iter().collect() }
    }
}

/// Writes a turn with the output `y`, without the pings that the previous output `before` contains.
pub(crate) fn put(
    made: TurnMade<'_>,
    (y, before): (&Sensed, Option<&Sensed>),
    steps: impl ExactSizeIterator<Item = RecordedTransition>,
    to: &mut Vec<u8>,
) {
    let TurnMade { number, t, sent, applied, plan, state, changes, overruled } = made;
    put_u64(to, number);
    put_u64(to, t.0);
    exact::put(y, before, to);
    put_changes(changes, to);
    put_overruled(overruled, to);
    put_twist(sent, to);
    to.push(match applied {
        Applied::Law => 0,
        Applied::Cut => 1,
        Applied::Over => 2,
    });
    put_u64(to, plan);
    put_u64(to, state);
    put_u32(to, u32::try_from(steps.len()).unwrap_or(u32::MAX));
    for RecordedTransition { from, scope, cause, to: entered, operands } in steps {
        put_u64(to, from);
        put_u32(to, scope);
        to.push(u8::from(matches!(cause, Cause::Completed(_))));
        put_u32(to, u32::from(cause.level()));
        put_u64(to, entered);
        put_u32(to, u32::try_from(operands.len()).unwrap_or(u32::MAX));
        operands.into_iter().for_each(|operand| put_u32(to, operand));
    }
}

/// Reads a turn that follows the output `before`; returns `None` if the bytes are malformed.
pub(crate) fn take(from: &mut ByteReader<'_>, before: Option<&Sensed>, constants: &Constants) -> Option<RecordedTurn> {
    let (number, t) = (from.u64()?, from.nanos()?);
    let y = exact::take(from, before, constants)?;
    let (changes, overruled) = (take_changes(from)?, take_overruled(from)?);
    let sent = take_twist(from)?;
    let applied = match from.u8()? {
        0 => Applied::Law,
        1 => Applied::Cut,
        2 => Applied::Over,
        _ => return None,
    };
    let (plan, state) = (from.u64()?, from.u64()?);
    let steps = from.list(|from| {
        let (left, scope, is_completed) = (from.u64()?, from.u32()?, from.u8()? != 0);
        let level = u16::try_from(from.u32()?).ok()?;
        let cause = if is_completed { Cause::Completed(level) } else { Cause::Fired(level) };
        Some(RecordedTransition { from: left, scope, cause, to: from.u64()?, operands: from.list(ByteReader::u32)? })
    })?;
    Some(RecordedTurn { number, t, y, sent, applied, plan, state, steps, changes, overruled })
}

/// Checksum over the beginning and all turns so far. With it, a reader finds the first turn that was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Chain(u32);

impl Chain {
    /// Number of bytes of a checksum.
    const LENGTH: usize = 4;

    /// Returns the checksum that also covers the content `bytes` of the next turn.
    pub(crate) fn with(self, bytes: &[u8]) -> Self {
        let mut sum = crc32fast::Hasher::new();
        sum.update(&self.0.to_le_bytes());
        sum.update(bytes);
        Self(sum.finalize())
    }

    /// Verifies the checksum at the end of `content`, and returns `content` without it.
    pub(crate) fn checked<'c>(&mut self, content: &'c [u8]) -> Result<&'c [u8], Undecoded> {
        let length = content.len().checked_sub(Self::LENGTH).ok_or(Undecoded::Unreadable)?;
        let (content, sum) = content.split_at_checked(length).ok_or(Undecoded::Unreadable)?;
        *self = self.with(content);
        if self.bytes() == sum { Ok(content) } else { Err(Undecoded::Changed) }
    }

    pub(crate) fn bytes(self) -> [u8; Self::LENGTH] {
        self.0.to_le_bytes()
    }
}
