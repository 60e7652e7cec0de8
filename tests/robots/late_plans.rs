//! Tests that an engine that does not wait for plans can repeat, to the bit, a run in which plans are late, skipped and
//! rolled back.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::thread;

use mdle_engine::{Engine, Library, PlanEvent, When};
use mdle_host::{Microphones, Pace, Pilot as _, PilotTurn, RunTerms, StopRequest, Time, Transitions};
use mdle_record::{RecordedChange, RecordedTransition};
use mdle_runtime::{Nanos, Robot as _, Sensed, Turn, Twist};
use mdle_sim::{Simulated, World};
use mdle_tests::chance::sized;

use super::modules::{PERIOD, loaded};
use super::odd_plans::{Odd, TURN};

/// A plan whose law takes long at two times.
const FIRST: &str = "{ First (null) ((Atom (wait 400ms) (go -16 0)) (Atom (wait 200ms) (go -16 0.1)))^inf }";
const SECOND: &str = "{ Second (null) ((Atom (wait 200ms) (go -16 0.2)) (Atom (wait 300ms) (go -16 0.3)))^inf }";

/// Number of turns.
const TURNS: u64 = 40;

/// Locked by the test that controls the turns for which slow laws wait.
static SLOW_TURNS: Mutex<()> = Mutex::new(());

/// A turn of a run, with all data that determine it.
#[derive(Debug)]
struct Made {
    y: Sensed,
    t: Nanos,
    changes: Vec<RecordedChange>,
    outcome: Outcome,
}

/// Outcome of a turn: the input, the transitions, the state, and the number of the plan.
#[derive(Debug, PartialEq)]
struct Outcome(Turn<Twist>, Vec<RecordedTransition>, Option<u64>, u64);

fn engine(time: Time) -> Engine<Odd> {
    let terms = RunTerms { time, period: PERIOD, request: StopRequest::default(), microphones: Microphones::default() };
    Engine::new(loaded(FIRST).plan(), &Library::new(), &terms).unwrap()
}

fn turn(engine: &mut Engine<Odd>, y: &Sensed, number: u64) -> Outcome {
    let (mut y, t, mut transitions) = (*y, Nanos(number * 100_000_000), Transitions::default());
    engine.complete(&mut y, t);
    let turn = engine.turn(PilotTurn { y: &y, t, number }, &mut transitions).unwrap();
    let steps =
        transitions.iter().map(|(made, fired)| RecordedTransition::new(made, fired.iter().map(|(number, _)| *number)));
    Outcome(turn, steps.collect(), engine.machine().map(|machine| machine.state()), engine.plan_number())
}

/// Returns the turns of a run on workers, with a deadline for each turn.
fn live() -> Vec<Made> {
    let _held = SLOW_TURNS.lock();
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::new(&world, world.start, Some(3), PERIOD).unwrap();
    let (mut engine, mut input, mut turns) = (engine(Time::Wall), Twist::default(), Vec::new());
    engine.record();
    for number in 0..TURNS {
        TURN.store(number, Ordering::Relaxed);
        match number {
            6 => _ = engine.plans_mut().replace(loaded(SECOND).plan(), When::AtomEnds),
            20 => drop(engine.rollback("asked for")),
            30 => _ = engine.plans_mut().replace(loaded(SECOND).plan(), When::Now),
            _ => {}
        }
        let y = robot.exchange(&input).unwrap();
        let outcome = turn(&mut engine, &y, number);
        input = outcome.0.input();
        turns.push(Made { y, t: y.at, changes: engine.take_changes(), outcome });
        // Gives a late turn time to come back a few turns later.
        thread::sleep(PERIOD / 10);
    }
    TURN.store(u64::MAX, Ordering::Relaxed);
    turns
}

#[test]
fn late_turns_replay_to_the_bit() {
    (0..sized(2, 400)).for_each(|_| assert_replays(&live()));
}

fn assert_replays(turns: &[Made]) {
    let count = |kind: &RecordedChange| turns.iter().filter(|turn| turn.changes.contains(kind)).count();
    assert!(count(&RecordedChange::Late) >= 2 && count(&RecordedChange::Back) >= 2, "{turns:?}");
    assert!(turns.last().unwrap().outcome.3 >= 3, "{turns:?}");
    let mut again = engine(Time::Stepped(Pace::Max)).repeating(None);
    for (number, Made { y, t, changes, outcome }) in (0..).zip(turns) {
        for change in changes {
            if let RecordedChange::Armed { when, .. } = change {
                again.plans_mut().replace(loaded(SECOND).plan(), When::of_number(*when).unwrap());
            } else {
                again.repeat(change);
            }
        }
        assert_eq!(turn(&mut again, y, number), *outcome, "turn {number} at {t:?} after {changes:?}");
    }
}

#[test]
fn a_late_turn_loses_no_plan_that_waits() {
    let _held = SLOW_TURNS.lock();
    let world = World::named("hall").unwrap().unwrap();
    let mut robot = Simulated::new(&world, world.start, Some(3), PERIOD).unwrap();
    let (mut engine, mut input, mut requests, mut events) = (engine(Time::Wall), Twist::default(), vec![], vec![]);
    for number in 0..9 {
        TURN.store(number, Ordering::Relaxed);
        // The first requested plan was passed on with turn 3, which is late and still runs when the second one is
        // armed.
        if [3, 4].contains(&number) {
            requests.push(engine.plans_mut().replace(loaded(SECOND).plan(), When::PlanEnds));
        }
        let y = robot.exchange(&input).unwrap();
        input = turn(&mut engine, &y, number).0.input();
        events.extend(engine.plans_mut().take_events());
        thread::sleep(PERIOD / 10);
    }
    TURN.store(u64::MAX, Ordering::Relaxed);
    let [first, second] = requests[..] else { panic!("{requests:?}") };
    let replaced = PlanEvent::Replaced(first, "Second".into());
    assert_eq!(events, [PlanEvent::Armed(first), PlanEvent::Armed(second), replaced]);
    assert_eq!(engine.plans().armed(), Some(("Second", When::PlanEnds)));
}
