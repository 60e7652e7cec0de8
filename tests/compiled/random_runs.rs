//! Tests that random plans, loaded from their text and as executables, behave equally on the simulated robot with each
//! body and on both emulated robots. The emitted plans for a target are one program, which is built once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use mdle_compiler::rust::{Header, emit, plan_type};
use mdle_tests::chance::Chance;
use mdle_tests::driving_plan::random_plan;
use mdle_tests::executable::{folder, target};
use mdle_tests::golden;
use mdle_tests::outside::{adopt, cargo};
use mdle_tests::repository::{TextFile, root};
use mdle_tests::run_output::{emulated_run, in_simulator, loaded, simulated_run, warnings};

/// Number of random plans.
const PLANS: u64 = 300;
const FILE: &str = "random.mdle";
const TARGETS: [&str; 3] = ["sim", "scout", "atrv"];
const BODIES: [&str; 3] = ["ideal", "scout", "atrv"];
/// Maximum time of a run on an emulated robot, in seconds.
const TIME: &str = "30";
/// Environment variable with the number of the plan that a program runs.
const NUMBER: &str = "RANDOM_PLAN";

#[test]
fn random_plans_run_as_their_executables_do() {
    let folder = folder("random");
    let texts: Vec<_> = (0..PLANS).map(|seed| random_plan(&mut Chance::new(seed))).collect();
    let programs = TARGETS.map(|name| target().join("debug").join(program(name)));
    build(&folder, &texts);
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(text) = texts.get(number) else { return };
                    let own = folder.join(number.to_string());
                    fs::create_dir(&own).unwrap();
                    fs::write(own.join(FILE), text).unwrap();
                    compare(&own, number, &programs);
                    fs::remove_dir_all(own).unwrap();
                }
            });
        }
    });
}

/// Runs the plan with this number on every target, loaded from its text and in the target's program, and compares the
/// results.
fn compare(folder: &Path, number: usize, programs: &[PathBuf; 3]) {
    for (name, program) in TARGETS.into_iter().zip(programs) {
        let emitted = || {
            let mut command = Command::new(program);
            command.env(NUMBER, number.to_string());
            command
        };
        let warnings = warnings(folder, FILE, name);
        for body in if name == "sim" { &BODIES[..] } else { &[""] } {
            let seed = number.to_string();
            let run = |command| match name {
                "sim" => simulated_run(folder, command, &in_simulator(body, &seed)),
                _ => emulated_run(folder, name, command, TIME),
            };
            let mut executable = run(emitted());
            executable.err.insert_str(0, &warnings);
            assert!([Some(0), Some(4)].contains(&executable.status), "plan {number} {name} {body}: {executable:?}");
            assert_eq!(run(loaded(FILE, name)), executable, "plan {number} {name} {body}");
        }
    }
}

/// Returns the name of the program with the plans for a target.
fn program(name: &str) -> String {
    format!("random_plans_{name}")
}

/// Builds the programs with these plans. Their `main` is like that of an emitted executable, but selects one of the
/// plans.
fn build(folder: &Path, texts: &[String]) {
    let package = folder.join("package");
    let path = |folder: &str| root().join(folder).display().to_string();
    let mut manifest = "[package]\nname = \"random-plans\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n\
                        [workspace]\n\n[dependencies]\n"
        .to_owned();
    for (name, folder) in [
        ("mdle-host", "runtime/host"),
        ("mdle-runtime", "runtime/core"),
        ("mdle-sim", "targets/sim"),
        ("mdle-scout", "targets/scout"),
        ("mdle-atrv", "targets/atrv"),
    ] {
        writeln!(manifest, "{name} = {{ path = {:?} }}", path(folder)).unwrap();
    }
    for name in TARGETS {
        let sources = package.join("src/bin").join(program(name));
        fs::create_dir_all(&sources).unwrap();
        let (mut modules, mut arms) = (String::new(), String::new());
        for (number, text) in texts.iter().enumerate() {
            fs::write(sources.join(format!("plan_{number}.rs")), emitted(text, name)).unwrap();
            writeln!(modules, "mod plan_{number};").unwrap();
            let plan = plan_type("Main");
            writeln!(
                arms,
                "        Ok(\"{number}\") => run::<mdle_{name}::Target, _>(program, plan_{number}::{plan}::new),"
            )
            .unwrap();
        }
        fs::write(sources.join("main.rs"), MAIN.replace("MODULES", &modules).replace("ARMS", &arms)).unwrap();
    }
    fs::write(package.join("Cargo.toml"), manifest).unwrap();
    adopt(&package);
    let output = cargo(&package, &["build", "--quiet", "--bins"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

const MAIN: &str = r#"//! Random plans as executables.

use std::process::ExitCode;

use mdle_host::{Program, run};

MODULES
fn main() -> ExitCode {
    let program = Program { plan: "Main", version: "" };
    match std::env::var("RANDOM_PLAN").as_deref() {
ARMS        _ => ExitCode::from(100),
    }
}
"#;

/// Returns the emitted Rust of a plan for a target.
fn emitted(text: &str, name: &str) -> String {
    let alphabet = golden::alphabet(Some(name));
    let (sources, source) = golden::sources(&TextFile { path: FILE.to_owned(), text: text.to_owned() });
    let (mut plans, diagnostics) = mdle_compiler::compile(source, text, &alphabet, None);
    let compiled = plans.pop().unwrap_or_else(|| panic!("{text}: {diagnostics:?}"));
    emit(&compiled.machine, Header { sources: &sources, file: FILE, plan: "Main" }, &alphabet)
}
