//! Tests that emitted Rust, when compiled, behaves like the machines of the compiler (docs/src/reference/semantics.md,
//! 9).
//!
//! Every plan is emitted in every shape. All plans of a shape form one package, which is compiled once and run once.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdle_compiler::rust::{Header, Shape, emit_as, plan_type};
use mdle_compiler::trace::Script;
use mdle_scripted::{INTERRUPTS, LAWS};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::outputs::outputs;
use mdle_tests::pipeline::{Machines, compile_plan, scripted, sources};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_tests::repository::root;

/// Number of random plans that are emitted in each shape. `SCRIPTS` is the number of scripts on which each plan runs.
const PLANS: u64 = 40;
const SCRIPTS: u64 = 25;

/// Names of plans that could collide with names in a generated file.
const ROOTS: &[&str] = &[
    "Main", "Cursor", "Plan", "Output", "At", "Nanos", "Fsm", "Begin", "Cause", "Next", "atom", "Bracket", "Input",
    "Running",
];

/// A plan with its scripts.
struct Case {
    root: &'static str,
    text: String,
    scripts: Vec<String>,
}

#[test]
fn plans_as_code_do_what_the_other_machines_do() {
    compare(Shape::Code);
}

#[test]
fn plans_as_rows_do_what_the_other_machines_do() {
    compare(Shape::Rows);
}

fn compare(shape: Shape) {
    let cases: Vec<_> = (0..repeated(PLANS)).map(random).chain([every_quark(), deep()]).collect();
    let package = Package::write(shape, &cases);
    let printed = package.run(&cases);
    let mut traces = printed.split("== next\n");
    for (number, case) in cases.iter().enumerate() {
        let compiled = compile_plan(&case.text, case.root).unwrap_or_else(|report| panic!("{report}"));
        let machines = Machines::new(&compiled);
        for script in &case.scripts {
            let emitted = traces.next().expect("a trace for every script");
            for (machine, trace) in machines.traces(&Script::read(script).expect("a script")) {
                let trace: String = trace.iter().map(|line| format!("{line}\n")).collect();
                assert!(
                    trace == emitted,
                    "plan {number}\n{machine}:\n{trace}emitted:\n{emitted}{}\n{script}",
                    case.text
                );
            }
        }
    }
}

/// Returns a random plan. Every second plan has no memories, because plans with memories are always emitted as rows.
fn random(seed: u64) -> Case {
    let root = ROOTS[seed as usize % ROOTS.len()];
    let draw = |drawn: u64| {
        let plans = repeated(PLANS);
        let mut chance = Chance::new(1_000_000 + seed + drawn * plans);
        // The first plans have about 4 atoms, and the last ones about 24.
        let size = 4 + (20 * seed / plans) as usize;
        let text = RandomPlan::new(&mut chance, size, seed % 20 == 19).named(root).to_string();
        // Nested loops can lead to too many states.
        let compiled = compile_plan(&text, root).ok()?;
        if seed.is_multiple_of(2) && compiled.machine.sizes().memories > 0 {
            return None;
        }
        let scripts = (0..SCRIPTS).map(|_| script(&mut chance, 12)).collect();
        Some(Case { root, text, scripts })
    };
    (0..1000).find_map(draw).expect("a plan")
}

/// Returns a plan that contains each interrupt and each law of the target, with arguments in default units, to test
/// that each is created with the arguments in its text.
fn every_quark() -> Case {
    let mut text = String::from("{ Main");
    for (number, interrupt) in INTERRUPTS.iter().enumerate() {
        write!(text, " FRAME {}deg (Atom ({interrupt}) {})", number * 15, LAWS[number % LAWS.len()]).unwrap();
    }
    text.push_str(" }");
    let mut script = String::new();
    for (turn, interrupt) in INTERRUPTS.iter().enumerate() {
        // First a turn that must not end the atom, then a turn that ends it.
        let others: Vec<_> =
            INTERRUPTS.iter().filter(|other| *other != interrupt).map(|text| format!("{text:?}")).collect();
        writeln!(script, "{{\"t\":{turn}.0,\"fired\":[{}]}}", others.join(",")).unwrap();
        writeln!(script, "{{\"t\":{turn}.5,\"fired\":[{interrupt:?}]}}").unwrap();
    }
    let completions = LAWS.iter().fold(String::new(), |lines, law| {
        format!("{lines}{{\"t\":{}.0,\"completed\":[{law:?}]}}\n", lines.lines().count())
    });
    Case { root: "Main", text, scripts: vec![script, completions] }
}

/// Returns a plan with a hundred nested scopes, each with its own condition.
fn deep() -> Case {
    let scopes = (0..100).map(|level| format!("{{ Level{level} ({} AND wait {level}) ", ["a", "b", "c"][level % 3]));
    let text =
        format!("{{ Main {} (Atom (d) idle) {} (Atom (e) drift) }}", scopes.collect::<String>(), "}".repeat(100));
    let mut chance = Chance::new(0);
    let scripts = (0..SCRIPTS).map(|_| script(&mut chance, 12)).collect();
    Case { root: "Main", text, scripts }
}

/// The package with the emitted plans.
struct Package {
    folder: PathBuf,
}

impl Package {
    fn write(shape: Shape, cases: &[Case]) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("emitted-{shape:?}").to_lowercase());
        let package = Self { folder };
        fs::create_dir_all(package.folder.join("src")).unwrap();
        fs::copy(root().join("Cargo.lock"), package.folder.join("Cargo.lock")).unwrap();
        package.file("Cargo.toml", &manifest());
        let mut library = String::from(
            "//! Emitted plans: what they are is plain Rust without a warning, for any robot.\n#![no_std]\n",
        );
        library.push_str("#![deny(warnings, missing_docs)]\n#![forbid(unsafe_code)]\n");
        let mut arms = String::new();
        for (number, case) in cases.iter().enumerate() {
            let compiled = compile_plan(&case.text, case.root).unwrap_or_else(|report| panic!("{report}"));
            let sources = sources(&case.text);
            let header = Header { sources: &sources, file: "plan.mdle", plan: case.root };
            package.file(&format!("src/plan_{number}.rs"), &emit_as(shape, &compiled.machine, header, scripted()));
            writeln!(library, "\n/// Plan {number}.\npub mod plan_{number};").unwrap();
            let plan = plan_type(case.root);
            writeln!(arms, "        {number} => drive(emitted::plan_{number}::{plan}::new, script, trace),").unwrap();
        }
        package.file("src/lib.rs", &library);
        package.file("src/main.rs", &MAIN.replace("ARMS", &arms));
        package
    }

    /// Writes a file only if its text has changed, so that unchanged files are not compiled again.
    fn file(&self, name: &str, text: &str) {
        let path = self.folder.join(name);
        if fs::read_to_string(&path).ok().as_deref() != Some(text) {
            fs::write(path, text).unwrap();
        }
    }

    /// Compiles the plans, and runs each on its scripts. Returns their traces, one after another.
    fn run(&self, cases: &[Case]) -> String {
        let mut turns = String::new();
        for (number, case) in cases.iter().enumerate() {
            case.scripts.iter().for_each(|script| writeln!(turns, "plan {number}\n{}", bits(script)).unwrap());
        }
        self.file("scripts", &turns);
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(["run", "--offline", "--quiet", "--", "scripts"])
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", self.folder.join("target"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }
}

fn manifest() -> String {
    let path = |folder: &str| root().join(folder).display().to_string();
    format!(
        "[package]\nname = \"emitted\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n[dependencies]\n\
         mdle-runtime = {{ path = {:?} }}\nmdle-scripted = {{ path = {:?} }}\n",
        path("runtime/core"),
        path("tests/scripted"),
    )
}

/// Returns a script in the form that `main` reads: per turn, the time in nanoseconds, and the reports as numbers.
fn bits(script: &str) -> String {
    let turns = outputs(&Script::read(script).expect("a script"));
    let lines = turns.iter().map(|(t, y)| {
        let signals = y.signals.map(|value| value.to_bits().to_string()).join(" ");
        let (way, heading) = (y.way.0, y.heading.0.to_bits());
        format!("{} {} {} {way} {heading} {signals}", t.0, y.fired, y.completed)
    });
    lines.collect::<Vec<_>>().join("\n")
}

const MAIN: &str = r#"//! Runs the emitted plans on the scripts of a file.

use mdle_runtime::{Nanometers, Nanos, Radians};
use mdle_scripted::{Output, drive};

fn main() {
    let file = std::env::args().nth(1).expect("a file of scripts");
    let text = std::fs::read_to_string(file).expect("a file of scripts");
    for (place, script) in text.split("plan ").skip(1).enumerate() {
        let (plan, turns) = script.split_once('\n').expect("turns");
        let turns: Vec<_> = turns.lines().map(turn).collect();
        let mut trace = String::new();
        run(plan.parse().expect("a number"), &turns, &mut trace).expect("room for the trace");
        print!("{}{trace}", if place == 0 { "" } else { "== next\n" });
    }
}

fn turn(line: &str) -> (Nanos, Output) {
    let numbers: Vec<u64> = line.split(' ').map(|number| number.parse().expect("a number")).collect();
    let signals = std::array::from_fn(|signal| f64::from_bits(numbers[5 + signal]));
    let (way, heading) = (Nanometers(numbers[3]), Radians(f64::from_bits(numbers[4])));
    (Nanos(numbers[0]), Output { fired: numbers[1], completed: numbers[2], signals, way, heading })
}

fn run(plan: usize, script: &[(Nanos, Output)], trace: &mut String) -> std::fmt::Result {
    match plan {
ARMS        _ => panic!("no plan {plan}"),
    }
}
"#;
