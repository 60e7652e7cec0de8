//! The desk serves the requests of the hub on the thread that drives the robot.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, sync_channel};
use std::sync::{Arc, PoisonError};
use std::time::Duration;

use mdle_runtime::Nanos;

use super::hub::{Hub, QUEUE};
use super::shared::{NO_VALUE, Pending, SharedTree, Snapshot};
use super::watch::{REPORTS, Watches};
use super::{Answer, Change, Node, Operation, Tree, Value};

/// Maximum number of changes that a single turn break carries out.
const EACH_BREAK: usize = 16;

/// Maximum number of attempts to publish the last snapshot.
const CLOSING: usize = 5;

/// Channel for the answer to a change. Dropping the channel tells the front end that the run has ended.
#[derive(Debug)]
pub struct Reply(Sender<Answer>);

impl Reply {
    /// Sends the answer, even if the front end no longer waits for it.
    pub fn answer(self, answer: Answer) {
        let _ = self.0.send(answer);
    }
}

/// A part of the engine that has nodes in the tree. `M` is the type of the data that the part gets at a turn break.
pub trait Served<M: ?Sized> {
    /// Returns the nodes of the part with their paths, in a fixed order.
    fn nodes(&self, moment: &M) -> Vec<(String, Node)>;

    /// Appends a value for each node, in the order of [`Served::nodes`]: the value is `None` for a method, and for a
    /// node that has no value yet.
    fn values(&self, moment: &M, to: &mut Vec<Option<Value>>);

    /// Carries out a change of one of the part's nodes. The caller has checked that the node's kind, access and role
    /// permit the change. The part may keep `reply` in order to answer at a later turn break.
    fn change(&mut self, path: &str, change: &Change, moment: &mut M, reply: Reply);
}

/// The desk, which serves requests at turn breaks. Only [`Desk::wait`] waits.
#[derive(Debug)]
pub struct Desk {
    shared: Arc<SharedTree>,
    requests: Receiver<Pending>,
    tree: Arc<Tree>,
    /// Index of each node's value among the values of all parts, in the order of the tree.
    places: Vec<usize>,
    number: u64,
    watches: Watches,
    /// Replies to requests to watch an attribute, which are sent after the attribute's first report.
    watchers: Vec<Reply>,
    /// Changes that turn breaks have carried out since the last [`Desk::take_carried_out`], as commands.
    carried_out: Vec<String>,
}

impl Desk {
    /// Returns a desk, and the hub that sends requests to it.
    #[must_use]
    pub fn with_hub() -> (Hub, Self) {
        let (queue, requests) = sync_channel(QUEUE);
        let shared = Arc::new(SharedTree::default());
        let (reporter, reports) = sync_channel(REPORTS);
        let hub = Hub::new(Arc::clone(&shared), queue, reports);
        let desk = Self {
            shared,
            requests,
            tree: Arc::default(),
            places: Vec::new(),
            number: 0,
            watches: Watches::new(reporter),
            watchers: Vec::new(),
            carried_out: Vec::new(),
        };
        (hub, desk)
    }

    /// Records that a turn break begins, before anything changes: from now on, the last snapshot is out of date.
    pub fn begin_break(&self) {
        self.shared.is_current.store(false, Ordering::SeqCst);
    }

    /// Carries out the waiting changes; returns `true` if there were any.
    pub fn serve<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &mut M) -> bool {
        let mut served = false;
        for _ in 0..EACH_BREAK {
            let Ok(pending) = self.requests.try_recv() else { break };
            served |= self.carry_out(pending, parts, moment);
        }
        served
    }

    /// Waits at most `time` for a change, and carries the change out. Returns `true` if there was a change.
    pub fn wait<M: ?Sized>(&mut self, parts: &mut [&mut dyn Served<M>], moment: &mut M, time: Duration) -> bool {
        let request = self.requests.recv_timeout(time);
        self.begin_break();
        match request {
            Ok(pending) => return self.carry_out(pending, parts, moment),
            Err(RecvTimeoutError::Timeout) => {}
            // Without front ends, no request can arrive.
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(time),
        }
        false
    }

    /// Publishes the last snapshot of the run, which remains readable after the run.
    pub fn close<M: ?Sized>(&mut self, parts: &[&mut dyn Served<M>], moment: &M, t: Nanos) {
        self.shared.wanted.store(true, Ordering::SeqCst);
        for _ in 0..CLOSING {
            self.publish(parts, moment, t);
            if !self.shared.wanted.load(Ordering::SeqCst) {
                break;
            }
            // A front end holds the lock only while it copies a pointer.
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Returns the changes that turn breaks have carried out since the last call, as commands of the shell.
    pub fn take_carried_out(&mut self) -> Vec<String> {
        std::mem::take(&mut self.carried_out)
    }

    /// Carries out a request; returns `true` if it was a change. A read request only ends the wait for requests,
    /// because the front end reads the value from the next snapshot.
    fn carry_out<M: ?Sized>(
        &mut self,
        Pending { request, reply }: Pending,
        parts: &mut [&mut dyn Served<M>],
        moment: &mut M,
    ) -> bool {
        let path = request.path.as_str();
        let change = match &request.operation {
            Operation::Change(change) => change,
            Operation::Watch(begins) => {
                let result = if *begins { self.watches.add(path) } else { self.watches.remove(path) };
                match result {
                    Ok(()) if *begins => self.watchers.push(Reply(reply)),
                    Ok(()) => Reply(reply).answer(Answer::Done(String::new())),
                    Err(sentence) => Reply(reply).answer(Answer::Refused(sentence)),
                }
                return true;
            }
            Operation::List | Operation::Get => return false,
        };
        self.carried_out.push(request.to_string());
        match parts.iter_mut().find(|part| part.nodes(moment).iter().any(|(known, _)| known == path)) {
            Some(part) => part.change(path, change, moment, Reply(reply)),
            None => Reply(reply).answer(Answer::Refused(format!("`{path}` has gone"))),
        }
        true
    }

    /// Publishes a snapshot if a front end waits for one, and reports watched attributes; `t` is the time of the last
    /// turn.
    pub fn publish<M: ?Sized>(&mut self, parts: &[&mut dyn Served<M>], moment: &M, t: Nanos) {
        self.show(parts, moment, t);
        self.watchers.drain(..).for_each(|reply| reply.answer(Answer::Done(String::new())));
    }

    fn show<M: ?Sized>(&mut self, parts: &[&mut dyn Served<M>], moment: &M, t: Nanos) {
        let is_wanted = self.shared.wanted.load(Ordering::SeqCst);
        if !is_wanted && !self.watches.are_due(t) {
            return;
        }
        let nodes: Vec<(String, Node)> = parts.iter().flat_map(|part| part.nodes(moment)).collect();
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
        let values: Vec<_> = self.places.iter().map(|place| values.get_mut(*place).and_then(Option::take)).collect();
        let tree = &self.tree;
        self.watches.report(t, |path| {
            let place = tree.keys().position(|known| known == path);
            let value = place.and_then(|place| values.get(place)).and_then(Option::as_ref);
            value.map_or_else(|| NO_VALUE.to_owned(), Value::to_string)
        });
        if !is_wanted {
            return;
        }
        self.number = self.number.saturating_add(1);
        let snapshot = Arc::new(Snapshot { tree: Arc::clone(&self.tree), values, number: self.number });
        // A front end holds the lock while it copies a pointer. If so, the next turn break tries again.
        if let Ok(mut kept) = self.shared.snapshot.try_lock() {
            self.shared.wanted.store(false, Ordering::SeqCst);
            *kept = snapshot;
            self.shared.is_current.store(true, Ordering::SeqCst);
            self.shared.changed.notify_all();
        }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // The lock prevents that a front end misses the notification between its check and its wait.
        let _kept = self.shared.snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        self.shared.ended.store(true, Ordering::SeqCst);
        self.shared.changed.notify_all();
    }
}
