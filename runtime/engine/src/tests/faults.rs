//! Tests that a fault affects only its own module, and that no turn waits beyond its deadline.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use mdle_runtime::Nanos;

use super::{PERIOD, number, turn, workers};
use crate::{
    Background, Candidate, Declare, Event, Exchange, Fault, In, Module, ModuleState, Modules, Out, Service, Threads,
    Turn,
};

/// A module that counts its turns, and performs an action in one of them.
struct Counter {
    turns: Out<f64>,
    count: f64,
    other: (u64, Deed),
}

/// Action of a module in its turn.
type Deed = fn(&mut Turn<'_, f64>, Out<f64>) -> Result<(), Fault>;

impl Module<f64> for Counter {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        self.count += 1.0;
        turn.publish(self.turns, self.count);
        if turn.number == self.other.0 { (self.other.1)(turn, self.turns) } else { Ok(()) }
    }
}

fn counter(name: &str, at: u64, other: Deed) -> Candidate<f64> {
    let make = |declare: &mut Declare| Counter { turns: declare.publishes("turns"), count: 0.0, other: (at, other) };
    Candidate::registered(name, make).unwrap()
}

fn healthy(name: &str) -> Candidate<f64> {
    counter(name, 0, |_, _| Ok(()))
}

/// Returns the modules, loaded on these threads.
fn modules(threads: Threads, candidates: impl IntoIterator<Item = Candidate<f64>>) -> Modules<f64> {
    let mut modules = Modules::new(threads, Service::WhenReady).unwrap();
    candidates.into_iter().for_each(|candidate| modules.load(candidate).unwrap());
    modules.prepare();
    modules
}

/// Makes turns; returns the events, each with the turn in which it occurred.
fn events(modules: &mut Modules<f64>, turns: std::ops::Range<u64>) -> Vec<String> {
    let each = turns.map(|number| {
        turn(modules, number);
        modules.events().iter().map(move |event| format!("turn {number}: {event}")).collect::<Vec<_>>()
    });
    each.flatten().collect()
}

#[test]
fn a_module_that_fails_or_panics_makes_no_further_turn() {
    for threads in [Threads::Sequential, workers(2)] {
        let fails = counter("fails", 3, |_, _| Err(Fault("the camera is unplugged".to_owned())));
        let panics = counter("panics", 5, |_, _| panic!("index 7 of 3"));
        let mut modules = modules(threads, [fails, panics, healthy("well")]);
        insta::allow_duplicates! {
            insta::assert_snapshot!(events(&mut modules, 0..10).join("\n"), @"
            turn 3: module `fails` makes no further turn: the camera is unplugged
            turn 5: module `panics` makes no further turn: its code panicked, which is a bug: index 7 of 3
            ");
        }
        // The turn with the fault publishes nothing.
        let counts = ["fails", "panics", "well"].map(|name| number(&modules, name, "turns"));
        assert_eq!(counts, [Some((3.0, 2)), Some((5.0, 4)), Some((10.0, 9))]);
        assert_eq!(modules.names().nth(1), Some(("panics", ModuleState::Failed)));
    }
}

#[test]
fn a_panic_in_start_or_stop_is_a_fault() {
    struct Bad(&'static str);
    impl Module<f64> for Bad {
        fn turn(&mut self, _: &mut Turn<'_, f64>) -> Result<(), Fault> {
            Ok(())
        }
        fn start(&mut self) {
            assert_ne!(self.0, "start");
        }
        fn stop(&mut self) {
            assert_ne!(self.0, "stop", "no way");
        }
    }
    let bad = |place| Candidate::registered(place, |_| Bad(place)).unwrap();
    let mut modules = modules(workers(1), [bad("start"), bad("stop")]);
    turn(&mut modules, 0);
    assert_eq!(
        modules.names().map(|(_, standing)| standing).collect::<Vec<_>>(),
        [ModuleState::Failed, ModuleState::Active]
    );
    modules.hold("stop", true).unwrap();
    modules.prepare();
    turn(&mut modules, 1);
    assert!(matches!(modules.events(), [Event::Failed(..)]), "{:?}", modules.events());
}

#[test]
fn a_panic_while_a_module_is_made_refuses_it() {
    let refusal = Candidate::<f64>::registered("bad", |_| -> Counter { panic!("no device") }).map(|_| ()).unwrap_err();
    assert_eq!(refusal.to_string(), "module `bad` panicked while it was made, which is a bug: no device");
}

#[test]
fn nan_is_never_published() {
    let bad = counter("bad", 2, |turn, out| {
        turn.publish(out, f64::NAN);
        Ok(())
    });
    let mut modules = modules(Threads::Sequential, [bad]);
    assert_eq!(events(&mut modules, 0..3), ["turn 2: /usr/bad/turns was NaN, which is not published"]);
    assert_eq!(number(&modules, "bad", "turns"), Some((2.0, 1)), "the value before grows old");
    turn(&mut modules, 3);
    assert_eq!((number(&modules, "bad", "turns"), modules.board().posts()[0].refused), (Some((4.0, 3)), 1));
}

/// A door at which modules block until a test opens it.
#[derive(Default)]
struct Door(Mutex<bool>, Condvar);

impl Door {
    fn open(&self) {
        *self.0.lock().unwrap() = true;
        self.1.notify_all();
    }
}

/// A module that counts its turns, and blocks at a door in one of them.
struct Waits {
    turns: Out<f64>,
    count: f64,
    door: Arc<Door>,
}

impl Module<f64> for Waits {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        self.count += 1.0;
        turn.publish(self.turns, self.count);
        if turn.number == 3 {
            let Door(is_open, opened) = &*self.door;
            drop(opened.wait_while(is_open.lock().unwrap(), |is_open| !*is_open).unwrap());
        }
        Ok(())
    }
}

fn waits(name: &str, door: &Arc<Door>) -> Candidate<f64> {
    let make = |declare: &mut Declare| {
        declare.priority(1);
        Waits { turns: declare.publishes("turns"), count: 0.0, door: Arc::clone(door) }
    };
    Candidate::registered(name, make).unwrap()
}

/// Makes a turn with a deadline that only a blocked module misses; each turn advances the engine's clock by 100
/// periods. Returns `true` if the turn lasted until the deadline.
fn turn_until(modules: &mut Modules<f64>, number: u64) -> bool {
    let deadline = Instant::now() + Duration::from_secs(1);
    modules.turn(0.0, number, Nanos(number * 100 * PERIOD), Some(deadline));
    let is_over = Instant::now() >= deadline;
    modules.settle();
    modules.prepare();
    is_over
}

#[test]
fn a_module_that_never_returns_costs_one_turn() {
    // The blocking modules occupy both workers, and are taken before the other modules.
    let door = Arc::<Door>::default();
    let mut modules =
        modules(workers(2), [healthy("well"), healthy("fine"), waits("first", &door), waits("second", &door)]);
    let (mut events, mut over) = (Vec::new(), Vec::new());
    for number in 0..40 {
        over.extend(turn_until(&mut modules, number).then_some(number));
        events.extend(modules.events().iter().map(|event| format!("turn {number}: {event}")));
    }
    insta::assert_snapshot!(events.join("\n"), @"
    turn 3: module `first` is late: the turn ended without it
    turn 3: module `second` is late: the turn ended without it
    turn 13: module `first` is given up: it has not ended its turn
    turn 13: module `second` is given up: it has not ended its turn
    ");
    assert_eq!(over, [3]);
    assert_eq!(["first", "well"].map(|name| modules.fault(name)), ["it has not ended its turn", ""]);
    // In the turn in which both workers hang, no worker runs the other modules.
    let turns = |name| modules.board().post(name, "turns").unwrap().reading.clone().unwrap().value.number();
    assert_eq!(["first", "well", "fine"].map(turns), [Some(3.0), Some(39.0), Some(39.0)]);
    modules.unload("first").unwrap();
    modules.load(healthy("first")).unwrap();
    modules.prepare();
    turn(&mut modules, 41);
    assert_eq!(modules.names().filter(|(_, standing)| *standing == ModuleState::Active).count(), 3);
    door.open();
}

#[test]
fn a_late_module_publishes_when_it_is_done() {
    let door = Arc::<Door>::default();
    let mut modules = modules(workers(1), [waits("slow", &door), healthy("well")]);
    (0..5).for_each(|number| _ = turn_until(&mut modules, number));
    let published = |modules: &Modules<f64>| {
        let reading = modules.board().post("slow", "turns")?.reading.clone()?;
        Some((reading.value.number()?, reading.at.0 / PERIOD / 100))
    };
    assert_eq!(published(&modules), Some((3.0, 2)));
    door.open();
    let mut number = 5;
    while matches!(modules.names().next(), Some(("slow", ModuleState::Late(3, _)))) {
        turn_until(&mut modules, number);
        std::thread::sleep(Duration::from_millis(1));
        number += 1;
    }
    assert_eq!(published(&modules), Some((4.0, number - 1)));
    turn_until(&mut modules, number);
    assert_eq!(published(&modules), Some((5.0, number)));
}

#[test]
fn a_module_that_is_late_again_is_counted() {
    struct Slow;
    impl Module<f64> for Slow {
        fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
            if turn.number % 4 == 1 {
                std::thread::sleep(Duration::from_millis(60));
            }
            Ok(())
        }
    }
    let mut modules = modules(workers(1), [Candidate::registered("slow", |_: &mut Declare| Slow).unwrap()]);
    let mut late = Vec::new();
    for number in 0..12 {
        modules.turn(0.0, number, Nanos(number * PERIOD), Some(Instant::now() + Duration::from_millis(20)));
        modules.settle();
        modules.prepare();
        let events = modules.events().iter().filter(|event| matches!(event, Event::Late(_)));
        late.extend(events.map(|_| number));
        std::thread::sleep(Duration::from_millis(60));
    }
    assert_eq!(late.len(), 1, "{late:?}");
    assert!(modules.late_turns("slow") >= 3);
}

/// A background module that can panic in, or return after, a given exchange.
struct Busy {
    out: Out<f64>,
    read: In<f64>,
    exchanges: Arc<AtomicU64>,
    dies: Option<(u64, bool)>,
}

impl Background for Busy {
    fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        loop {
            let number = self.exchanges.fetch_add(1, Ordering::SeqCst);
            let ended = exchange.exchange(|offer| {
                if self.dies == Some((number, true)) {
                    panic!("the line is broken");
                }
                offer.publish(self.out, offer.get(self.read).unwrap_or(-1.0));
            });
            if ended.is_err() || self.dies == Some((number, false)) {
                return Ok(());
            }
        }
    }
}

fn busy(name: &str, dies: Option<(u64, bool)>) -> (Candidate<f64>, Arc<AtomicU64>) {
    let exchanges = Arc::<AtomicU64>::default();
    let make = |declare: &mut Declare| Busy {
        out: declare.publishes("out"),
        read: declare.reads("well", "turns"),
        exchanges: Arc::clone(&exchanges),
        dies,
    };
    (Candidate::background(name, make).unwrap(), exchanges)
}

#[test]
fn an_exchange_waits_for_the_next_break() {
    let (endless, exchanges) = busy("endless", None);
    let mut modules = Modules::new(workers(1), Service::WhenDue).unwrap();
    modules.load(endless).unwrap();
    modules.load(healthy("well")).unwrap();
    modules.prepare();
    for number_of in 0..100 {
        turn(&mut modules, number_of);
        // The value that the module read was published at the previous turn break.
        let read = if number_of == 0 { -1.0 } else { number_of as f64 };
        assert_eq!(number(&modules, "endless", "out"), Some((read, number_of)));
    }
    assert!(exchanges.load(Ordering::SeqCst) <= 101);
    modules.unload("endless").unwrap();
    assert_eq!(number(&modules, "endless", "out"), None);
}

#[test]
fn a_background_module_that_dies_is_reported() {
    let mut modules = Modules::new(Threads::Sequential, Service::WhenDue).unwrap();
    for (name, dies) in [("panics", (3, true)), ("returns", (5, false))] {
        modules.load(busy(name, Some(dies)).0).unwrap();
    }
    modules.load(healthy("well")).unwrap();
    modules.prepare();
    insta::assert_snapshot!(events(&mut modules, 0..10).join("\n"), @"
    turn 3: module `panics` makes no further turn: its code panicked, which is a bug: the line is broken
    turn 6: module `returns` has ended
    ");
    assert_eq!(["panics", "returns"].map(|name| number(&modules, name, "out")), [Some((2.0, 2)), Some((5.0, 5))]);
}

#[test]
fn a_module_that_has_failed_delays_no_end() {
    let fails = Candidate::background("fails", |declare: &mut Declare| {
        declare.farewell(Duration::from_secs(20));
        Fails
    });
    let mut modules = modules(Threads::Sequential, [fails.unwrap()]);
    let begun = Instant::now();
    while modules.names().all(|(_, state)| state == ModuleState::Active) {
        turn(&mut modules, 0);
    }
    assert_eq!(modules.names().next(), Some(("fails", ModuleState::Failed)));
    drop(modules);
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

/// A background module that fails immediately.
struct Fails;

impl Background for Fails {
    fn run(self: Box<Self>, _: Exchange) -> Result<(), Fault> {
        Err(Fault("the line is cut".to_owned()))
    }
}

#[test]
fn stepped_time_waits_for_a_background_module() {
    struct Asleep(Out<f64>);
    impl Background for Asleep {
        fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
            let mut count = 0.0;
            loop {
                std::thread::sleep(Duration::from_millis(5));
                count += 1.0;
                if exchange.exchange(|offer| offer.publish(self.0, count)).is_err() {
                    return Ok(());
                }
            }
        }
    }
    let asleep = Candidate::background("asleep", |declare| {
        declare.latency(Nanos(3 * PERIOD));
        Asleep(declare.publishes("out"))
    });
    let mut modules = Modules::new(Threads::Sequential, Service::WhenDue).unwrap();
    modules.load(asleep.unwrap()).unwrap();
    modules.prepare();
    let mut values = Vec::new();
    for number_of in 0..8 {
        turn(&mut modules, number_of);
        values.push(number(&modules, "asleep", "out"));
    }
    assert_eq!(values[..4], [None, None, None, Some((1.0, 3))]);
    assert_eq!(values[4..], [Some((1.0, 3)), Some((1.0, 3)), Some((2.0, 6)), Some((2.0, 6))]);
}
