//! Tests of modules, turns and turn breaks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod determinism;
mod faults;
mod graph;
mod order;

use mdle_runtime::Nanos;

use crate::{Modules, Reading, Service, Threads, Value};

/// Period of a turn, in nanoseconds.
const PERIOD: u64 = 1_000_000;

/// Returns workers with normal priority.
const fn workers(count: usize) -> Threads {
    Threads::Workers(count, || ())
}

/// Returns modules that make their turns one after the other, in stepped time.
fn sequential() -> Modules<f64> {
    Modules::new(Threads::Sequential, Service::WhenDue).unwrap()
}

/// Makes a turn without a deadline, and the turn break after it.
fn turn(modules: &mut Modules<f64>, number: u64) {
    modules.turn(0.5 * number as f64, number, Nanos(number * PERIOD), None);
    modules.settle();
    modules.prepare();
}

/// Returns the value of an attribute, and the number of the turn in which it was published.
fn number(modules: &Modules<f64>, module: &str, attribute: &str) -> Option<(f64, u64)> {
    let Reading { value, at } = modules.board().post(module, attribute)?.reading.as_ref()?;
    let Value::Number(number) = value else { panic!("{value:?}") };
    Some((*number, at.0 / PERIOD))
}
