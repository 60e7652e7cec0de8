//! Data that the hub and the desk share.

use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex};

use super::{Answer, Request, Tree, Value};

/// Text shown for an attribute without a value.
pub(super) const NO_VALUE: &str = "(no value yet)";

/// Values of all readable nodes as of one turn break.
#[derive(Debug, Default)]
pub(super) struct Snapshot {
    pub(super) tree: Arc<Tree>,
    /// Values in the order of the nodes; the value is `None` for a method, and for an attribute that has no value yet.
    pub(super) values: Vec<Option<Value>>,
    /// Number of the snapshot, counted from 1.
    pub(super) number: u64,
}

/// Data that the hub and the desk share.
#[derive(Debug, Default)]
pub(super) struct SharedTree {
    pub(super) snapshot: Mutex<Arc<Snapshot>>,
    pub(super) changed: Condvar,
    /// `true` while the snapshot shows the current state: from the end of the turn break of the snapshot until the next
    /// turn break begins.
    pub(super) is_current: AtomicBool,
    /// `true` if a front end waits for a snapshot.
    pub(super) wanted: AtomicBool,
    pub(super) ended: AtomicBool,
}

/// A change that waits for a turn break, and the channel for its answer.
#[derive(Debug)]
pub(super) struct Pending {
    pub(super) request: Request,
    pub(super) reply: Sender<Answer>,
}
