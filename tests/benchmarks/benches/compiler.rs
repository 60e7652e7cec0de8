//! Measures the time and the peak memory of `mdlec`, as a process, for long plans.
//!
//! The fastest run counts. User time is measured by the system, in steps of 10 ms.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use std::env;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Number of times that each plan is compiled.
const RUNS: usize = 5;
/// Time between two measurements of the memory.
const LOOK: Duration = Duration::from_millis(2);

/// Cost of a run.
struct Cost {
    wall: Duration,
    /// Processor time in user mode, in seconds.
    user: f64,
    /// Peak memory of the process, in kB.
    memory: u64,
}

fn main() {
    let folder = env::temp_dir().join(format!("mdle-compiler-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder to write to");
    let mdlec = mdlec();
    println!("{:<48}{:>8}{:>8}{:>12}", "", "wall, s", "user, s", "memory, MB");
    let show = |what: &str, plan: &str, arguments: &[&str]| {
        let file = folder.join("plan.mdle");
        fs::write(&file, plan).expect("a folder to write to");
        let runs = (0..RUNS).map(|_| run(&mdlec, &file, arguments));
        let best = runs.min_by_key(|cost| cost.wall).expect("more than no runs");
        let megabytes = best.memory / 1000;
        println!("{what:<48}{:>8.2}{:>8.2}{megabytes:>12}", best.wall.as_secs_f64(), best.user);
    };
    let rust = ["--target", "sim", "--emit", "rust"];
    show("check, 10 MB of small plans", &small_plans(10_000_000), &["check"]);
    show("Rust of 10,000 atoms, one condition", &written_out(10_000, false), &rust);
    show("Rust of 10,000 atoms, each its own condition", &written_out(10_000, true), &rust);
    show("Rust of 1,000 loops of two atoms, once", &loops(1_000, 1), &rust);
    show("Rust of 1,000 loops of two atoms, 500 times", &loops(1_000, 500), &rust);
    show("Rust of a condition of 100,000 operands", &operands(100_000), &rust);
    fs::remove_dir_all(folder).expect("the folder of this run");
}

/// Returns at least `bytes` bytes of error-free plans in the style of plans that people write.
fn small_plans(bytes: usize) -> String {
    let mut plans = String::with_capacity(bytes + 1000);
    for number in 0.. {
        if plans.len() >= bytes {
            break;
        }
        let (speed, bearing) = (10 + number % 50, number % 360);
        writeln!(plans, "// From one door to the next, number {number}.\n{{ Leg{number} (bumper)").unwrap();
        writeln!(plans, "  (Atom (atIsection 0100 OR wait {}s) (goAvoid {bearing} 40 {speed}))", 5 + number % 7)
            .unwrap();
        writeln!(plans, "  {{ Crossing (wait 1min)\n    (Atom (NOT atIsection 0100 AND t > 500ms) (go {speed} 0))")
            .unwrap();
        writeln!(plans, "    ((Atom (r 3 < 0.5m) align 3 5) (Atom (null) rotate {bearing}deg))^3\n  }}\n}}\n").unwrap();
    }
    plans
}

/// Returns a plan that is a sequence of atoms. If `differ` is `true`, no two conditions are equal; otherwise all are
/// equal.
fn written_out(atoms: usize, differ: bool) -> String {
    let mut plan = String::from("{ P (bumper)\n");
    for atom in 0..atoms {
        let from = if differ { atom } else { 0 };
        writeln!(plan, "  (Atom (t > {from}ms OR atIsection 0100) (go {} 0.1))", 10 + atom % 50).unwrap();
    }
    plan + "}\n"
}

/// Returns a plan of `number` loops with two atoms and `count` passes each.
fn loops(number: usize, count: usize) -> String {
    let mut plan = String::from("{ P (bumper)\n");
    for number in 0..number {
        writeln!(plan, "  ((Atom (atIsection 0100) (go {} 0)) (Atom (wait {number}) stop))^{count}", 10 + number % 50)
            .unwrap();
    }
    plan + "}\n"
}

/// Returns a plan of one atom with `number` operands in its condition.
fn operands(number: usize) -> String {
    let operands: Vec<_> = (1..=number).map(|seconds| format!("wait {seconds}")).collect();
    format!("{{ P (Atom ({}) stop) }}\n", operands.join(" OR "))
}

fn run(mdlec: &Path, file: &Path, arguments: &[&str]) -> Cost {
    let (start, used) = (Instant::now(), used_by_children());
    let mut command = Command::new(mdlec);
    let mut child =
        command.args(arguments).arg(file).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("mdlec");
    let mut memory = 0;
    while child.try_wait().expect("a child").is_none() {
        memory = most_memory(child.id()).unwrap_or(memory);
        sleep(LOOK);
    }
    Cost { wall: start.elapsed(), user: used_by_children() - used, memory }
}

/// Returns the peak memory of a process in kB, or `None` if the process has ended.
fn most_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

/// Returns the user time of all children so far, in seconds: field 16 of `/proc/self/stat`, in hundredths of a second.
fn used_by_children() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").expect("Linux");
    let after_name = stat.rsplit(')').next().expect("a name in brackets");
    let ticks = after_name.split_whitespace().nth(13).expect("as proc(5) has it");
    ticks.parse::<f64>().expect("a number") / 100.0
}

/// Builds the compiler as users have it, and returns its path.
fn mdlec() -> PathBuf {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.toml");
    let mut command = Command::new(env!("CARGO"));
    command.args(["build", "--release", "--package", "mdlec", "--message-format=json", "--manifest-path", manifest]);
    let output = command.stderr(Stdio::inherit()).output().expect("cargo");
    assert!(output.status.success(), "cargo");
    let messages = String::from_utf8(output.stdout).expect("JSON");
    let built = messages.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let mut executables = built.filter_map(|message| message["executable"].as_str().map(PathBuf::from));
    executables.next_back().expect("an executable")
}
