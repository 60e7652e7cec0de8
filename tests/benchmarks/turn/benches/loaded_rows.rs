//! Compares the instructions of a turn of loaded rows with those of emitted rows. Callgrind counts the turn alone,
//! without the loop that calls it and without the plan's beginning. The numbers are equal in every run. Needs Valgrind.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::env;
use std::hint::black_box;
use std::process::Command;

use mdle_workload::cases::{Case, run};
use mdle_workload::machines::loaded::{Loaded8, LoadedRising8};
use mdle_workload::machines::plan::{Rows8, RowsRising8};

/// Number of turns, a whole number of passes through 8 atoms.
const TURNS: u32 = 10_000;
/// Environment variable with the role of a process: the number of a pair, of a machine of the pair, and of a case.
const ROLE: &str = "MDLE_LOADED_ROWS_ROLE";
/// Pairs of machines that are compared, each with its name, the emitted machine, and the loaded machine.
const PAIRS: [(&str, fn(Case) -> f64, fn(Case) -> f64); 2] = [
    ("T(8)", |case| run::<Rows8>(case, TURNS), |case| run::<Loaded8>(case, TURNS)),
    ("T(8), RISING", |case| run::<RowsRising8>(case, TURNS), |case| run::<LoadedRising8>(case, TURNS)),
];

fn main() {
    match env::var(ROLE) {
        Ok(role) => {
            let numbers: Vec<usize> = role.split(' ').map(|number| number.parse().expect("a number")).collect();
            let &[pair, machine, case] = numbers.as_slice() else { panic!("three numbers: {role}") };
            let (_, emitted, loaded) = PAIRS[pair];
            black_box([emitted, loaded][machine](black_box(Case::ALL[case])));
        }
        Err(_) => compare(),
    }
}

/// Measures each machine in each case, and prints the number of instructions per turn.
fn compare() {
    println!("{:<16}{:<8}{:>12}{:>12}{:>8}", "instructions", "", "emitted", "loaded", "ratio");
    for (pair, (name, ..)) in PAIRS.iter().enumerate() {
        for (case, word) in Case::ALL.iter().enumerate() {
            let [emitted, loaded] = [0, 1].map(|machine| counted(&format!("{pair} {machine} {case}")));
            let word = format!("{word:?}").to_lowercase();
            println!("{name:<16}{word:<8}{emitted:>12.1}{loaded:>12.1}{:>8.3}", loaded / emitted);
        }
    }
}

/// Returns the number of instructions per turn that a process with this role takes.
fn counted(role: &str) -> f64 {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    valgrind.arg("--toggle-collect=*as mdle_workload::machines::Robot>::turn");
    valgrind.arg("--toggle-collect=mdle_workload::machines::loaded::turn");
    valgrind.arg(env::current_exe().expect("this program")).env(ROLE, role);
    let output = valgrind.output().expect("Valgrind is installed");
    let report = String::from_utf8_lossy(&output.stderr);
    let collected = report.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse::<f64>().ok());
    collected.unwrap_or_else(|| panic!("{report}")) / f64::from(TURNS)
}
