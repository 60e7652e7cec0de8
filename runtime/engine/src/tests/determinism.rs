//! Tests that random graphs of modules have the same board after each turn on any number of threads, and in a replay.

use std::time::{Duration, Instant};

use mdle_runtime::Nanos;

use super::graph::{Chance, change, hash, load};
use super::{PERIOD, workers};
use crate::{Arrivals, Candidate, Fault, Module, ModuleState, Modules, Out, Service, Threads, Turn};

/// Number of turns in a run.
const TURNS: u64 = 10_000;

/// Returns the number of random graphs: `count` times the environment variable `MDLE_LONG`, or `count` without it.
fn graphs(count: u64) -> u64 {
    count * std::env::var("MDLE_LONG").ok().and_then(|times| times.parse::<u64>().ok()).unwrap_or(1)
}

/// Runs a random graph; returns the hash of the board after each turn, and the arrivals at each turn break.
fn run(mut modules: Modules<f64>, seed: u64) -> (Vec<u64>, Vec<Arrivals>) {
    load(&mut modules, seed);
    modules.prepare();
    let mut chance = Chance::new(seed);
    let mut now = 0;
    let turn = |number| {
        modules.turn(chance.below(1000) as f64, number, Nanos(now), None);
        modules.settle();
        change(&mut modules, seed, number);
        modules.prepare();
        now += PERIOD + chance.below(1000);
        (hash(&modules), modules.arrivals().clone())
    };
    (0..TURNS).map(turn).unzip()
}

#[track_caller]
fn assert_same(expected: &[u64], board: &[u64], what: &str) {
    let differs = expected.iter().zip(board).position(|(expected, board)| expected != board);
    assert_eq!((differs, expected.len()), (None, board.len()), "{what}");
}

#[test]
fn a_run_with_recorded_arrivals_is_the_same() {
    let mut arrived = 0;
    for seed in 0..graphs(2) {
        let (live, arrivals) = run(Modules::new(workers(2), Service::WhenReady).unwrap(), seed);
        arrived += arrivals.iter().map(|arrivals| arrivals.values.len()).sum::<usize>();
        for threads in [Threads::Sequential, workers(1), workers(2), workers(4)] {
            let (replayed, _) = run(Modules::replaying(threads, arrivals.clone()).unwrap(), seed);
            assert_same(&live, &replayed, &format!("seed {seed} {threads:?}"));
        }
    }
    assert!(arrived > 100, "{arrived} values of background modules");
}

#[test]
fn stepped_time_is_the_same_on_any_threads() {
    for seed in 0..graphs(2) {
        let (sequential, _) = run(Modules::new(Threads::Sequential, Service::WhenDue).unwrap(), seed);
        let (on_workers, _) = run(Modules::new(workers(3), Service::WhenDue).unwrap(), seed);
        assert_same(&sequential, &on_workers, &format!("seed {seed}"));
        assert_ne!(sequential[0], sequential[9_999], "the modules do nothing");
    }
}

/// A module that counts its turns, some of which take longer than their deadline.
struct Dawdler {
    turns: Out<f64>,
    count: u64,
}

impl Module<f64> for Dawdler {
    fn turn(&mut self, turn: &mut Turn<'_, f64>) -> Result<(), Fault> {
        self.count += 1;
        if turn.number % 50 == 20 {
            std::thread::sleep(Duration::from_millis(12));
        }
        turn.publish(self.turns, self.count as f64);
        Ok(())
    }
}

#[test]
fn late_modules_are_late_in_a_replay() {
    let make = |mut modules: Modules<f64>| {
        load(&mut modules, 1);
        for name in ["dawdler", "loiterer"] {
            let dawdler =
                Candidate::registered(name, |declare| Dawdler { turns: declare.publishes("turns"), count: 0 });
            modules.load(dawdler.unwrap()).unwrap();
        }
        modules.prepare();
        modules
    };
    let turn = |modules: &mut Modules<f64>, number, deadline| {
        modules.turn(1.0, number, Nanos(number * PERIOD), deadline);
        modules.settle();
        modules.prepare();
        (hash(modules), modules.arrivals().clone())
    };
    let mut live = make(Modules::new(workers(2), Service::WhenReady).unwrap());
    let deadline = || Some(Instant::now() + Duration::from_millis(3));
    let (boards, arrivals): (Vec<_>, Vec<_>) = (0..300).map(|number| turn(&mut live, number, deadline())).unzip();
    let late = arrivals.iter().filter(|arrivals| arrivals.late.iter().any(|name| &**name == "dawdler")).count();
    assert!(late >= 1, "no module was late");
    let mut replay = make(Modules::replaying(Threads::Sequential, arrivals).unwrap());
    let replayed: Vec<_> = (0..300).map(|number| turn(&mut replay, number, None).0).collect();
    assert_same(&boards, &replayed, "replayed");
    assert!(replay.names().all(|(_, standing)| standing != ModuleState::Failed));
}
