//! A robot that plays a script and keeps a journal, and the set-up in which tests run it.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, Write};
use std::os::fd::AsFd as _;
use std::rc::Rc;
use std::time::Duration;

use clap::{Arg, ArgMatches, Command};
use mdle_runtime::{Cause, Nanos, Output, Robot};

use super::plan::ToyPlan;
use crate::call::Call;
use crate::executable::PlanOnTarget;
use crate::instants::Instants;
use crate::pilot::PlanAlone;
use crate::session::session;
use crate::signals::{ProcessSignal, Signals};
use crate::surroundings::Surroundings;
use crate::turn_watch::TurnWatch;
use crate::{
    EnclosingScope, Ended, Judgement, Observation, Observer, Pace, PlanPosition, Refusal, RunTerms, StopRequest,
    Supervision, Supervisor, Target, Time,
};

/// An output: for each atom, numbered as written, the cause by which a scope ends while the atom is current.
#[derive(Debug, Clone, Default)]
pub(super) struct Sensed(pub(super) Vec<(u32, Cause)>);

impl Output for Sensed {}

/// Action of the robot at one exchange; after the end of the script, nothing fires.
#[derive(Debug, Clone)]
pub(super) enum Act {
    Senses(Vec<(u32, Cause)>),
    Hears(ProcessSignal),
    Fails(&'static str),
    Panics(&'static str),
}

/// Function that creates the supervisor of a run.
pub(super) type Makes = fn(&RunTerms) -> Box<dyn Supervisor<Alone>>;

/// The pilot of all runs.
pub(super) type Alone = PlanAlone<'static, ToyPlan>;

/// Set-up of a test: what the robot does in each turn and while it is stopped, and a record of all that happens.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) script: Vec<Act>,
    pub(super) time: Time,
    pub(super) refusal: Option<Refusal>,
    /// Signal that arrives while the robot is being opened, if any.
    pub(super) interrupted: Option<ProcessSignal>,
    pub(super) stop: Act,
    pub(super) finish: Result<(), String>,
    /// Result of the robot's run, if the run has a goal.
    pub(super) judgement: Option<Judgement>,
    /// `true` if the robot asks for the plan's state after each turn.
    pub(super) looks: bool,
    pub(super) plan: ToyPlan,
    /// Name by which the program is called.
    pub(super) program: &'static str,
    /// Function that creates the supervisor of the run, if the run has one.
    pub(super) supervisor: Option<Makes>,
}

impl Default for Stage {
    fn default() -> Self {
        let time = Time::Stepped(Pace::Max);
        Self {
            script: Vec::new(),
            time,
            refusal: None,
            interrupted: None,
            stop: Act::Senses(vec![]),
            finish: Ok(()),
            judgement: None,
            looks: false,
            plan: ToyPlan::lab(),
            program: "./lab_tour",
            supervisor: None,
        }
    }
}

/// Result of a run.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) status: u8,
    pub(super) out: String,
    pub(super) err: String,
    /// Calls to the robot, in order, separated by commas.
    pub(super) journal: String,
    /// Real time that passed in sleeps.
    pub(super) slept: Duration,
}

thread_local! {
    /// The robot that [`ToyTarget::connect`] opens, because a test has no other way to pass a robot to a target.
    static READY: RefCell<Option<Ready>> = const { RefCell::new(None) };
}

/// A toy robot that waits to be opened.
struct Ready {
    time: Time,
    interrupted: Option<ProcessSignal>,
    toy: Toy,
    refusal: Option<Refusal>,
}

impl Stage {
    /// Returns a stage with this script.
    pub(super) fn script(script: impl IntoIterator<Item = Act>) -> Self {
        Self { script: script.into_iter().collect(), ..Self::default() }
    }

    /// Runs the plan with these arguments.
    pub(super) fn run(self, arguments: &[&str]) -> Run {
        self.run_to(arguments, Vec::new())
    }

    /// Runs the plan with these arguments and this standard output.
    pub(super) fn run_to<W: Write + AsText + 'static>(self, arguments: &[&str], sink: W) -> Run {
        let journal = Rc::new(RefCell::new(Vec::new()));
        let signals = Signals::unheard();
        let patience = signals.patience().clone();
        let toy = Toy {
            script: self.script.into(),
            stop: self.stop,
            finish: self.finish,
            judgement: self.judgement,
            looks: self.looks,
            signals: signals.share(),
            journal: Rc::clone(&journal),
        };
        READY.set(Some(Ready { time: self.time, interrupted: self.interrupted, toy, refusal: self.refusal }));
        let out = Rc::new(RefCell::new(sink));
        let slept = Rc::new(Cell::new(Duration::ZERO));
        let mut err = Vec::new();
        let surroundings = Surroundings {
            instants: ByHand(Rc::clone(&slept)),
            signals,
            watch: TurnWatch::default(),
            out: || Box::new(Shared(Rc::clone(&out))) as Box<dyn Write>,
            err: &mut err,
            elapsed: None,
        };
        let arguments = [&self.program].into_iter().chain(arguments).map(OsString::from);
        // The pilot needs a plan that lives as long as the program.
        let plan = self.plan;
        let plan: &'static (dyn Fn() -> ToyPlan + Sync) = Box::leak(Box::new(move || plan.clone()));
        let make = |terms: &RunTerms| (self.supervisor.expect("a supervisor"))(terms);
        let stderr = io::stderr();
        let diversions = |number| (number == 0).then(ToyPlan::lab);
        let supervision = Supervision { supervisor: &make, diversions: &diversions, session: Some(stderr.as_fd()) };
        let supervision = self.supervisor.map(|_| supervision);
        let pilot = |_: &RunTerms| Ok(PlanAlone::new(plan));
        let executable = PlanOnTarget::<ToyTarget, _, _>::new(plan, &pilot).supervised(supervision);
        let status = session("Lab".into(), Call::of_executable(arguments), &executable, surroundings);
        // If readers were not waited for, a program could end before its last message is written.
        assert_ne!(patience.limit(), Some(Duration::ZERO), "readers are not waited for at the end");
        let text = out.borrow().text();
        let journal = journal.borrow().join(", ");
        Run { status, out: text, err: String::from_utf8(err).unwrap(), journal, slept: slept.get() }
    }
}

/// A sink whose text a test can read after the run.
pub(super) trait AsText {
    fn text(&self) -> String;
}

impl AsText for Vec<u8> {
    fn text(&self) -> String {
        String::from_utf8(self.clone()).unwrap()
    }
}

/// A sink that the test and the run share.
struct Shared<W>(Rc<RefCell<W>>);

impl<W: Write> Write for Shared<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

/// Time that passes only in sleeps.
struct ByHand(Rc<Cell<Duration>>);

impl Instants for ByHand {
    fn now(&mut self) -> Duration {
        self.0.get()
    }

    fn sleep(&mut self, time: Duration) {
        self.0.set(self.0.get() + time);
    }

    fn keep_time(&mut self) -> Result<(), String> {
        Err("real-time scheduling".to_owned())
    }
}

/// The target of the toy robot.
struct ToyTarget;

impl Target for ToyTarget {
    const NAME: &'static str = "toy";
    const PERIOD: Duration = Duration::from_millis(100);
    type Robot = Toy;
    const OBSERVATION: Option<Observation<Toy>> = Some(Observation::by(|toy| toy));

    fn arguments(command: Command) -> Command {
        command.arg(Arg::new("device").long("device").value_name("PATH").help("Where the toy is"))
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        if matches.contains_id("device") {
            return Err("a toy has no device".to_owned());
        }
        Ok(READY.with_borrow(|ready| ready.as_ref().unwrap().time))
    }

    fn connect(_: &ArgMatches, _: Duration, request: &StopRequest) -> Result<Toy, Refusal> {
        let Ready { interrupted, toy, refusal, .. } = READY.take().unwrap();
        if let Some(signal) = interrupted {
            assert!(!request.is_made());
            toy.signals.raise(signal);
            assert!(request.is_made());
        }
        refusal.map_or(Ok(toy), Err)
    }
}

/// The toy robot. Its input is a number; the null input is 0.
#[derive(Debug)]
struct Toy {
    script: VecDeque<Act>,
    stop: Act,
    finish: Result<(), String>,
    judgement: Option<Judgement>,
    looks: bool,
    signals: Signals,
    journal: Rc<RefCell<Vec<String>>>,
}

impl Toy {
    fn note(&self, what: String) {
        self.journal.borrow_mut().push(what);
    }

    fn act(&self, act: Act) -> Result<Sensed, &'static str> {
        match act {
            Act::Senses(fired) => Ok(Sensed(fired)),
            Act::Hears(signal) => {
                self.signals.raise(signal);
                Ok(Sensed::default())
            }
            Act::Fails(why) => Err(why),
            Act::Panics(why) => panic!("{why}"),
        }
    }
}

impl Robot for Toy {
    type Output = Sensed;
    type Input = u32;
    type Error = &'static str;

    fn exchange(&mut self, input: &u32) -> Result<Sensed, &'static str> {
        self.note(format!("exchange {input}"));
        let act = self.script.pop_front().unwrap_or(Act::Senses(vec![]));
        self.act(act)
    }

    fn stop(&mut self) -> Result<(), &'static str> {
        self.note("stop".to_owned());
        self.act(self.stop.clone()).map(drop)
    }
}

impl Observer for Toy {
    fn began(&mut self, state: u64, law: &str, t: Nanos) {
        self.note(format!("began {state} {law} at {}", t.seconds()));
    }

    fn looks(&self) -> bool {
        self.looks
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        // Noted only if the robot follows the plan's state: these runs test it sufficiently.
        if self.looks {
            let Ended { plan, is_over, by, t } = ended;
            let how = if *is_over { "over" } else { "stopped" };
            self.note(format!("{plan} {how} at {} by {by}", t.seconds()));
        }
    }

    fn turned(&mut self, standing: &PlanPosition<'_>) {
        let scopes: Vec<String> = standing
            .scopes
            .iter()
            .map(|EnclosingScope { name, condition, since }| format!("{name}[{condition}] {}", since.seconds()))
            .collect();
        self.note(format!("{} {} in {}", standing.state, standing.law, scopes.join(" ")));
    }

    fn judged(&self) -> Option<Judgement> {
        if self.judgement.is_some() {
            self.note("judged".to_owned());
        }
        self.judgement.clone()
    }

    fn finish(&mut self) -> Result<(), String> {
        self.note("finish".to_owned());
        self.finish.clone()
    }
}
