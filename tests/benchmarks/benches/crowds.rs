//! Measures crowds of Scouts whose sonars ping one after another and whose plan drives by `goAvoid` or by `go`. Prints
//! the processor time per robot and simulated second, the speed relative to real time, the peak memory and, for
//! comparison, the processor time of the sonar rays alone. Also checks that the results do not depend on the number of
//! threads.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use mdle_sim::{Point, Walls, World};
use mdle_tests::executable::target;
use mdle_tests::repository::root;

/// Numbers of robots, each with the duration of the run in simulated seconds.
const CROWDS: [(u32, u32); 5] = [(1, 8_000), (10, 1_600), (100, 200), (1_000, 40), (10_000, 10)];
/// Numbers of threads; runs with each of them must have equal results.
const THREADS: [u32; 3] = [1, 2, 4];
/// Number of robots and duration, in simulated seconds, of the runs that must have equal results.
const COMPARED: (u32, u32) = (1_000, 5);
/// Number of rays of a Scout per second: seven for each ping, and one ping every 60 ms.
const RAYS: f64 = 7.0 / 0.06;
/// Maximum range of a Scout's sonars, in metres.
const REACH: f64 = 6.477;
/// Distance between two robots at the start, in metres.
const SPACING: f64 = 2.0;
/// Exit status of a run that ends at its time limit.
const TIMED_OUT: i32 = 4;

fn main() {
    let mdle = built();
    compare(&mdle);
    println!(
        "{:<12}{:>8}{:>14}{:>12}{:>18}{:>10}",
        "law", "robots", "rays alone", "crowd", "times real time", "memory"
    );
    for (law, name) in [("goAvoid 0 40 20", "goAvoid"), ("go 20 0", "go")] {
        for (robots, seconds) in CROWDS {
            let Run { processor, wall, memory } = run(&mdle, law, robots, seconds);
            let each = f64::from(robots) * f64::from(seconds);
            println!(
                "{name:<12}{robots:>8}{:>11.1} us{:>9.1} us{:>18.2}{:>7.0} MB",
                rays(robots) * 1e6,
                processor / each * 1e6,
                f64::from(seconds) / wall,
                memory
            );
        }
    }
}

/// Builds `mdle`, and returns its path.
fn built() -> PathBuf {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--release", "-p", "mdle", "--bin", "mdle", "--target-dir"]).arg(target());
    assert!(build.current_dir(root()).status().expect("cargo runs").success(), "mdle does not build");
    Path::new(&target()).join("release/mdle")
}

/// Asserts that the trail of a crowd does not depend on the number of threads.
fn compare(mdle: &Path) {
    let (robots, seconds) = COMPARED;
    write("goAvoid 0 40 20", robots);
    let trails = THREADS.map(|threads| {
        let name = format!("crowd-benchmark-{threads}.csv");
        let mut command = command(mdle, seconds);
        command.args(["--threads", &threads.to_string(), "--trail", &name]);
        let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("mdle runs");
        assert_eq!(status.code(), Some(TIMED_OUT), "{threads} threads");
        fs::read(target().join(name)).expect("a table of poses")
    });
    assert!(trails.iter().all(|trail| *trail == trails[0]), "the ways depend on the number of threads");
    println!("{robots} robots: the same {} bytes with {THREADS:?} threads", trails[0].len());
}

/// Measurements of a run.
struct Run {
    /// Processor time of all cores together, in seconds.
    processor: f64,
    /// Wall-clock time in seconds.
    wall: f64,
    /// Peak memory, in megabytes.
    memory: f64,
}

/// Writes a crowd of `robots` robots whose plan drives by the law `law`.
fn write(law: &str, robots: u32) {
    let folder = target();
    let plan = format!(
        "{{ Wander (wait 9h)\n  ExecPlan inf {{\n    (Atom (wait 20 OR bumper) ({law}))\n    (Atom (wait 1) (go -20 0))\n    \
         (Atom (wait 9) (turn 100))\n  }}\n}}\n"
    );
    let crowd = format!("seed = 1\n[crowd]\nrobots = {robots}\nfile = \"crowd-benchmark.mdle\"\nbody = \"scout\"\n");
    fs::write(folder.join("crowd-benchmark.mdle"), plan).expect("a folder to write to");
    fs::write(folder.join("crowd-benchmark.toml"), crowd).expect("a folder to write to");
}

/// Returns the command that runs the crowd for `seconds` simulated seconds.
fn command(mdle: &Path, seconds: u32) -> Command {
    let mut command = Command::new(mdle);
    command.args(["run", "crowd-benchmark.toml", "--timeout", &seconds.to_string()]).current_dir(target());
    command
}

/// Runs a crowd of `robots` robots with the law `law` for `seconds` simulated seconds.
fn run(mdle: &Path, law: &str, robots: u32, seconds: u32) -> Run {
    write(law, robots);
    let mut command = command(mdle, seconds);
    let begun = Instant::now();
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("mdle runs");
    let (mut processor, mut memory) = (0.0, 0.0);
    let status = loop {
        (processor, memory) = (seconds_of(child.id()).unwrap_or(processor), memory_of(child.id()).unwrap_or(memory));
        match child.try_wait().expect("a child") {
            Some(status) => break status,
            None => thread::sleep(Duration::from_millis(5)),
        }
    };
    assert_eq!(status.code(), Some(TIMED_OUT), "{robots} robots");
    Run { processor, wall: begun.elapsed().as_secs_f64(), memory }
}

/// Returns the processor time of a process in seconds, or `None` if the process has ended.
fn seconds_of(process: u32) -> Option<f64> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let (_, fields) = stat.rsplit_once(") ")?;
    let ticks = |number: usize| fields.split(' ').nth(number)?.parse::<f64>().ok();
    // User time and system time of the process, in hundredths of a second.
    Some((ticks(11)? + ticks(12)?) / 100.0).filter(|seconds| *seconds > 0.0)
}

/// Returns the peak memory of a process in megabytes, or `None` if the process has ended.
fn memory_of(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().split(' ').next()?.parse::<f64>().ok()? / 1000.0)
}

/// Returns the processor time, in seconds, that casting all rays of a robot takes per simulated second. The rays are
/// cast in an empty hall with the size for `robots` robots.
fn rays(robots: u32) -> f64 {
    let rows = f64::from(robots).sqrt().ceil();
    let side = rows * SPACING;
    let hall = format!("[[wall]]\npoints = [[0, 0], [{side}, 0], [{side}, {side}], [0, {side}], [0, 0]]\n");
    let walls = Walls::of(&World::parse("hall", &hall).expect("a good world"));
    let own = std::process::id();
    let begun = seconds_of(own).unwrap_or_default();
    let (mut number, mut heard) = (0_u64, 0.0);
    // A second is long enough for a clock with a resolution of a hundredth of a second.
    while seconds_of(own).unwrap_or_default() - begun < 1.0 {
        for _ in 0..100_000 {
            let robot = (number % u64::from(robots)) as f64;
            let from = Point { x: SPACING * (0.5 + robot % rows), y: SPACING * (0.5 + (robot / rows).floor()) };
            let (sin, cos) = libm::sincos(number as f64);
            heard += walls.cast(from, Point { x: cos, y: sin }, black_box(REACH)).unwrap_or_default();
            number += 1;
        }
    }
    black_box(heard);
    RAYS * (seconds_of(own).unwrap_or_default() - begun) / number as f64
}
