//! A robot that records when its turns begin, and a bare loop of `clock_nanosleep` with the same privileges as the
//! baseline.

use std::convert::Infallible;
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

/// Returns the lateness, relative to the latest deadline, of a turn that begins `nanos` nanoseconds after the first;
/// negative for a turn that begins up to a tenth of a period before a deadline.
pub(crate) fn late(nanos: i64, period: Duration) -> i64 {
    let period = period.as_nanos() as i64;
    (nanos + period / 10).rem_euclid(period) - period / 10
}

fn tell(begins: &[Duration]) {
    begins.iter().for_each(|begun| println!("begun {}", begun.as_nanos()));
}

/// Runs the bare loop, which only sleeps, for `turns` periods, and prints when each period begins.
pub(crate) fn bare(period: Duration, turns: usize) {
    let realtime = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::try_from(50).expect("a priority");
    // As for a plan, missing permissions are not an error.
    let _ = set_thread_priority_and_policy(thread_native_id(), priority, realtime);
    let _ = mlockall(MlockAllFlags::CURRENT);
    let mut begins = Vec::with_capacity(turns);
    let origin = Instant::now();
    let mut deadline = clock_gettime(ClockId::Monotonic);
    for _ in 0..turns {
        begins.push(origin.elapsed());
        let nanos = deadline.tv_nsec + period.as_nanos() as i64;
        deadline = Timespec { tv_sec: deadline.tv_sec + nanos / 1_000_000_000, tv_nsec: nanos % 1_000_000_000 };
        clock_nanosleep_absolute(ClockId::Monotonic, &deadline).expect("sleep");
    }
    tell(&begins);
}

/// Maximum number of turns of a round.
const MOST: usize = 100_000;

/// A robot that records the times of its exchanges.
pub(crate) struct Stopwatch {
    origin: Instant,
    begins: Vec<Duration>,
}

pub(crate) struct Nothing;

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
        // The last exchange, which sends the null input, is not a turn.
        self.begins.pop();
        tell(&self.begins);
        Ok(())
    }
}

impl Target for Stopwatch {
    const NAME: &'static str = "stopwatch";
    const PERIOD: Duration = Duration::from_millis(10);
    type Robot = Self;

    fn connect(_: &ArgMatches, _: Duration, _: &StopRequest) -> Result<Self, Refusal> {
        Ok(Self { origin: Instant::now(), begins: Vec::with_capacity(MOST) })
    }
}

/// The plan `{ Rest (Atom (null) stop) }`.
pub(crate) struct Rest;

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
