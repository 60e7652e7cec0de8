//! A simulated robot as fast as possible: turns a second of `mdle run`, which loads a plan, beside the plan's
//! executable. Both are built with `--release`, which takes minutes the first time.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs};

use mdle_tests::executable::target;
use mdle_tests::repository::root;

/// Plans that go on until a time is over: their names, and texts.
const PLANS: [(&str, &str); 2] = [
    ("one law", "{ Round (wait 9h) (Atom (null) (goAvoid 90 40 20)) }\n"),
    (
        "a transition each second",
        "{ Waver (wait 9h)\n  { Both (null) (Atom (wait 1s OR r0 < 20cm) (go 10 0.3)) (Atom (wait 1s) (go 10 -0.3)) }^10000\n}\n",
    ),
];
/// Simulated time of a run, in seconds.
const TIME: u32 = 3600;
/// Turns in a simulated second.
const RATE: f64 = 10.0;
/// Maximum number of runs of each; the median counts.
const RUNS: usize = 7;
/// Minimum number of runs of each, however long they take.
const FEWEST: usize = 3;
/// Time after which no further runs of a plan begin.
const LONGEST: Duration = Duration::from_secs(20);

fn main() {
    let [mdle, mdlec] = ["mdle", "mdlec"].map(built);
    println!("{:<28}{:>20}{:>16}{:>8}", "turns a second", "executable", "mdle run", "ratio");
    let [plan, executable] = ["loaded-benchmark.mdle", "loaded-benchmark"].map(|file| target().join(file));
    for (name, text) in PLANS {
        fs::write(&plan, text).expect("a folder to write to");
        let mut build = Command::new(&mdlec);
        build.arg(&plan).args(["--target", "sim", "-o"]).arg(&executable).current_dir(root());
        assert!(build.status().expect("mdlec runs").success(), "{name}: no executable");
        let emitted = || Command::new(&executable);
        let loaded = || {
            let mut command = Command::new(&mdle);
            command.arg("run").arg(&plan).args(["--target", "sim"]);
            command
        };
        let (mut slow, mut quick) = (Vec::new(), Vec::new());
        let begun = Instant::now();
        while slow.len() < FEWEST || slow.len() < RUNS && begun.elapsed() < LONGEST {
            quick.push(speed(emitted()));
            slow.push(speed(loaded()));
        }
        let [quick, slow] = [quick, slow].map(median);
        println!("{name:<28}{quick:>20.0}{slow:>16.0}{:>8.2}", slow / quick);
    }
}

/// Builds a binary of the workspace, with cargo's own reports; returns its path.
fn built(binary: &str) -> PathBuf {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--release", "--workspace", "--bin", binary, "--target-dir"]).arg(target());
    assert!(build.current_dir(root()).status().expect("cargo runs").success(), "{binary} does not build");
    Path::new(&target()).join("release").join(binary)
}

/// Runs a plan; returns the number of its turns in a second.
fn speed(mut command: Command) -> f64 {
    command.args(["--world", "hall", "--seed", "1", "--speed", "max", "--timeout", &TIME.to_string()]);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).current_dir(root());
    let begun = Instant::now();
    let output = command.output().expect("a run");
    let seconds = begun.elapsed().as_secs_f64();
    // The time is over before the plan.
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(TIMED_OUT), "{:?}: {errors}", output.status);
    f64::from(TIME) * RATE / seconds
}

/// Exit status of a run whose time is over.
const TIMED_OUT: i32 = 4;

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or_default()
}
