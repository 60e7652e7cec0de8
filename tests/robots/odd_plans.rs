//! Tests plans whose laws hang or panic, on trial and not, and the threads that drop plans and create modules.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use mdle_engine::{Declare, Fault, Library, Module, Out, PlanFacts, Refusal, StoredPlan, Turn, When};
use mdle_host::{Pace, Pilot as _, PilotFault, Time, claim_for_worker};
use mdle_runtime::{
    self as runtime, Argument, Begin, Comparison, Completes, Control, Law, Limit, Nanos, Sensed, Turn as PlanTurn,
    Twist,
};
use mdle_sim::alphabet::{Alphabet, AnyControl, AnyInterrupt, AnyLaw, AnySignal};

use super::modules::{Run, loaded};

/// An unusual effect of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Deed {
    /// No unusual effect.
    None,
    /// Does not return until the test is over.
    Hangs,
    /// Returns three turns later, as counted by [`TURN`], at each time in [`SLOW`].
    Slow,
    /// Panics.
    Panics,
    /// Records the name of the thread that drops its plan.
    Noted,
}

/// Speeds of `go` that select an unusual effect, in m/s.
const DEEDS: [(f64, Deed); 4] =
    [(-0.13, Deed::Hangs), (-0.14, Deed::Panics), (-0.15, Deed::Noted), (-0.16, Deed::Slow)];
/// Times at which a slow law takes long.
const SLOW: [Nanos; 2] = [Nanos(300_000_000), Nanos(1_000_000_000)];
/// Number of the current turn, for which slow laws wait.
pub(super) static TURN: AtomicU64 = AtomicU64::new(u64::MAX);
/// `true` once laws that hang should return.
static IS_OVER: AtomicBool = AtomicBool::new(false);
/// Names of the threads that have dropped plans with [`Deed::Noted`].
static DROPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// The alphabet of the simulated robot, in which some laws have unusual effects.
pub(super) struct Odd;

pub(super) struct OddControl(AnyControl, Deed);

pub(super) struct OddLaw(AnyLaw, Deed);

impl runtime::Alphabet for Odd {
    type Output = Sensed;
    type Input = Twist;
    type Interrupt = AnyInterrupt;
    type Signal = AnySignal;
    type Control = OddControl;
    type Law = OddLaw;

    const NAME: &'static str = Alphabet::NAME;
    const HASH: u64 = Alphabet::HASH;
    const CAPABILITIES: &'static [&'static str] = Alphabet::CAPABILITIES;
    const LIMITS: &'static [Limit] = Alphabet::LIMITS;

    fn interrupt(name: &str, arguments: &[Argument<'_>]) -> Option<AnyInterrupt> {
        Alphabet::interrupt(name, arguments)
    }

    fn signal(name: &str, arguments: &[Argument<'_>]) -> Option<AnySignal> {
        Alphabet::signal(name, arguments)
    }

    fn comparison(comparison: Comparison<AnySignal, AnySignal>) -> Option<AnyInterrupt> {
        Alphabet::comparison(comparison)
    }

    fn control(name: &str, arguments: &[Argument<'_>]) -> Option<OddControl> {
        let deed = DEEDS.into_iter().find(|(speed, _)| match arguments {
            [Argument::Speed(v), ..] => name == "go" && (v.0 - speed).abs() < 1e-6,
            _ => false,
        });
        Some(OddControl(Alphabet::control(name, arguments)?, deed.map_or(Deed::None, |(_, deed)| deed)))
    }
}

impl Control<Sensed> for OddControl {
    type Law = OddLaw;

    fn begin(&self, y: &Sensed, begin: Begin) -> OddLaw {
        OddLaw(self.0.begin(y, begin), self.1)
    }
}

impl Drop for OddControl {
    fn drop(&mut self) {
        if self.1 == Deed::Noted {
            let thread = thread::current().name().unwrap_or_default().to_owned();
            DROPPED.lock().unwrap().push(thread);
        }
    }
}

impl Law<Sensed> for OddLaw {
    type Input = Twist;

    fn input(&mut self, y: &Sensed, t: Nanos) -> Twist {
        match self.1 {
            Deed::None | Deed::Noted => {}
            Deed::Hangs => {
                while !IS_OVER.load(Ordering::Relaxed) {
                    thread::sleep(Duration::from_millis(5));
                }
            }
            Deed::Panics => panic!("index 7 of 3"),
            Deed::Slow => {
                let last = y.at.0 / 100_000_000 + 3;
                while SLOW.contains(&y.at) && TURN.load(Ordering::Relaxed) < last {
                    thread::sleep(Duration::from_millis(1));
                }
            }
        }
        self.0.input(y, t)
    }
}

impl Completes<Sensed> for OddLaw {
    fn completed(&self, y: &Sensed, t: Nanos) -> bool {
        self.0.completed(y, t)
    }
}

const STAND: &str = "{ Stand (null) (Atom (wait 60s) (go 5 0)) (Atom (null) stop) }";

fn run(text: &str, time: Time, library: &Library<Sensed>) -> Run<Odd> {
    Run::begin(text, library, time).unwrap()
}

/// Returns the text of a plan whose first atom has this law.
fn plan(law: &str) -> String {
    format!("{{ Odd (null) (Atom (wait 60s) {law}) (Atom (null) stop) }}")
}

/// Runs turns until the run ends with a fault, or until the first plan continues after the plan `Odd` has begun.
/// Returns the number of turns in which `Odd` drove the robot, the messages, and the fault, if any.
fn outcome(run: &mut Run<Odd>) -> (usize, Vec<String>, Option<PilotFault>) {
    let (mut messages, mut driven, mut has_begun) = (Vec::new(), 0, run.engine.plans().number() == 1);
    for _ in 0..200 {
        let turn = run.turn();
        run.engine.messages(&mut |message| messages.push(message.to_owned()));
        let turn = match turn {
            Ok(turn) => turn,
            Err(fault) => return (driven, messages, Some(fault)),
        };
        let is_odd = run.engine.plans().name() == "Odd";
        has_begun |= is_odd;
        if has_begun && !is_odd {
            return (driven, messages, None);
        }
        driven += usize::from(is_odd && matches!(turn, PlanTurn::Law(_)));
    }
    panic!("no end: {messages:?}");
}

/// Returns `true` if the first plan drives the robot in one of the next turns. On a busy machine, some turns are late.
fn drives_on(run: &mut Run<Odd>) -> bool {
    let drives = (0..50).any(|_| {
        run.turn().unwrap();
        run.input.v.0 > 0.0
    });
    drives && run.engine.plans().name() == "Stand"
}

#[test]
fn a_law_that_panics_stops_the_robot() {
    for time in [Time::Stepped(Pace::Max), Time::Wall] {
        // `Odd` is the plan of the run and panics at once.
        let mut first = run(&plan("(go -14 0)"), time, &Library::new());
        let (driven, _, fault) = outcome(&mut first);
        assert_eq!((driven, fault), (0, Some(PilotFault::Panicked("index 7 of 3".to_owned()))));
        // `Odd` is on trial and panics at once: the previous plan continues.
        let mut second = run(STAND, time, &Library::new());
        second.turn().unwrap();
        second.engine.plans_mut().replace(loaded(&plan("(go -14 0)")).plan(), When::Now);
        let (driven, messages, fault) = outcome(&mut second);
        let sentence = "warning: the plan Odd on trial is ended: its code panicked, which is a bug: index 7 of 3";
        assert_eq!((driven, fault), (0, None));
        assert!(messages.iter().any(|message| message == sentence), "{messages:?}");
        assert!(drives_on(&mut second), "the plan before drives on");
    }
}

#[test]
fn a_law_that_hangs_stops_the_robot() {
    // Only on workers: in stepped time the engine waits for a slow law.
    let mut first = run(&plan("(go -13 0)"), Time::Wall, &Library::new());
    let (driven, messages, fault) = outcome(&mut first);
    assert_eq!((driven, fault), (0, Some(PilotFault::Stopped("the plan has not ended its turn".to_owned()))));
    assert!(messages.iter().any(|message| message.contains("`mdle` is late")), "{messages:?}");
    assert_eq!(first.input, Twist::default());
    let mut second = run(STAND, Time::Wall, &Library::new());
    second.turn().unwrap();
    second.engine.plans_mut().replace(loaded(&plan("(go -13 0)")).plan(), When::Now);
    let (driven, messages, fault) = outcome(&mut second);
    assert_eq!((driven, fault), (0, None));
    let sentence = "warning: the plan Odd on trial is ended: it has not ended its turn";
    assert!(messages.iter().any(|message| message == sentence), "{messages:?}");
    assert!(drives_on(&mut second), "the plan before drives on");
    IS_OVER.store(true, Ordering::Relaxed);
}

/// Runs turns until a plan with [`Deed::Noted`] has been dropped, and returns the name of the thread that dropped it.
fn dropped(run: &mut Run<Odd>) -> String {
    let begun = Instant::now();
    (0..5).for_each(|_| _ = run.turn().unwrap());
    loop {
        if let Some(thread) = DROPPED.lock().unwrap().pop() {
            return thread;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "the plan is not dropped");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn plans_are_dropped_by_the_janitor() {
    let mut run = run(STAND, Time::Stepped(Pace::Max), &Library::new());
    let noted = || loaded::<Odd>(&plan("(go -15 0)")).plan();
    let other = || loaded::<Odd>(STAND).plan();
    run.engine.plans_mut().set_trial(Nanos(100_000_000));
    run.turn().unwrap();
    let mut threads = Vec::new();

    run.engine.plans_mut().replace(noted(), When::Now);
    run.turn().unwrap();
    run.engine.plans_mut().replace(other(), When::Now);
    threads.push(("replaced, after the trial of the next", dropped(&mut run)));

    run.engine.plans_mut().replace(noted(), When::Now);
    run.turn().unwrap();
    run.engine.rollback("asked for").unwrap();
    threads.push(("rolled back", dropped(&mut run)));

    run.engine.plans_mut().replace(noted(), When::PlanEnds);
    run.engine.plans_mut().cancel();
    threads.push(("cancelled", dropped(&mut run)));

    run.engine.plans_mut().replace(noted(), When::PlanEnds);
    run.engine.plans_mut().replace(other(), When::PlanEnds);
    threads.push(("superseded", dropped(&mut run)));

    let stored = |text: &str| StoredPlan {
        name: "Odd".into(),
        files: [("odd.mdle".to_owned(), text.to_owned())].into(),
        loaded: loaded(text),
        facts: PlanFacts::default(),
    };
    run.engine.plans_mut().store(stored(&plan("(go -15 0)"))).unwrap();
    run.engine.plans_mut().delete("Odd").unwrap();
    threads.push(("deleted", dropped(&mut run)));

    run.engine.plans_mut().store(stored(&plan("(go -15 0)"))).unwrap();
    run.engine.plans_mut().store(stored(STAND)).unwrap();
    threads.push(("stored anew", dropped(&mut run)));

    run.engine.plans_mut().replace(noted(), When::Now);
    (0..5).for_each(|_| _ = run.turn().unwrap());
    run.divert(other());
    threads.push(("diverted", dropped(&mut run)));

    let wrong: Vec<_> = threads.iter().filter(|(_, thread)| thread != "mdle janitor").collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A module that publishes nothing.
struct Silent(#[expect(dead_code, reason = "declared alone")] Out<f64>);

impl Module<Sensed> for Silent {
    fn turn(&mut self, _: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        Ok(())
    }
}

/// Returns the scheduling policy and the real-time priority of this thread: fields 41 and 40 of proc(5).
fn scheduling() -> [String; 2] {
    let stat = fs::read_to_string("/proc/thread-self/stat").unwrap();
    let fields: Vec<_> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    [fields[38], fields[37]].map(str::to_owned)
}

#[test]
fn a_module_is_made_with_ordinary_scheduling() {
    let scheduled = Arc::new(Mutex::new(Vec::new()));
    let mut library = Library::new();
    let own = Arc::clone(&scheduled);
    library.registered("silent", move |declare: &mut Declare| {
        own.lock().unwrap().push(scheduling());
        Silent(declare.publishes("nothing"))
    });
    let made = thread::spawn(move || {
        let mut run = run(STAND, Time::Stepped(Pace::Max), &library);
        run.engine.modules_mut().unload("silent").unwrap();
        // Gives this thread the scheduling of the control thread, where the system permits it.
        claim_for_worker();
        let number = run.engine.load("silent").unwrap();
        let begun = Instant::now();
        let result = loop {
            if let Some((answered, result)) = run.engine.progress() {
                assert_eq!(answered, number);
                break result;
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "the module is not made");
            thread::sleep(Duration::from_millis(2));
        };
        assert_eq!(run.engine.load("silent"), Err(Refusal::NameTaken("silent".to_owned()).to_string()));
        result
    });
    assert_eq!(made.join().unwrap(), Ok(()));
    let scheduled = scheduled.lock().unwrap();
    assert_eq!(*scheduled, [["0", "0"], ["0", "0"]].map(|fields| fields.map(str::to_owned)));
}
