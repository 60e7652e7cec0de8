//! Measures the turns of eight modules at 1 kHz on two workers, each busy for 2, 10 or 50 µs: lateness, missed turns,
//! the duration of a turn, and the duration of a turn break. The baseline is a bare loop of `clock_nanosleep` with the
//! same privileges.
//!
//! Each measurement runs in a separate process of this program, with its role in an environment variable. The processes
//! alternate, and the results cover all rounds.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

mod stopwatch;

use std::env;
use std::hint::spin_loop;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mdle_engine::{Candidate, Declare, Fault, In, Module, Modules, Out, Service, Threads};
use mdle_host::{
    Call, Pilot, PilotFault, PilotTurn, RecordedPlan, Refusal, RunTerms, Transitions, claim_for_worker, run_piloted,
};
use mdle_runtime::{Machine, Turn};
use stopwatch::{Nothing, Rest, Stopwatch, bare, late};

const PERIOD: Duration = Duration::from_millis(1);
/// Number of turns of a round.
const TURNS: usize = 5000;
/// Number of rounds of each process.
const ROUNDS: usize = 4;
/// Number of modules.
const MODULES: usize = 8;
/// Work of each module in a turn, in microseconds. Each value is measured separately.
const WORK: [u64; 3] = [2, 10, 50];
/// Environment variable with the role of a process: the work of its modules in microseconds, or `bare`.
const ROLE: &str = "MDLE_MODULES_ROLE";

fn main() {
    match env::var(ROLE).as_deref() {
        Ok("bare") => bare(PERIOD, TURNS),
        Ok(work) => turns(Duration::from_micros(work.parse().expect("microseconds"))),
        Err(_) => compare(),
    }
}

/// Runs the processes of all roles alternately, and prints their results.
fn compare() {
    println!(
        "{:<12}{:>12}{:>8}{:>8}{:>8}{:>12}{:>8}{:>12}{:>8}",
        "µs", "late p50", "p99", "most", "missed", "turn p50", "p99", "break p50", "p99"
    );
    let roles = ["bare".to_owned()].into_iter().chain(WORK.map(|work| work.to_string()));
    let mut rounds: Vec<_> = roles.map(|role| (role, Round::default())).collect();
    for _ in 0..ROUNDS {
        rounds.iter_mut().for_each(|(role, round)| round.add(role));
    }
    let (mut floor, mut floor_missed) = ([0.0; 3], 0.0);
    for (role, round) in &mut rounds {
        let [late, turn, pause] = [&mut round.late, &mut round.turns, &mut round.breaks].map(|nanos| quantiles(nanos));
        let name = if role == "bare" { "bare loop".to_owned() } else { format!("{MODULES} x {role} µs") };
        println!(
            "{name:<12}{:>12.1}{:>8.1}{:>8.1}{:>8}{:>12.1}{:>8.1}{:>12.2}{:>8.2}",
            late[0], late[1], late[2], round.missed, turn[0], turn[1], pause[0], pause[1]
        );
        if role == "bare" {
            (floor, floor_missed) = (late, round.missed as f64);
        } else {
            let ratio = [0, 1, 2].map(|place| late[place] / floor[place]);
            let times = round.missed as f64 / f64::max(floor_missed, 1.0);
            println!("{:<12}{:>12.2}{:>8.2}{:>8.2}{times:>8.2}", "  ratio", ratio[0], ratio[1], ratio[2]);
        }
    }
}

/// Measurements of a role in nanoseconds, except `missed`, the number of missed turns.
#[derive(Default)]
struct Round {
    late: Vec<i64>,
    turns: Vec<i64>,
    breaks: Vec<i64>,
    missed: i64,
}

impl Round {
    /// Runs a round of a role, and adds its measurements.
    fn add(&mut self, role: &str) {
        let program = env::current_exe().expect("this program");
        let arguments = ["--period", &PERIOD.as_secs_f64().to_string(), "--turns", &TURNS.to_string()];
        let output =
            Command::new(program).env(ROLE, role).args(arguments).stderr(Stdio::null()).output().expect("a run");
        let text = String::from_utf8(output.stdout).expect("numbers");
        let numbers = |word: &str| -> Vec<i64> {
            let lines = text.lines().filter_map(|line| line.strip_prefix(word)?.strip_prefix(' ')?.parse().ok());
            lines.collect()
        };
        let begins = numbers("begun");
        assert_eq!(begins.len(), TURNS, "{role}");
        let period = PERIOD.as_nanos() as i64;
        self.late.extend(begins.iter().skip(1).map(|begun| late(begun - begins[0], PERIOD)));
        // The bare loop may begin several turns in one period to catch up.
        let mut periods: Vec<_> = begins.iter().map(|begun| (begun - begins[0] + period / 10) / period).collect();
        periods.dedup();
        self.missed += periods[periods.len() - 1] + 1 - periods.len() as i64;
        self.turns.extend(numbers("turn"));
        self.breaks.extend(numbers("break"));
    }
}

/// Returns the median, the 99th percentile and the maximum, in microseconds, or zeros if there are no measurements.
fn quantiles(nanos: &mut [i64]) -> [f64; 3] {
    nanos.sort_unstable();
    let at = |place: usize| nanos.get(place).map_or(0.0, |nanos| *nanos as f64 / 1e3);
    [at(nanos.len() / 2), at(nanos.len() * 99 / 100), at(nanos.len().saturating_sub(1))]
}

/// Runs the turns of modules, each of which is busy for the duration `work`.
fn turns(work: Duration) {
    let pilot = |_: &RunTerms| -> Result<Eight, Refusal> {
        let mut modules = Modules::new(Threads::Workers(2, claim_for_worker), Service::WhenReady).expect("threads");
        for number in 0..MODULES {
            let make = |declare: &mut Declare| Busy {
                read: declare.reads(&format!("m{}", (number + 1) % MODULES), "out"),
                out: declare.publishes("out"),
                work,
            };
            modules.load(Candidate::registered(&format!("m{number}"), make).expect("a module")).expect("loaded");
        }
        modules.prepare();
        Ok(Eight { modules, turns: Vec::with_capacity(TURNS), breaks: Vec::with_capacity(TURNS) })
    };
    let words = env::args_os().take(1).collect();
    let options = env::args_os().skip(1).collect();
    let call = Call {
        words,
        options,
        read: Vec::new(),
        recorded: RecordedPlan::default(),
        later_path: None,
        own_options: Vec::new(),
    };
    run_piloted::<Stopwatch, _>("rest", call, &|| Rest, pilot, None);
}

/// A module that reads the attribute of another module, and is busy for a certain time.
struct Busy {
    read: In<f64>,
    out: Out<f64>,
    work: Duration,
}

impl Module<Nothing> for Busy {
    fn turn(&mut self, turn: &mut mdle_engine::Turn<'_, Nothing>) -> Result<(), Fault> {
        let begun = Instant::now();
        let read = turn.get(self.read).unwrap_or_default();
        while begun.elapsed() < self.work {
            spin_loop();
        }
        turn.publish(self.out, read + 1.0);
        Ok(())
    }
}

/// Pilot of a run that executes eight modules and records the durations of their turns and turn breaks, in nanoseconds.
struct Eight {
    modules: Modules<Nothing>,
    turns: Vec<u128>,
    breaks: Vec<u128>,
}

impl Pilot for Eight {
    type Plan = Rest;

    fn turn(
        &mut self,
        PilotTurn { t, number, .. }: PilotTurn<'_, Nothing>,
        _: &mut Transitions,
    ) -> Result<Turn<()>, PilotFault> {
        let begun = Instant::now();
        self.modules.turn(Nothing, number, t, Some(begun + PERIOD));
        let turned = Instant::now();
        self.modules.settle();
        self.modules.prepare();
        self.turns.push(begun.elapsed().as_nanos());
        self.breaks.push(turned.elapsed().as_nanos());
        Ok(Turn::Law(()))
    }

    fn divert(&mut self, _: Rest, _: PilotTurn<'_, Nothing>) {}

    fn plan_number(&self) -> u64 {
        1
    }

    fn machine(&self) -> Option<&Machine<Rest>> {
        None
    }
}

impl Drop for Eight {
    fn drop(&mut self) {
        self.turns.iter().for_each(|nanos| println!("turn {nanos}"));
        self.breaks.iter().for_each(|nanos| println!("break {nanos}"));
    }
}
