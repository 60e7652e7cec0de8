//! The hub passes requests from the front ends to the thread that drives the robot.

use std::collections::BTreeSet;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, TrySendError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::node::names;
use super::proposal::proposal;
use super::shared::{NO_VALUE, Pending, SharedTree, Snapshot};
use super::{Access, Answer, Change, Node, Operation, Request, Role, Tree};

/// Maximum number of changes that wait for a turn break.
pub const QUEUE: usize = 64;
/// Interval at which a waiting front end calls its function `meanwhile`.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum wait for a snapshot newer than the request.
const PATIENCE: Duration = Duration::from_secs(2);

/// Commands, each with the channel for its answer.
type LateAnswers = Vec<(String, Receiver<Answer>)>;

/// The hub, which front ends use. Its methods may wait.
#[derive(Debug, Clone)]
pub struct Hub {
    shared: Arc<SharedTree>,
    queue: SyncSender<Pending>,
    reports: Arc<Mutex<Receiver<String>>>,
    /// Requests whose answers the front end no longer waits for: each as a command, with the channel for its answer.
    later: Arc<Mutex<LateAnswers>>,
}

impl Hub {
    /// Creates the hub that shares this data with a desk.
    pub(super) fn new(shared: Arc<SharedTree>, queue: SyncSender<Pending>, reports: Receiver<String>) -> Self {
        Self { shared, queue, reports: Arc::new(Mutex::new(reports)), later: Arc::default() }
    }

    /// Waits for the first turn break of the run; returns `false` if the run ends before it.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.shared.wanted.store(true, Ordering::SeqCst);
        let waits = |kept: &mut Arc<Snapshot>| kept.number == 0 && !self.shared.ended.load(Ordering::SeqCst);
        let kept = self.shared.changed.wait_while(self.lock(), waits).unwrap_or_else(PoisonError::into_inner);
        kept.number > 0
    }

    /// Returns `true` once the run has ended.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.shared.ended.load(Ordering::SeqCst)
    }

    /// Returns the next answer to a request whose front end has stopped waiting, or the next report of a watched
    /// attribute: time, path and value. Waits at most `wait`.
    #[must_use]
    pub fn report(&self, wait: Duration) -> Option<String> {
        if let Some(answer) = self.late_answer() {
            return Some(answer);
        }
        self.reports.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(wait).ok()
    }

    /// Carries out a request and returns the answer, as [`Hub::wait`] does.
    #[must_use]
    pub fn ask(&self, request: Request) -> Answer {
        self.wait(request, Duration::MAX, &mut || ())
    }

    /// Carries out a request and returns the answer. If the request is a change, waits at most `patience` until a turn
    /// break has carried it out; an answer after that time is returned by [`Hub::report`]. Calls `meanwhile` at
    /// intervals while it waits. After the run, only read requests are answered.
    #[must_use]
    pub fn wait(&self, request: Request, patience: Duration, meanwhile: &mut dyn FnMut()) -> Answer {
        let Some(snapshot) = self.snapshot() else { return Answer::Ended };
        let path = request.path.trim_end_matches('/').to_owned();
        match request.operation {
            Operation::List => {
                let names = names(&snapshot.tree, &path);
                if names.is_empty() { nothing(&snapshot.tree, &path) } else { Answer::Entries(names) }
            }
            Operation::Get => match snapshot.tree.keys().position(|key| *key == path) {
                None => nothing(&snapshot.tree, &path),
                Some(place) => match snapshot.values.get(place) {
                    Some(Some(value)) => Answer::Value(value.to_string()),
                    _ if snapshot.tree.get(&path).is_some_and(|node| node.access == Access::Call) => {
                        Answer::Refused(format!("`{path}` is a method: call it"))
                    }
                    Some(None) | None => Answer::Value(NO_VALUE.to_owned()),
                },
            },
            Operation::Change(ref change) => {
                let Some(node) = snapshot.tree.get(&path) else { return nothing(&snapshot.tree, &path) };
                match refusal(&path, node, change, &request) {
                    Some(refusal) => Answer::Refused(refusal),
                    None => self.change(Request { path, ..request }, patience, meanwhile),
                }
            }
            Operation::Watch(_) => match snapshot.tree.get(&path) {
                None => nothing(&snapshot.tree, &path),
                Some(node) if node.access == Access::Call => {
                    Answer::Refused(format!("`{path}` is a method: it has no value"))
                }
                Some(_) => self.change(Request { path, ..request }, patience, meanwhile),
            },
        }
    }

    /// Removes and returns an answer that came after the front end had stopped waiting, with its command.
    fn late_answer(&self) -> Option<String> {
        let mut later = self.later.lock().unwrap_or_else(PoisonError::into_inner);
        let (place, answer) = later.iter().enumerate().find_map(|(place, (_, answer))| match answer.try_recv() {
            Ok(answer) => Some((place, answer)),
            Err(TryRecvError::Disconnected) => Some((place, Answer::Ended)),
            Err(TryRecvError::Empty) => None,
        })?;
        let (command, _) = later.remove(place);
        Some(match answer {
            Answer::Refused(sentence) => format!("`{command}`: error: {sentence}"),
            Answer::Ended => format!("`{command}`: error: the run has ended"),
            Answer::Value(text) | Answer::Done(text) if !text.is_empty() => format!("`{command}`: {text}"),
            Answer::Entries(_) | Answer::Value(_) | Answer::Done(_) => format!("`{command}`: done"),
        })
    }

    /// Returns the paths that begin with `begun`, each up to the next `/`.
    #[must_use]
    pub fn complete(&self, begun: &str) -> Vec<String> {
        let snapshot = Arc::clone(&self.lock());
        let paths = snapshot.tree.keys().filter_map(|path| {
            let rest = path.strip_prefix(begun)?;
            Some(rest.find('/').map_or(path.as_str(), |end| path.get(..=begun.len() + end).unwrap_or(path)).to_owned())
        });
        paths.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Returns the node with this path in the last snapshot; `None` if it does not exist.
    #[must_use]
    pub fn node(&self, path: &str) -> Option<Node> {
        self.lock().tree.get(path).copied()
    }

    /// Queues a change, and waits for the answer.
    fn change(&self, request: Request, patience: Duration, meanwhile: &mut dyn FnMut()) -> Answer {
        let (command, begun) = (request.to_string(), Instant::now());
        let (reply, answer) = channel();
        match self.queue.try_send(Pending { request, reply }) {
            Ok(()) => loop {
                match answer.recv_timeout(LOOK) {
                    Ok(answer) => break answer,
                    Err(RecvTimeoutError::Timeout) if begun.elapsed() >= patience => {
                        self.later.lock().unwrap_or_else(PoisonError::into_inner).push((command, answer));
                        break Answer::Done("the answer comes later, as a report".to_owned());
                    }
                    Err(RecvTimeoutError::Timeout) => meanwhile(),
                    Err(RecvTimeoutError::Disconnected) => break Answer::Ended,
                }
            },
            Err(TrySendError::Full(_)) => {
                Answer::Refused(format!("{QUEUE} changes are waiting already: try again later"))
            }
            Err(TrySendError::Disconnected(_)) => Answer::Ended,
        }
    }

    /// Returns a snapshot of the present state. This is the last snapshot if no turn break has begun since, because
    /// nothing changes between two breaks; otherwise, it is a snapshot that was taken after the call. If the robot
    /// makes no turn within [`PATIENCE`], or the run has ended, returns the last snapshot; `None` if there is no
    /// snapshot.
    fn snapshot(&self) -> Option<Arc<Snapshot>> {
        let mut kept = self.lock();
        let before = kept.number;
        // Who has read once often reads again: the next break makes a snapshot as well.
        self.shared.wanted.store(true, Ordering::SeqCst);
        if self.shared.is_current.load(Ordering::SeqCst) {
            return Some(Arc::clone(&kept));
        }
        // Wakes a desk that waits for a request while the clock is paused.
        let request = Request { path: String::new(), operation: Operation::Get, role: Role::View };
        let _ = self.queue.try_send(Pending { request, reply: channel().0 });
        let is_old = |kept: &mut Arc<Snapshot>| kept.number == before && !self.shared.ended.load(Ordering::SeqCst);
        kept = self.shared.changed.wait_timeout_while(kept, PATIENCE, is_old).unwrap_or_else(PoisonError::into_inner).0;
        (kept.number > 0).then(|| Arc::clone(&kept))
    }

    fn lock(&self) -> MutexGuard<'_, Arc<Snapshot>> {
        self.shared.snapshot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the answer about a path that does not exist, or that names a folder instead of a node, or a node instead of
/// a folder.
fn nothing(tree: &Tree, path: &str) -> Answer {
    if !names(tree, path).is_empty() {
        return Answer::Refused(format!("`{path}` is a folder: `ls {path}` lists it"));
    }
    if tree.contains_key(path) {
        return Answer::Refused(format!("`{path}` is no folder"));
    }
    let proposal = proposal(tree, path);
    let path = if path.is_empty() { "/" } else { path };
    Answer::Refused(format!("there is nothing at `{path}`{proposal}"))
}

/// Returns the reason why a change is refused because of the node's access, role or kind; `None` if it is allowed.
fn refusal(path: &str, node: &Node, change: &Change, request: &Request) -> Option<String> {
    match (change, node.access) {
        (Change::Set(_), Access::Read) => return Some(format!("`{path}` is read-only")),
        (Change::Set(_), Access::Call) => return Some(format!("`{path}` is a method: call it")),
        (Change::Call(_), Access::Read | Access::Write) => return Some(format!("`{path}` is an attribute: read it")),
        (Change::Set(_), Access::Write) | (Change::Call(_), Access::Call) => {}
    }
    if request.role < node.role {
        let (needed, own) = (node.role.name(), request.role.name());
        return Some(format!("`{path}` needs the role {needed}, and this session has {own}"));
    }
    match change {
        Change::Set(text) => super::read(text, node.kind).err().map(|refusal| format!("`{path}`: {refusal}")),
        Change::Call(_) => None,
    }
}
