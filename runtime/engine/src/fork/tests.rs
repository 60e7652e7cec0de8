//! Tests of the rounds that are reused.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::Arc;
use std::thread;

use mdle_runtime::Nanos;

use super::{Fork, Round, Threads};

/// Makes a turn without modules, and returns its round, which a worker might still use afterwards.
fn turn(fork: &mut Fork<()>, number: u64) -> Arc<Round<()>> {
    fork.turn((), number, Nanos::ZERO, std::iter::empty(), None);
    Arc::clone(fork.rounds.last().unwrap())
}

/// Keeps a worker from using any round, so that only the test does.
fn sleep() {
    loop {
        thread::park();
    }
}

#[test]
fn a_turn_finds_a_free_round_while_each_worker_uses_an_earlier_one() {
    for workers in 1..4 {
        let mut fork = Fork::new(Threads::Workers(workers, sleep)).unwrap();
        let made = fork.rounds.len();
        let used: Vec<_> = (0..workers as u64).map(|number| turn(&mut fork, number)).collect();
        for number in 10..100 {
            drop(turn(&mut fork, number));
            assert_eq!(fork.rounds.len(), made, "{workers} workers, {} rounds in use", used.len());
        }
    }
}
