//! Tests that emitted code cannot panic: the executables of `tests/bare` link and run, although no function is defined
//! that a panic could call.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;

use mdle_compiler::alphabet::{self, Alphabet};
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::rust::{Header, Shape, emit_as};
use mdle_compiler::trace::{Reports, Script, TreeWalk, run};
use mdle_compiler::{Compiled, builtin, compile};
use mdle_tests::elf::sections;
use mdle_tests::repository::root;

/// The executables, each with its name, its plan, and the plan's shape.
const EXECUTABLES: [(&str, &str, Shape); 4] = [
    ("round_as_code", "Round", Shape::Code),
    ("round_as_rows", "Round", Shape::Rows),
    ("recall", "Recall", Shape::Rows),
    ("every_quark", "EveryQuark", Shape::Code),
];

/// Script for the plan `Round` in which most of the plan's interrupts fire.
const ROUND: &str = r#"
{"t": 0.0, "fired": ["atIsection 0100"]}
{"t": 0.1, "fired": ["atIsection 1000"]}
{"t": 0.2}
{"t": 0.6}
{"t": 0.7, "completed": ["rotate 90"]}
{"t": 0.8}
{"t": 0.9, "completed": ["rotate -90"]}
{"t": 1.4}
{"t": 1.5, "fired": ["atIsection 0100"]}
{"t": 4.4}
{"t": 4.5, "fired": ["atIsection 0000"]}
{"t": 4.6, "completed": ["rotate 45"]}
{"t": 4.7, "fired": ["atIsection 0010"]}
{"t": 5.7}
{"t": 5.8, "completed": ["rotate 0"]}
{"t": 6.8}
{"t": 7.8}
{"t": 9.6, "fired": ["atIsection 0000"]}
{"t": 9.7, "fired": ["atIsection 0001"]}
"#;

/// Script for the plan `Round` in which timers fire and contact ends the plan.
const ROUND_IN_TIME: &str = r#"
{"t": 0.0}
{"t": 20.0}
{"t": 35.0, "fired": ["atIsection 1000"]}
{"t": 35.1}
{"t": 65.1, "fired": ["atIsection 0010"]}
{"t": 65.2, "fired": ["bumper"]}
"#;

/// Script for the plan `Round` in which comparisons of measurements fire.
const ROUND_BY_SIGNALS: &str = r#"
{"t": 0.0}
{"t": 0.1, "fired": ["r2 < 0.3"]}
{"t": 15.1}
{"t": 15.2, "completed": ["rotate 45"]}
{"t": 15.3, "fired": ["r6 == r14"]}
{"t": 15.6, "fired": ["r6 == r14"]}
{"t": 15.7, "fired": ["v >= 80"]}
"#;

/// Script for the plan `Recall`: the first element ends by time and the following scopes by RISING; contact ends the
/// plan.
const RECALL: &str = r#"
{"t": 0.0}
{"t": 2.0}
{"t": 3.0}
{"t": 3.5, "completed": ["turn 90"]}
{"t": 3.6, "fired": ["r2 < 0.3"]}
{"t": 3.7, "fired": ["r2 < 0.3"]}
{"t": 4.6}
{"t": 5.6}
{"t": 6.0, "fired": ["bumper"]}
"#;

/// Script for the plan `Recall`: conditions that hold from the beginning do not rise, and the first element ends by its
/// other operand.
const RECALL_OTHERWISE: &str = r#"
{"t": 0.0, "fired": ["bumper"]}
{"t": 0.5, "fired": ["bumper", "atIsection 1000"]}
{"t": 0.6, "fired": ["r2 < 0.3", "atIsection 0100"]}
{"t": 0.7, "fired": ["r2 < 0.3"]}
{"t": 1.7}
{"t": 2.7}
{"t": 5.7}
"#;

const EVERY_QUARK: &str = r#"
{"t": 0.0}
{"t": 0.1, "completed": ["goAvoid 0 2 20"]}
{"t": 1.1}
{"t": 1.2, "completed": ["turn -90"]}
{"t": 1.3}
{"t": 1.4, "completed": ["align 7 9"]}
{"t": 1.5}
{"t": 1.6, "completed": ["rotate 90"]}
{"t": 1.7}
{"t": 2.0}
{"t": 2.1, "completed": ["path bend"]}
{"t": 2.2}
{"t": 2.3, "fired": ["lowBattery"]}
{"t": 2.4, "fired": ["lowBattery", "charger"]}
{"t": 2.5, "fired": ["charger"]}
{"t": 2.6, "fired": ["battery > 12", "age3 < 1", "charger"]}
"#;

fn compiled(plan: &str) -> (Compiled, Alphabet) {
    let folder = root().join("tests/bare");
    let read = |text: &str| alphabet::read(SourceId(0), text).0.expect("an alphabet");
    let own = read(&fs::read_to_string(folder.join("alphabet.mdle")).unwrap());
    let shared: Vec<_> = builtin::alphabets().iter().filter(|file| !file.target).map(|file| read(file.text)).collect();
    let alphabet = alphabet::combine(own, &shared).0;
    let text = fs::read_to_string(folder.join("plan.mdle")).unwrap();
    let (mut compiled, found) = compile(SourceId(0), &text, &alphabet, Some(plan));
    assert_eq!(found, []);
    (compiled.pop().expect("a plan"), alphabet)
}

/// Returns the folder of the executables, which are built once.
fn built() -> &'static Path {
    static BUILT: LazyLock<PathBuf> = LazyLock::new(|| {
        for (name, plan, shape) in EXECUTABLES {
            let (Compiled { machine, .. }, alphabet) = compiled(plan);
            let mut sources = Sources::default();
            sources.add("plan.mdle", fs::read_to_string(root().join("tests/bare/plan.mdle")).unwrap());
            let text = emit_as(shape, &machine, Header { sources: &sources, file: "plan.mdle", plan }, &alphabet);
            write_if_changed(&plans().join(name).with_extension("rs"), &text);
        }
        let bins = EXECUTABLES.iter().flat_map(|(name, ..)| ["--bin", name]);
        let output = cargo_build().args(bins).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{message}\n`tests/bare/src/system.rs` says how to find a path that panics");
        target().join("release")
    });
    &BUILT
}

fn plans() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("bare/plans")
}

fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("bare/target")
}

/// Writes a file only if its text has changed, because a new modification time would cause a rebuild.
fn write_if_changed(path: &Path, text: &str) {
    if fs::read_to_string(path).ok().as_deref() != Some(text) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

fn cargo_build() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(["build", "--release", "--locked", "--offline", "--quiet", "--target-dir"]).arg(target());
    command.current_dir(root().join("tests/bare")).env("PLANS", plans());
    // Settings for the workspace's build do not suit an executable without std.
    let about_builds = ["CARGO_BUILD", "CARGO_ENCODED", "CARGO_PROFILE", "RUSTFLAGS", "RUSTC_W"];
    for (name, _) in std::env::vars_os() {
        if about_builds.iter().any(|start| name.to_string_lossy().starts_with(start)) {
            command.env_remove(name);
        }
    }
    command
}

/// Runs an executable on a script, and returns its output.
fn printed(executable: &str, script: &Script) -> String {
    let mut child =
        Command::new(built().join(executable)).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let outputs: Vec<u8> = script.turns().iter().flat_map(record).collect();
    // This fails if the plan is over before all input is read, which is not an error.
    let _ = child.stdin.take().unwrap().write_all(&outputs);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the record, as the executables read it, of an output for which the quarks report the script's values. Pose
/// and ranges depend on this turn alone. The robot is at rest only where the script completes a law, so that no law
/// completes by itself.
fn record(reports: &Reports) -> Vec<u8> {
    let message = |text: &str| reports.completed.contains(text);
    let goals =
        [("rotate 90", 90.0), ("rotate -90", -90.0), ("rotate 45", 225.0), ("turn -90", -90.0), ("turn 90", 90.0)];
    let heading = goals.iter().find(|(law, _)| message(law)).map_or(0.0, |(_, degrees)| degrees * (PI / 180.0));
    let x = if message("goAvoid 0 2 20") { 2.0 } else { 0.0 };
    let omega = if reports.completed.is_empty() { 0.5 } else { 0.0 };
    let pressed = f64::from(u8::from(reports.fired.contains("bumper")));
    // Without a pattern, all ranges are short: `atIsection 1111`, which no plan reads.
    let pattern = reports.fired.iter().find_map(|text| text.strip_prefix("atIsection ")).unwrap_or("1111");
    let mut ranges = [1.0; 16];
    for (range, bit) in ranges.iter_mut().step_by(4).zip(pattern.chars()) {
        *range = if bit == '1' { 0.5 } else { -1.0 };
    }
    ranges[9] = if message("align 7 9") { ranges[7] } else { 1.5 };
    let compared = |text: &str| reports.fired.contains(text);
    ranges[2] = if compared("r2 < 0.3") { 0.2 } else { 1.0 };
    ranges[6] = if compared("r6 == r14") { ranges[14] } else { 1.5 };
    let v = if compared("v >= 80") { 0.9 } else { 0.0 };
    let [is_low, is_plugged] = ["lowBattery", "charger"].map(|name| f64::from(u8::from(compared(name))));
    let battery = if compared("battery > 12") { 12.5 } else { 11.5 };
    let numbers = [x, 0.0, heading, v, omega, pressed, battery, is_low, is_plugged];
    let bits = numbers.into_iter().chain(ranges).map(f64::to_bits);
    std::iter::once(reports.t.0).chain(bits).flat_map(u64::to_le_bytes).collect()
}

/// Asserts that an executable and the compiler's machine behave equally on a script. Returns the printed turns, each
/// with its input.
fn traced(executable: &str, plan: &str, script: &str) -> String {
    let (Compiled { plan, .. }, _) = compiled(plan);
    let script = Script::read(script).expect("a script");
    let printed = printed(executable, &script);
    let (mut trace, mut turns) = (String::new(), String::new());
    for turn in printed.lines().collect::<Vec<_>>().chunks(2) {
        trace += &format!("{}\n", turn[0]);
        turns += &format!("{}  {}\n", turn[0], turn[1]);
    }
    let expected: String = run(TreeWalk::new(&plan), &script).map(|line| format!("{line}\n")).collect();
    assert_eq!(trace, expected, "{executable}");
    turns
}

#[test]
fn conditions_and_nesting_of_every_form_link_and_run_in_every_shape() {
    let scripts = [ROUND, ROUND_IN_TIME, ROUND_BY_SIGNALS];
    let turns = |executable| scripts.map(|script| traced(executable, "Round", script)).concat();
    let [turns, rows] = ["round_as_code", "round_as_rows"].map(turns);
    assert_eq!(turns, rows);
    assert_eq!(never_fired("Round", &turns), ["null"]);
    insta::assert_snapshot!(turns);
}

#[test]
fn memories_link_and_run() {
    let turns = [RECALL, RECALL_OTHERWISE].map(|script| traced("recall", "Recall", script)).concat();
    assert_eq!(never_fired("Recall", &turns), ["null"]);
    insta::assert_snapshot!(turns);
}

/// Returns the conditions of a plan by which no element ended in these turns.
fn never_fired(plan: &str, turns: &str) -> Vec<String> {
    let (Compiled { machine, .. }, _) = compiled(plan);
    let interrupts = machine.elements().filter_map(mdle_compiler::fsm::Element::interrupt);
    let conditions: BTreeSet<_> = interrupts.map(|interrupt| interrupt.text.clone()).collect();
    conditions.into_iter().filter(|text| !turns.contains(&format!("\"by\":\"{text}\""))).collect()
}

#[test]
fn every_quark_links_and_runs() {
    insta::assert_snapshot!(traced("every_quark", "EveryQuark", EVERY_QUARK));
}

#[test]
fn a_panic_that_is_left_does_not_link() {
    let output = cargo_build().args(["--bin", "indexing"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(message.contains("undefined") && message.contains("a_panic_path_is_left"), "{message}");
}

#[test]
fn a_plan_with_its_machine_is_less_than_16_kilobytes_of_code() {
    let sizes = EXECUTABLES.map(|(name, ..)| {
        let sections = sections(&fs::read(built().join(name)).unwrap());
        let size = |name: &str| sections.iter().find(|(section, _)| section == name).expect(name).1;
        (name, size(".text"), size(".rodata"))
    });
    println!("{sizes:?}");
    assert!(sizes[0].1 < 16 * 1024, "{sizes:?}");
    // Rows include every quark of the robot, even if the plan does not use it, and these executables also report
    // operands. The echoes of `goAvoid`, of five bytes each, take 0.65 kB more of code and 0.95 kB less of constants
    // than larger ones did. The largest executable, with the memories, has 59.2 kB of code.
    assert!(sizes.iter().all(|(_, code, _)| *code < 59 * 1024), "{sizes:?}");
}

#[test]
fn it_is_built_of_what_the_workspace_is() {
    let lock = |folder: &str| fs::read_to_string(root().join(folder).join("Cargo.lock")).unwrap();
    let (own, workspace) = (lock("tests/bare"), lock(""));
    let foreign: Vec<_> = own.split("\n\n").filter(|package| package.contains("checksum = ")).collect();
    assert!(!foreign.is_empty());
    let others: Vec<_> = foreign.into_iter().filter(|package| !workspace.contains(package.trim())).collect();
    assert_eq!(others, [""; 0], "`cargo update --manifest-path tests/bare/Cargo.toml` can choose another version");
}
