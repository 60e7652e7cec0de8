//! Lateness of turns on a real clock, beside a bare loop of `clock_nanosleep` with the same privileges.
//!
//! Both are processes of their own, this program with a role, and take turns; the figures are of all rounds together.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::convert::Infallible;
use std::env;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mdle_host::clap::ArgMatches;
use mdle_host::{Refusal, StopRequest, Target};
use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Begin, Cursor, Ending, Fsm, Nanos, Output, Plan, Robot};
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

const PERIOD: Duration = Duration::from_millis(10);
/// Number of turns of a round.
const TURNS: usize = 500;
/// Number of rounds of each process.
const ROUNDS: usize = 6;
/// Environment variable with the role of a process: turns or bare loop.
const ROLE: &str = "MDLE_WAKE_ROLE";

fn main() {
    match env::var(ROLE).as_deref() {
        Ok("bare") => bare(),
        Ok(_) => {
            mdle_host::run::<Stopwatch, _>("rest", || Rest);
        }
        Err(_) => compare(),
    }
}

/// Runs both in turns, and prints their latenesses.
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
    // A turn that is skipped makes those behind it turns of later deadlines, and not late.
    begins.iter().skip(1).map(|begun| late(begun - first)).collect()
}

/// Returns the lateness of a turn that begins `nanos` nanoseconds after the first, relative to the nearest deadline
/// before it; negative for a turn that is up to a tenth of a period early.
fn late(nanos: i64) -> i64 {
    let period = PERIOD.as_nanos() as i64;
    (nanos + period / 10).rem_euclid(period) - period / 10
}

fn tell(begins: &[Duration]) {
    begins.iter().for_each(|begun| println!("begun {}", begun.as_nanos()));
}

/// The floor: nothing but sleep.
fn bare() {
    let realtime = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::try_from(50).expect("a priority");
    // As for a plan, what is not permitted is done without.
    let _ = set_thread_priority_and_policy(thread_native_id(), priority, realtime);
    let _ = mlockall(MlockAllFlags::CURRENT);
    let mut begins = Vec::with_capacity(TURNS);
    let origin = Instant::now();
    let mut deadline = clock_gettime(ClockId::Monotonic);
    for _ in 0..TURNS {
        begins.push(origin.elapsed());
        let nanos = deadline.tv_nsec + PERIOD.as_nanos() as i64;
        deadline = Timespec { tv_sec: deadline.tv_sec + nanos / 1_000_000_000, tv_nsec: nanos % 1_000_000_000 };
        clock_nanosleep_absolute(ClockId::Monotonic, &deadline).expect("sleep");
    }
    tell(&begins);
}

/// A robot that notes when it is asked for its output.
struct Stopwatch {
    origin: Instant,
    begins: Vec<Duration>,
}

struct Nothing;

impl Output for Nothing {}

impl Robot for Stopwatch {
    type Output = Nothing;
    type Input = ();
    type Error = Infallible;

    fn exchange(&mut self, (): &()) -> Result<Nothing, Infallible> {
        self.begins.push(self.origin.elapsed());
        Ok(Nothing)
    }

    fn stop(&mut self) -> Result<(), Infallible> {
        // One more exchange sends the null input.
        self.begins.truncate(TURNS);
        tell(&self.begins);
        Ok(())
    }
}

impl Target for Stopwatch {
    const NAME: &'static str = "stopwatch";
    const PERIOD: Duration = PERIOD;
    type Robot = Self;

    fn connect(_: &ArgMatches, _: Duration, _: &StopRequest) -> Result<Self, Refusal> {
        Ok(Self { origin: Instant::now(), begins: Vec::with_capacity(TURNS + 1) })
    }
}

/// `{ Rest (Atom (null) stop) }`.
struct Rest;

impl Plan for Rest {
    type Output = Nothing;
    type Input = ();
    type Entered = [Nanos; 2];
    type Left = [u64; 0];

    fn fsm(&self) -> Fsm<'_> {
        const FSM: Fsm<'static> = Fsm {
            brackets: &[Bracket::scope(0, 0, 0, 0), Bracket::scope(1, 0, 0, 0)],
            atoms: &[Atom::new(1, 1)],
            termination: 2,
        };
        FSM
    }

    fn slots(&self) -> ([Nanos; 2], [u64; 0]) {
        ([Nanos::ZERO; 2], [])
    }

    fn enter(&mut self, _: u32, _: &Nothing, _: Begin) {}

    fn next(&self, _: &Cursor<[Nanos; 2], [u64; 0]>, _: &Nothing, _: Nanos) -> Option<Ending> {
        None
    }

    fn input(&mut self, _: &Nothing, _: Nanos) {}

    fn law(&self, _: u32) -> &str {
        "stop"
    }

    fn condition(&self, _: u32) -> &str {
        "null"
    }

    fn name(&self, _: u32) -> &str {
        ""
    }
}
