//! `/recorder`: writes turns to a record file from the time it is started until it is stopped (docs/src/shell.md).
//!
//! A separate thread opens and writes the file, so a turn of a real robot never waits for the file. Turns that do not
//! fit into the queue are omitted from the record; the recorder counts them.

mod writer;

use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use mdle_host::{Break, RunTerms, Time};
use mdle_record::frames::Frames;
use mdle_record::{Applied, Begin, TurnMade};
use mdle_runtime::{Compass, Nanos, Sensed, Twist};

use writer::{WriterOrder, WriterProgress, write_all};

use crate::engine::Engine;
use crate::plans::EngineAlphabet;
use crate::tree::{Answer, Change, Node, Reply, Role, Served, Value, ValueKind};

/// Maximum number of turns in the queue to the writing thread.
const WAITING: usize = 256;
/// Maximum time that the end of the session waits for the file to be complete.
const AT_THE_END: Duration = Duration::from_secs(2);

/// The recorder of a session.
#[derive(Debug)]
pub(super) struct RecorderPart {
    /// Channel for orders; `None` if the system could not create the writing thread.
    orders: Option<SyncSender<WriterOrder>>,
    thread: Option<JoinHandle<()>>,
    opened: Receiver<Result<(), String>>,
    progress: Arc<WriterProgress>,
    begin: Begin,
    /// `true` if the run waits when the queue is full.
    is_stepped: bool,
    /// Reply to send when the file has been opened; `None` if no file is being opened.
    opening: Option<Reply>,
    /// Name of the file that is being written, or that was written last.
    file: Arc<str>,
    tape: Option<Tape>,
    turns: u64,
    dropped: u64,
}

/// A record that is being written.
#[derive(Debug, Default)]
struct Tape {
    frames: Frames,
    has_begun: bool,
}

impl RecorderPart {
    /// Creates the recorder of a run with these terms on this target. It must be created before the control thread gets
    /// real-time scheduling, because the recorder's thread would inherit this scheduling.
    pub(super) fn new(terms: &RunTerms, target: &str) -> Self {
        let ((orders, waiting), (sender, opened)) = (sync_channel(WAITING), channel());
        let progress = Arc::<WriterProgress>::default();
        let own = Arc::clone(&progress);
        let write = move || write_all(&waiting, &sender, &own);
        let thread = thread::Builder::new().name("mdle recorder".to_owned()).spawn(write).ok();
        let begin = Begin {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            target: target.to_owned(),
            period: Nanos(u64::try_from(terms.period.as_nanos()).unwrap_or(u64::MAX)),
            beside: Begin::MIDDLE.to_owned(),
            ..Begin::default()
        };
        Self {
            orders: thread.as_ref().map(|_| orders),
            thread,
            opened,
            progress,
            begin,
            is_stepped: terms.time != Time::Wall,
            opening: None,
            file: "".into(),
            tape: None,
            turns: 0,
            dropped: 0,
        }
    }

    /// Passes the turn that has just been made to the writing thread if a record is being written.
    pub(super) fn made<A>(&mut self, moment: &Break<'_, Engine<A>>)
    where
        A: EngineAlphabet<Input = Twist>,
    {
        let (Some(tape), Some(orders)) = (&mut self.tape, &self.orders) else { return };
        let Some(y) = (moment.y as &dyn Any).downcast_ref::<Sensed>().filter(|_| moment.turns > 0) else { return };
        let position = moment.position();
        let applied = match position {
            _ if moment.is_over => Applied::Over,
            Some(_) => Applied::Law,
            None => Applied::Cut,
        };
        let made = TurnMade {
            number: moment.turns - 1,
            t: moment.t,
            sent: *moment.input,
            applied,
            plan: moment.pilot.plans().number().into(),
            state: position.map_or(0, |position| position.state),
            changes: &[],
            overruled: None,
        };
        // The compass is computed from all outputs since the start of the run, which this record does not contain.
        let y = &Sensed { compass: Compass::default(), ..*y };
        // A turn is encoded as the difference from the last turn that was written.
        let (mut frames, mut bytes) = (tape.frames.clone(), Vec::new());
        if !tape.has_begun {
            self.begin.plan = moment.pilot.plans().name().to_owned();
            frames.begin(&self.begin, y, &mut bytes);
        }
        frames.turn(made, y, std::iter::empty(), &mut bytes);
        let order = WriterOrder::Write(bytes);
        let is_taken = if self.is_stepped { orders.send(order).is_ok() } else { orders.try_send(order).is_ok() };
        if is_taken {
            *tape = Tape { frames, has_begun: true };
            self.turns = self.turns.saturating_add(1);
        } else {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Answers the request that waits for the file to be opened; returns a message if writing has failed.
    pub(super) fn proceed(&mut self) -> Option<String> {
        if let Ok(opened) = self.opened.try_recv()
            && let Some(reply) = self.opening.take()
        {
            reply.answer(match opened {
                Ok(()) => {
                    self.tape = Some(Tape::default());
                    Answer::Done(format!("records to {}", self.file))
                }
                Err(sentence) => Answer::Refused(sentence),
            });
        }
        let (fault, turns) = self.progress.fault.try_lock().ok()?.take()?;
        (self.tape, self.turns) = (None, turns);
        let word = if turns == 1 { "turn" } else { "turns" };
        let file = &self.file;
        Some(format!("warning: the record {file} ends here, with {turns} {word}, as it cannot be written: {fault}"))
    }

    /// Starts to open a file.
    fn start(&mut self, arguments: &[String], reply: Reply) {
        let sentence = match (arguments, &self.orders) {
            (_, None) => "the system gives no thread for the recorder".to_owned(),
            _ if self.tape.is_some() || self.opening.is_some() => {
                format!("it records to {}: `call /recorder/stop` ends that", self.file)
            }
            ([file], Some(orders)) if file.ends_with(".mcap") => {
                if orders.try_send(WriterOrder::Open(file.into())).is_ok() {
                    (self.file, self.turns, self.dropped) = (file.as_str().into(), 0, 0);
                    self.opening = Some(reply);
                    return;
                }
                "the file before is still being written: try again later".to_owned()
            }
            (_, Some(_)) => {
                "`/recorder/start` takes the name of a file, as in `call /recorder/start run.mcap`".to_owned()
            }
        };
        reply.answer(Answer::Refused(sentence));
    }

    /// Ends the record.
    fn stop(&mut self) -> Answer {
        let (Some(mut tape), Some(orders)) = (self.tape.take(), &self.orders) else {
            return Answer::Refused("it does not record: `call /recorder/start FILE.mcap` begins that".to_owned());
        };
        let mut end = Vec::new();
        tape.frames.end(&mut end);
        // If the queue is full, the file has no end mark, as after the process was killed.
        let _ = orders.try_send(WriterOrder::Write(end)).and_then(|()| orders.try_send(WriterOrder::Close));
        Answer::Done(format!("{} turns in {}", self.turns, self.file))
    }
}

impl Drop for RecorderPart {
    fn drop(&mut self) {
        self.stop();
        self.orders = None;
        let begun = Instant::now();
        while self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) && begun.elapsed() < AT_THE_END {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

impl<A: EngineAlphabet> Served<Break<'_, Engine<A>>> for RecorderPart {
    fn nodes(&self, _: &Break<'_, Engine<A>>) -> Vec<(String, Node)> {
        let nodes = [
            ("file", Node::reading(ValueKind::Text, "file that is written, or was written last")),
            ("state", Node::reading(ValueKind::Text, "`records` or `stands`")),
            ("turns", Node::reading(ValueKind::Integer, "number of turns that were recorded")),
            ("bytes", Node::reading(ValueKind::Integer, "size of the file")),
            ("dropped", Node::reading(ValueKind::Integer, "number of turns for which the file was too slow")),
            ("start", Node::method(Role::Admin, "records what follows to a new file")),
            ("stop", Node::method(Role::Admin, "ends the record")),
        ];
        nodes.map(|(name, node)| (format!("/recorder/{name}"), node)).into()
    }

    fn values(&self, _: &Break<'_, Engine<A>>, to: &mut Vec<Option<Value>>) {
        let state = if self.tape.is_some() { "records" } else { "stands" };
        let file = Some(Value::Text(Arc::clone(&self.file))).filter(|_| !self.file.is_empty());
        let counts = [self.turns, self.progress.bytes.load(Ordering::Relaxed), self.dropped];
        to.extend([file, Some(Value::text(state))]);
        to.extend(counts.map(|count| Some(Value::count(count))));
        to.extend([None, None]);
    }

    fn change(&mut self, path: &str, change: &Change, _: &mut Break<'_, Engine<A>>, reply: Reply) {
        match change {
            Change::Call(arguments) if path == "/recorder/start" => self.start(arguments, reply),
            Change::Call(arguments) if arguments.is_empty() => {
                let answer = self.stop();
                reply.answer(answer);
            }
            Change::Call(_) | Change::Set(_) => reply.answer(Answer::Refused(format!("`{path}` takes no arguments"))),
        }
    }
}
