//! Writes and reads the changes that influence a turn, in addition to the robot's output. These are values that modules
//! have published, states of other robots, paths that were recorded, and changes that users and the engine have made
//! between the previous turn and this one.

use mdle_runtime::{Nanos, PeerState, Setpoint, Twist};

use crate::begin::{count, put_files, put_path, take_files, take_path};
use crate::bytes::{ByteReader, put_f64, put_pose, put_text, put_u32, put_u64};
use crate::exact::{put_twist, take_twist};

/// A change that influences a turn, in addition to the robot's output.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordedChange {
    /// A module has this attribute from now on. Later changes refer to an attribute by its number: the attributes of a
    /// record are counted from 0.
    Attribute {
        /// Name of the module.
        module: String,
        /// Name of the attribute in the module.
        name: String,
        /// Number of the kind of the attribute's values.
        kind: u8,
    },
    /// The attribute with this number no longer exists.
    Vanished(u32),
    /// A module has published a value between two turns.
    Published {
        /// Number of the attribute.
        attribute: u32,
        /// Time of the turn before the publication.
        at: Nanos,
        /// The value as 64 bits; 0 for a kind that plans do not read.
        bits: u64,
    },
    /// Files of a plan, each with its name and text, the plan's own file first. Later changes refer to a list of files
    /// by its number: the lists of a record are counted from 0.
    Files(Vec<(String, String)>),
    /// A plan is ready to replace the current plan.
    Armed {
        /// Number of the list with the plan's files.
        files: u32,
        /// Name of the plan.
        plan: String,
        /// Number of the kind of event at which the plan replaces the current plan.
        when: u8,
    },
    /// The plan that was ready to replace the current plan is cancelled.
    Cancelled,
    /// The trial of a plan has failed for this reason, so the plan is replaced by the previous one.
    RolledBack(String),
    /// From now on, each plan that replaces another plan is on trial for this duration.
    Trial(Nanos),
    /// A limit of the safety rules has a new value.
    Limit {
        /// Key of the limit in a safety file.
        key: String,
        /// Value of the limit, in SI units.
        value: f64,
    },
    /// The safety rules were reset: the limits have the values of the safety file again, and all rules apply again.
    SafetyReset,
    /// The plan made no turn, because no thread was ready in time to run it.
    Skipped,
    /// The plan did not finish its turn in time.
    Late,
    /// A late turn of the plan has ended; its input is not used.
    Back,
    /// Another robot that the plan names, with the data that the state link has about it in this turn.
    Peer {
        /// Name of the robot.
        name: String,
        /// Number of times that the robot of the record had entered a scope with a `rendezvous` with this other robot.
        rounds: u64,
        /// The newest state that has arrived; `None` before the first arrival.
        state: Option<PeerState>,
    },
    /// The way back along a driven path was recorded. From now on, it replaces the path with this name.
    Path {
        /// Name of the path.
        name: String,
        /// Setpoints of the path.
        setpoints: Vec<Setpoint>,
    },
}

/// An input that a safety rule changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Overruled {
    /// Input that the plan requested.
    pub asked: Twist,
    /// Name of the rule.
    pub rule: String,
}

/// Writes the changes before a turn.
pub(crate) fn put_changes(changes: &[RecordedChange], to: &mut Vec<u8>) {
    put_u32(to, count(changes));
    changes.iter().for_each(|change| put(change, to));
}

/// Reads the changes before a turn.
pub(crate) fn take_changes(from: &mut ByteReader<'_>) -> Option<Vec<RecordedChange>> {
    from.list(take)
}

fn put(change: &RecordedChange, to: &mut Vec<u8>) {
    match change {
        RecordedChange::Attribute { module, name, kind } => {
            to.push(0);
            put_text(to, module);
            put_text(to, name);
            to.push(*kind);
        }
        RecordedChange::Vanished(attribute) => {
            to.push(1);
            put_u32(to, *attribute);
        }
        RecordedChange::Published { attribute, at, bits } => {
            to.push(2);
            put_u32(to, *attribute);
            put_u64(to, at.0);
            put_u64(to, *bits);
        }
        RecordedChange::Files(files) => {
            to.push(3);
            put_files(files, to);
        }
        RecordedChange::Armed { files, plan, when } => {
            to.push(4);
            put_u32(to, *files);
            put_text(to, plan);
            to.push(*when);
        }
        RecordedChange::Cancelled => to.push(5),
        RecordedChange::RolledBack(why) => {
            to.push(6);
            put_text(to, why);
        }
        RecordedChange::Trial(time) => {
            to.push(7);
            put_u64(to, time.0);
        }
        RecordedChange::Limit { key, value } => {
            to.push(8);
            put_text(to, key);
            put_f64(to, *value);
        }
        RecordedChange::Skipped => to.push(9),
        RecordedChange::Late => to.push(10),
        RecordedChange::Back => to.push(11),
        RecordedChange::Peer { name, rounds, state } => {
            to.push(12);
            put_text(to, name);
            put_u64(to, *rounds);
            put_peer_state(state.as_ref(), to);
        }
        RecordedChange::Path { name, setpoints } => {
            to.push(13);
            put_path(name, setpoints, to);
        }
        RecordedChange::SafetyReset => to.push(14),
    }
}

fn put_peer_state(state: Option<&PeerState>, to: &mut Vec<u8>) {
    to.push(u8::from(state.is_some()));
    if let Some(PeerState { pose, velocity, age, rounds, atom }) = state {
        put_pose(to, pose);
        put_twist(*velocity, to);
        put_u64(to, age.0);
        put_u64(to, *rounds);
        put_u64(to, *atom);
    }
}

fn take_peer_state(from: &mut ByteReader<'_>) -> Option<Option<PeerState>> {
    match from.u8()? {
        0 => Some(None),
        1 => {
            let (pose, velocity, age) = (from.pose()?, take_twist(from)?, from.nanos()?);
            Some(Some(PeerState { pose, velocity, age, rounds: from.u64()?, atom: from.u64()? }))
        }
        _ => None,
    }
}

fn take(from: &mut ByteReader<'_>) -> Option<RecordedChange> {
    Some(match from.u8()? {
        0 => RecordedChange::Attribute { module: from.text()?, name: from.text()?, kind: from.u8()? },
        1 => RecordedChange::Vanished(from.u32()?),
        2 => RecordedChange::Published { attribute: from.u32()?, at: from.nanos()?, bits: from.u64()? },
        3 => RecordedChange::Files(take_files(from)?),
        4 => RecordedChange::Armed { files: from.u32()?, plan: from.text()?, when: from.u8()? },
        5 => RecordedChange::Cancelled,
        6 => RecordedChange::RolledBack(from.text()?),
        7 => RecordedChange::Trial(from.nanos()?),
        8 => RecordedChange::Limit { key: from.text()?, value: from.f64()? },
        9 => RecordedChange::Skipped,
        10 => RecordedChange::Late,
        11 => RecordedChange::Back,
        12 => RecordedChange::Peer { name: from.text()?, rounds: from.u64()?, state: take_peer_state(from)? },
        13 => {
            let (name, setpoints) = take_path(from)?;
            RecordedChange::Path { name, setpoints }
        }
        14 => RecordedChange::SafetyReset,
        _ => return None,
    })
}

/// Writes the input that a safety rule changed; for `None`, writes that no rule changed an input.
pub(crate) fn put_overruled(overruled: Option<&Overruled>, to: &mut Vec<u8>) {
    to.push(u8::from(overruled.is_some()));
    if let Some(Overruled { asked, rule }) = overruled {
        put_twist(*asked, to);
        put_text(to, rule);
    }
}

/// Reads the input that a safety rule changed; returns `Some(None)` if no rule changed it.
pub(crate) fn take_overruled(from: &mut ByteReader<'_>) -> Option<Option<Overruled>> {
    match from.u8()? {
        0 => Some(None),
        1 => Some(Some(Overruled { asked: take_twist(from)?, rule: from.text()? })),
        _ => None,
    }
}
