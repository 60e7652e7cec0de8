//! Faults in the drivers of robots, from the list in `drivers.toml`. The conformance tests of the robots must catch
//! each fault.
//!
//! All faults are built together. An expression becomes `match __fault() { 17 => { the expression with fault 17 } _ =>
//! { the original expression } }`, and an environment variable selects a fault when the test starts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::thread;

use serde::Deserialize;

use crate::checkout::{Checkout, root};
use crate::refusals::{Executable, executables};
use crate::schemata::VARIABLE;
use crate::trial::{cargo, environment};

/// Text of the list, included at build time.
const LIST: &str = include_str!("../drivers.toml");

/// Arguments of cargo for the test executables that must catch the faults.
const TESTS: [&str; 6] = ["--package", "mdle-scout-emulator", "--package", "mdle-atrv-emulator", "--test", "trials"];

/// Name of the test that must catch the faults.
const TEST: &str = "the_driver_conforms";

/// Number of faults that are tried at the same time.
const AT_ONCE: usize = 2;

/// Time in seconds after which a test counts as hanging; without a fault it takes two seconds.
const PATIENCE: &str = "120";

/// Code that selects the fault; it is added to each file.
const CHOICE: &str = r#"
fn __fault() -> u32 {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let read = || std::env::var("MDLE_MUTANT").ok().and_then(|number| number.parse().ok()).unwrap_or(0);
    *CHOSEN.get_or_init(read)
}
"#;

/// Content of the list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Faults {
    fault: Vec<Fault>,
}

/// An expression in a file of a driver, and a wrong expression that replaces it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fault {
    name: String,
    file: String,
    from: String,
    to: String,
}

/// Tries all faults and prints the outcome of each; returns `true` if all were caught.
pub(crate) fn all_are_caught() -> bool {
    let Faults { fault: faults } = toml::from_str(LIST).expect("tests/mutants/drivers.toml is as its head says");
    let checkout = Checkout::copy();
    for file in faults.iter().map(|fault| &*fault.file).collect::<BTreeSet<_>>() {
        let text = fs::read_to_string(root().join(file)).expect(file);
        checkout.write(file, &with_faults(file, &text, &faults).unwrap_or_else(|wrong| panic!("{wrong}")));
    }
    println!("building {} faults", faults.len());
    let tests = built(&checkout);
    for test in &tests {
        let output = executed(test, 0);
        assert!(output.status.success(), "without a fault: {}", String::from_utf8_lossy(&output.stderr));
    }
    let (left, survived) = (Mutex::new((1..).zip(&faults)), Mutex::new(0));
    thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((number, fault)) = { left.lock().expect("no one panics").next() } {
                    let outcome = tried(&tests, number, fault);
                    *survived.lock().expect("no one panics") += u32::from(outcome.is_none());
                    let outcome = outcome.unwrap_or_else(|| "SURVIVES".to_owned());
                    println!("{}: {}: {outcome}", fault.file, fault.name);
                }
            });
        }
    });
    let survived = survived.into_inner().expect("no one panics");
    println!("{} faults, {} caught, {survived} survived", faults.len(), faults.len() - survived as usize);
    survived == 0
}

/// Returns the text of a file with all of its faults. The number of a fault is its position in the list, from 1.
fn with_faults(file: &str, text: &str, faults: &[Fault]) -> Result<String, String> {
    let (code, tests) = text.split_at(text.find("#[cfg(test)]").unwrap_or(text.len()));
    let mut expressions = BTreeMap::<usize, (&str, String)>::new();
    for (number, Fault { name, from, to, .. }) in (1..).zip(faults).filter(|(_, fault)| fault.file == file) {
        let [place] = code.match_indices(from).map(|(place, _)| place).collect::<Vec<_>>()[..] else {
            return Err(format!("drivers.toml: {file} has `{from}` not once ({name})"));
        };
        let (_, arms) = expressions.entry(place).or_insert_with(|| (from, String::new()));
        arms.push_str(&format!("{number} => {{ {to} }} "));
    }
    let (mut mutated, mut end) = (String::new(), 0);
    for (place, (from, arms)) in expressions {
        let before = code.get(end..place).ok_or_else(|| format!("drivers.toml: {file}: `{from}` is in another"))?;
        mutated.push_str(&format!("{before}(match __fault() {{ {arms} _ => {{ {from} }} }})"));
        end = place + from.len();
    }
    Ok([&mutated, &code[end..], CHOICE, tests].concat())
}

/// Builds the tests in the copy, and returns their executables.
fn built(checkout: &Checkout) -> Vec<Executable> {
    let mut command = Command::new(cargo());
    environment(&mut command, checkout);
    command.stderr(Stdio::inherit());
    command.args(["test", "--quiet", "--no-run", "--message-format=json"]).args(TESTS);
    let output = command.output().expect("cargo runs");
    let printed = String::from_utf8(output.stdout).expect("cargo prints UTF-8");
    assert!(output.status.success(), "{printed}");
    executables(&printed)
}

/// Returns the first check that fails with a fault, and the reason; `None` if no check fails.
fn tried(tests: &[Executable], number: u32, fault: &Fault) -> Option<String> {
    // The tests of the driver in targets/ROBOT are in targets/ROBOT/emulator.
    let robot = Path::new(&fault.file).components().nth(1).expect("a file of a driver");
    let test = tests.iter().find(|test| test.folder.iter().any(|part| part == robot.as_os_str()));
    let output = executed(test.expect("a test of this robot"), number);
    if output.status.success() {
        return None;
    }
    let message = String::from_utf8_lossy(&output.stderr);
    let mut lines = message.lines().skip_while(|line| !line.starts_with("BROKEN"));
    let (name, why) = (lines.next().unwrap_or("it hangs"), lines.next().unwrap_or_default());
    Some(format!("{}\n    {}", name.trim_start_matches("BROKEN").trim(), why.trim()))
}

/// Runs a test with the fault `number`, or without a fault if `number` is 0.
fn executed(test: &Executable, number: u32) -> Output {
    let mut command = Command::new("timeout");
    command.arg("--signal=KILL").arg(PATIENCE).arg(&test.path).current_dir(&test.folder);
    // A test prints immediately only if its output is not captured.
    command.env(VARIABLE, number.to_string()).env("RUST_BACKTRACE", "0").args([TEST, "--nocapture"]);
    command.output().expect("`timeout` runs")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(from: &str, to: &str) -> Fault {
        let [name, file] = ["a fault", "a.rs"].map(str::to_owned);
        Fault { name, file, from: from.to_owned(), to: to.to_owned() }
    }

    #[test]
    fn an_expression_holds_its_faults_beside_itself() {
        let text = "fn a() -> i32 { b + c }\n#[cfg(test)]\nmod tests { b + c }\n";
        let faults =
            [fault("b + c", "b - c"), Fault { file: "other.rs".into(), ..fault("x", "y") }, fault("b + c", "0")];
        let mutated = with_faults("a.rs", text, &faults).unwrap();
        let head = "fn a() -> i32 { (match __fault() { 1 => { b - c } 3 => { 0 }  _ => { b + c } }) }\n";
        assert_eq!(mutated, format!("{head}{CHOICE}#[cfg(test)]\nmod tests {{ b + c }}\n"));
    }

    #[test]
    fn an_expression_must_occur_exactly_once() {
        let message = |from: &str| with_faults("a.rs", "b + b", &[fault(from, "0")]).unwrap_err();
        assert_eq!(message("c"), "drivers.toml: a.rs has `c` not once (a fault)");
        assert_eq!(message("b"), "drivers.toml: a.rs has `b` not once (a fault)");
        let inside = with_faults("a.rs", "b + b", &[fault("b + b", "0"), fault(" + b", "0")]);
        assert_eq!(inside.unwrap_err(), "drivers.toml: a.rs: ` + b` is in another");
    }

    #[test]
    fn every_fault_is_of_an_expression_that_is_there() {
        let Faults { fault: faults } = toml::from_str(LIST).unwrap();
        for file in faults.iter().map(|fault| &*fault.file).collect::<BTreeSet<_>>() {
            let text = fs::read_to_string(root().join(file)).unwrap();
            let mutated = with_faults(file, &text, &faults).unwrap_or_else(|wrong| panic!("{wrong}"));
            assert!(syn::parse_file(&mutated).is_ok(), "{file}");
        }
    }
}
