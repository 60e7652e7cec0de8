//! Tests that a turn in which nothing is loaded and no request arrives allocates no memory: neither in the plan, nor in
//! modules, the turn break or safety rules.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::load::{self, LoadedPlan};
use mdle_engine::safety::{Conditions, Guardian, Rules, read};
use mdle_engine::{Declare, Engine, Fault, In, Library, Module, Out};
use mdle_host::{Helm, Microphones, Pace, RunTerms, StopRequest, Supervised, Time, Transitions};
use mdle_runtime::{Nanos, Radians, Robot as _, Sensed};
use mdle_sim::alphabet::Alphabet;
use mdle_sim::{Simulated, World};
use mdle_tests::golden;

const PERIOD: Duration = Duration::from_secs(1);
/// A plan with timers, a memory, a label, a loop, a frame, a law with a map, and numbers from a module.
const PLAN: &str = "{ Rounds (null)\n  ((Atom (wait 3s OR way > 2m) (go 10 0.2))\n   \
                    turned: FRAME here (Atom (RISING bearing(filter module) > 10deg OR wait 7s) (goAvoid 0 100))\n   \
                    (Atom (after turned AND stuck 3s OR wait 5s) (go 0 -0.3)))^inf\n}\n";
/// Safety rules that sometimes limit the robot's speed and sometimes hold the robot.
const RULES: &str = "[limits]\nspeed = \"15cm/s\"\nacceleration = \"1m/s2\"\n\n[contact]\nthen = \"hold forward\"\n\n\
                     [guards.far]\nwhen = \"theta > 30deg AND bearing(ears module) > 20deg\"\nthen = \"hold\"\n";
/// Number of turns at the start in which memory may be allocated. In the same number of turns after them, allocations
/// are counted.
const TURNS: u64 = 400;

thread_local! {
    /// Number of allocations of this thread.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, with a count of the allocations.
struct Counter;

#[allow(unsafe_code, reason = "an allocator is unsafe by its interface; all calls go to that of the system")]
unsafe impl GlobalAlloc for Counter {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.realloc(place, layout, size) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static COUNTER: Counter = Counter;

/// A module that publishes a bearing that changes with each turn.
struct Ears(Out<Radians>);

impl Module<Sensed> for Ears {
    fn turn(&mut self, turn: &mut mdle_engine::Turn<'_, Sensed>) -> Result<(), Fault> {
        turn.publish(self.0, Radians::from_degrees((turn.number % 30) as f64));
        Ok(())
    }
}

/// A module that reads [`Ears`].
struct Filter {
    read: In<Radians>,
    bearing: Out<Radians>,
}

impl Module<Sensed> for Filter {
    fn turn(&mut self, turn: &mut mdle_engine::Turn<'_, Sensed>) -> Result<(), Fault> {
        let bearing = turn.get(self.read).unwrap_or(Radians(0.0));
        turn.publish(self.bearing, bearing);
        Ok(())
    }
}

fn library() -> Library<Sensed> {
    let mut library = Library::new();
    library.registered("ears", |declare: &mut Declare| Ears(declare.publishes("bearing")));
    let filter = |declare: &mut Declare| Filter {
        read: declare.reads("ears", "bearing"),
        bearing: declare.publishes("bearing"),
    };
    library.registered("filter", filter);
    library
}

fn plan() -> LoadedPlan<Alphabet> {
    let (alphabet, mut sources) = (golden::alphabet(Some("sim")), Sources::default());
    let (plans, found) = mdle_compiler::compile(sources.add("plan.mdle", PLAN), PLAN, &alphabet, None);
    let plan = plans.first().unwrap_or_else(|| panic!("{found:?}"));
    Arc::new(load::load(&plan.machine, &sources, &alphabet).expect("a bound alphabet")).plan()
}

/// Returns the rules, and the conditions of their guards.
fn rules() -> (Rules, Conditions<Alphabet>) {
    let (rules, mut sources) = (read(RULES).unwrap(), Sources::default());
    let conditions =
        Conditions::compile(("rules.toml", RULES), &rules.guards, &mut sources, &golden::alphabet(Some("sim")));
    (rules, conditions.expect("conditions"))
}

/// Returns the turns that allocated memory, except the first [`TURNS`] turns of the run, and the number of transitions
/// in the counted turns.
fn turns_that_allocate(time: Time) -> (Vec<u64>, usize) {
    let terms = RunTerms { time, period: PERIOD, request: StopRequest::default(), microphones: Microphones::default() };
    let (rules, conditions) = rules();
    let engine = Engine::new(plan(), &library(), &terms).and_then(|engine| engine.under_rules(conditions.reads(), []));
    let guardian = Guardian::new(rules, &conditions, PERIOD);
    let supervised = Supervised { supervisor: Box::new(guardian), diversions: Box::new(|_| None) };
    let mut helm = Helm::new(engine.expect("an engine"), Some(supervised));
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::new(&world, world.start, Some(1), PERIOD).unwrap();
    let (mut transitions, mut allocating, mut made) = (Transitions::default(), Vec::new(), 0);
    for number in 0..2 * TURNS {
        let mut y = robot.exchange(helm.input()).unwrap();
        let before = ALLOCATIONS.get();
        transitions.clear();
        helm.turn(&mut y, Nanos(number * 1_000_000_000), number, &mut transitions).expect("a turn");
        if number >= TURNS {
            allocating.extend((ALLOCATIONS.get() > before).then_some(number));
            made += transitions.iter().count();
        }
    }
    (allocating, made)
}

#[test]
fn a_turn_allocates_nothing() {
    for time in [Time::Stepped(Pace::Max), Time::Wall] {
        let (allocating, transitions) = turns_that_allocate(time);
        assert!(transitions > 50, "{time:?}: {transitions} transitions");
        assert!(allocating.is_empty(), "{time:?}: {allocating:?}");
    }
}

#[test]
fn allocations_are_counted() {
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(vec![1_u8; 100]));
    assert_eq!(ALLOCATIONS.get(), before + 1);
}
