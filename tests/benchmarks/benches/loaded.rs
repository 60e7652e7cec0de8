//! Compares `mdle run`, which loads a plan, with the plan's executable: the duration of runs at maximum speed in the
//! simulator, and the number of instructions, counted by Callgrind. Also measures the time from a text to its first
//! turn. Both programs are built with `--release`, which takes minutes the first time.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs};

use mdle_tests::executable::target;
use mdle_tests::repository::root;

/// A plan whose runs are compared.
struct Workload {
    name: &'static str,
    text: &'static str,
    /// Name of the world. `timed` is the time limit of a run whose duration is measured, and `counted` is that of a run
    /// whose instructions are counted.
    world: &'static str,
    timed: &'static str,
    counted: &'static str,
}

/// The plans. Two of them run until the time limit.
const WORKLOADS: [Workload; 3] = [
    Workload {
        name: "one law",
        text: "{ Round (wait 9h) (Atom (null) (goAvoid 90 40 20)) }\n",
        world: "hall",
        timed: "3600s",
        counted: "300s",
    },
    Workload {
        name: "a transition each second",
        text: "{ Waver (wait 9h)\n  { Both (null) (Atom (wait 1s OR r0 < 20cm) (go 10 0.3)) (Atom (wait 1s) (go 10 -0.3)) }^10000\n}\n",
        world: "hall",
        timed: "3600s",
        counted: "300s",
    },
    Workload {
        name: "the lab tour",
        text: include_str!("../../../plans/lab_tour.mdle"),
        world: "office",
        timed: "1h",
        counted: "1h",
    },
];
/// Maximum number of timed runs of each program; the fastest run counts.
const RUNS: usize = 7;
/// Minimum number of timed runs of each program, however long they take.
const FEWEST: usize = 3;
/// Time after which no further run of a plan is started.
const LONGEST: Duration = Duration::from_secs(20);

fn main() {
    let [mdle, mdlec] = ["mdle", "mdlec"].map(built);
    println!("{:<44}{:>12}{:>12}{:>8}", "", "executable", "mdle run", "ratio");
    let [plan, executable] = ["loaded-benchmark.mdle", "loaded-benchmark"].map(|file| target().join(file));
    for Workload { name, text, world, timed, counted } in WORKLOADS {
        fs::write(&plan, text).expect("a folder to write to");
        let mut build = Command::new(&mdlec);
        build.arg(&plan).args(["--target", "sim", "-o"]).arg(&executable).current_dir(root());
        assert!(build.status().expect("mdlec runs").success(), "{name}: no executable");
        let options = ["--world", world, "--seed", "1", "--speed", "max", "--timeout"];
        let emitted = vec![executable.clone()];
        let loaded = vec![mdle.clone(), "run".into(), plan.clone(), "--target".into(), "sim".into()];
        let programs = [emitted, loaded].map(|mut words: Vec<PathBuf>| {
            words.extend(options.map(PathBuf::from));
            words
        });
        let [quick, slow] = seconds(&programs, timed);
        println!("{:<44}{quick:>12.3}{slow:>12.3}{:>8.2}", format!("{name}, {timed}: seconds"), slow / quick);
        let [few, many] = [0, 1].map(|program| instructions(&programs[program], counted));
        println!("{:<44}{few:>12.1}{many:>12.1}{:>8.3}", format!("{name}, {counted}: 10^6 instructions"), many / few);
    }
    for atoms in [1, 10_000] {
        fs::write(&plan, long(atoms)).expect("a folder to write to");
        let words = [mdle.clone(), "run".into(), plan.clone(), "--target".into(), "sim".into()];
        let words: Vec<_> =
            words.into_iter().chain(["--speed", "max", "--turns", "1", "--timeout"].map(Into::into)).collect();
        let times = (0..RUNS).map(|_| run(&words, "1h")).min().expect("runs");
        println!("{:<44}{:>24.1}", format!("text to first turn, {atoms} atoms: ms"), times.as_secs_f64() * 1e3);
    }
}

/// Returns the text of a plan of `atoms` atoms.
fn long(atoms: usize) -> String {
    let mut text = String::from("{ Long (bumper)\n");
    for atom in 0..atoms {
        writeln!(text, "  (Atom (wait {}s AND NOT (x > 1000m)) (go 30 0))", 1000 + atom).expect("a text");
    }
    text + "}\n"
}

/// Builds a binary of the workspace, shows cargo's output, and returns the path of the binary.
fn built(binary: &str) -> PathBuf {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--release", "--workspace", "--bin", binary, "--target-dir"]).arg(target());
    assert!(build.current_dir(root()).status().expect("cargo runs").success(), "{binary} does not build");
    Path::new(&target()).join("release").join(binary)
}

/// Runs two programs alternately, each with the time limit `timeout`. Returns the duration of each program's fastest
/// run, in seconds.
fn seconds(programs: &[Vec<PathBuf>], timeout: &str) -> [f64; 2] {
    let mut times = [Duration::MAX; 2];
    let begun = Instant::now();
    for number in 0..RUNS {
        if number >= FEWEST && begun.elapsed() >= LONGEST {
            break;
        }
        for (time, words) in times.iter_mut().zip(programs) {
            *time = run(words, timeout).min(*time);
        }
    }
    times.map(|time| time.as_secs_f64())
}

/// Runs a program with the time limit `timeout`, and returns the duration of the run.
fn run(words: &[PathBuf], timeout: &str) -> Duration {
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).arg(timeout);
    let begun = Instant::now();
    ended(command);
    begun.elapsed()
}

/// Runs a program under Callgrind with the time limit `timeout`, and returns the number of instructions, in millions.
fn instructions(words: &[PathBuf], timeout: &str) -> f64 {
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).args(words).arg(timeout);
    let report = ended(command);
    let collected = report.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse::<f64>().ok());
    collected.unwrap_or_else(|| panic!("{report}")) / 1e6
}

/// Runs a command to its end, and returns its messages. Panics if the run fails.
fn ended(mut command: Command) -> String {
    let output = command.stdout(Stdio::null()).stderr(Stdio::piped()).current_dir(root()).output().expect("a run");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    // The run ends when the plan is over or at its time limit.
    assert!(matches!(output.status.code(), Some(0 | TIMED_OUT)), "{:?}: {errors}", output.status);
    errors
}

/// Exit status of a run that ends at its time limit.
const TIMED_OUT: i32 = 4;
