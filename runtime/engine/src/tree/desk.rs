//! The side of the hub that the thread which drives the robot has.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, sync_channel};
use std::sync::{Arc, PoisonError};
use std::time::Duration;

use super::hub::{Hub, QUEUE};
use super::shared::{Pending, Shared, Snapshot};
use super::{Answer, Change, Node, Tree, Value};

/// Maximum number of changes that one break carries out.
const EACH_BREAK: usize = 16;

/// The way back to who asked for a change. Dropping it says that the run has ended.
#[derive(Debug)]
pub struct Reply(Sender<Answer>);

impl Reply {
    /// Answers. Nobody may be waiting any longer.
    pub fn answer(self, answer: Answer) {
        let _ = self.0.send(answer);
    }
}

/// A part of the engine that has nodes in the tree. `M` is what it is shown at a break.
pub trait Served<M: ?Sized> {
    /// Returns its nodes with their paths, in a fixed order.
    fn nodes(&self) -> Vec<(String, Node)>;

    /// Adds a value for each node, in the order of [`Served::nodes`]: `None` for methods, and while there is none.
    fn values(&self, moment: &M, to: &mut Vec<Option<Value>>);

    /// Carries out a change of one of its nodes, which its kind, access and role permit. It may keep `reply`, to answer
    /// in a later break.
    fn change(&mut self, path: &str, change: &Change, moment: &M, reply: Reply);
}

/// The side that serves requests at breaks. It never waits, unless it is asked to.
#[derive(Debug)]
pub struct Desk {
    shared: Arc<Shared>,
    requests: Receiver<Pending>,
    tree: Arc<Tree>,
    /// For each node of the tree, the place of its value among those of the parts.
    places: Vec<usize>,
    number: u64,
}

impl Desk {
    /// Returns a desk, and the hub whose requests it answers.
    #[must_use]
    pub fn with_hub() -> (Hub, Self) {
        let (queue, requests) = sync_channel(QUEUE);
        let shared = Arc::new(Shared::default());
        let hub = Hub::new(Arc::clone(&shared), queue);
        (hub, Self { shared, requests, tree: Arc::default(), places: Vec::new(), number: 0 })
    }

    /// Carries out the changes that wait, and hands out a snapshot if somebody wants one.
    pub fn serve<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &M) {
        for _ in 0..EACH_BREAK {
            let Ok(pending) = self.requests.try_recv() else { break };
            Self::carry_out(pending, parts, moment);
        }
        self.publish(parts, moment);
    }

    /// Carries out the changes that wait at the last break, and hands out a snapshot that stays.
    pub fn close<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &M) {
        self.shared.wanted.store(true, Ordering::SeqCst);
        self.serve(parts, moment);
    }

    /// Waits for a change, for at most this long, and carries it out.
    pub fn wait<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &M, time: Duration) {
        match self.requests.recv_timeout(time) {
            Ok(pending) => Self::carry_out(pending, parts, moment),
            Err(RecvTimeoutError::Timeout) => {}
            // Without front ends there is nothing to wait for.
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(time),
        }
        self.publish(parts, moment);
    }

    fn carry_out<M: ?Sized>(Pending { request, reply }: Pending, parts: &mut [&mut dyn Served<M>], moment: &M) {
        let super::Operation::Change(change) = &request.operation else { return };
        let path = request.path.as_str();
        match parts.iter_mut().find(|part| part.nodes().iter().any(|(known, _)| known == path)) {
            Some(part) => part.change(path, change, moment, Reply(reply)),
            None => Reply(reply).answer(Answer::Refused(format!("`{path}` has gone"))),
        }
    }

    /// Hands out a snapshot if somebody wants one.
    fn publish<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &M) {
        if !self.shared.wanted.load(Ordering::SeqCst) {
            return;
        }
        let nodes: Vec<(String, Node)> = parts.iter().flat_map(|part| part.nodes()).collect();
        if self.tree.len() != nodes.len() || nodes.iter().any(|(path, node)| self.tree.get(path) != Some(node)) {
            let tree: Tree = nodes.iter().cloned().collect();
            let place = |path: &String| nodes.iter().position(|(known, _)| known == path).unwrap_or(usize::MAX);
            self.places = tree.keys().map(place).collect();
            self.tree = Arc::new(tree);
        }
        let mut values = Vec::with_capacity(nodes.len());
        for part in parts.iter() {
            part.values(moment, &mut values);
        }
        let values = self.places.iter().map(|place| values.get_mut(*place).and_then(Option::take)).collect();
        self.number = self.number.saturating_add(1);
        let snapshot = Arc::new(Snapshot { tree: Arc::clone(&self.tree), values, number: self.number });
        // A front end holds the lock while it copies a pointer; the next break tries again.
        if let Ok(mut kept) = self.shared.snapshot.try_lock() {
            self.shared.wanted.store(false, Ordering::SeqCst);
            *kept = snapshot;
            self.shared.changed.notify_all();
        }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // A front end that is about to wait holds the lock.
        let _kept = self.shared.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        self.shared.ended.store(true, Ordering::SeqCst);
        self.shared.changed.notify_all();
    }
}
