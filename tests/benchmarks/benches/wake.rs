//! Measures the lateness of turns on a real clock, with a bare loop of `clock_nanosleep` with the same privileges as
//! the baseline.
//!
//! Both run in separate processes of this program, with their role in an environment variable. The processes alternate,
//! and the results cover all rounds.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

mod stopwatch;

use std::env;
use std::process::{Command, Stdio};
use std::time::Duration;

use stopwatch::{Rest, Stopwatch, bare, late};

const PERIOD: Duration = Duration::from_millis(10);
/// Number of turns of a round.
const TURNS: usize = 500;
/// Number of rounds of each process.
const ROUNDS: usize = 6;
/// Environment variable with the role of a process: turns or bare loop.
const ROLE: &str = "MDLE_WAKE_ROLE";

fn main() {
    match env::var(ROLE).as_deref() {
        Ok("bare") => bare(PERIOD, TURNS),
        Ok(_) => {
            mdle_host::run::<Stopwatch, _>("rest", || Rest);
        }
        Err(_) => compare(),
    }
}

/// Runs both processes alternately, and prints the lateness of their turns.
fn compare() {
    let (mut turns, mut bare) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        turns.extend(lateness("turns"));
        bare.extend(lateness("bare"));
    }
    println!("{:<12}{:>10}{:>10}{:>10}", "wake, µs", "p50", "p99", "most");
    let [turns, bare] = [turns, bare].map(|mut nanos| {
        nanos.sort_unstable();
        [nanos.len() / 2, nanos.len() * 99 / 100, nanos.len() - 1].map(|place| nanos[place] as f64 / 1e3)
    });
    for (name, [p50, p99, most]) in [("turns", turns), ("bare loop", bare)] {
        println!("{name:<12}{p50:>10.1}{p99:>10.1}{most:>10.1}");
    }
    let [p50, p99, most] = [0, 1, 2].map(|place| turns[place] / bare[place]);
    println!("{:<12}{p50:>10.2}{p99:>10.2}{most:>10.2}", "ratio");
}

/// Returns the lateness of each turn of a round, in nanoseconds.
fn lateness(role: &str) -> Vec<i64> {
    let program = env::current_exe().expect("this program");
    let arguments = ["--period", &PERIOD.as_secs_f64().to_string(), "--turns", &TURNS.to_string()];
    let output = Command::new(program).env(ROLE, role).args(arguments).stderr(Stdio::null()).output().expect("a run");
    let begins = String::from_utf8(output.stdout).expect("numbers");
    let begins: Vec<i64> = begins.lines().filter_map(|line| line.strip_prefix("begun ")?.parse().ok()).collect();
    assert_eq!(begins.len(), TURNS, "{role}");
    let first = begins.first().copied().unwrap_or_default();
    // After a skipped turn, the following turns belong to later deadlines and are not late.
    begins.iter().skip(1).map(|begun| late(begun - first, PERIOD)).collect()
}
