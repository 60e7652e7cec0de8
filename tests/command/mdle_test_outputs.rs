//! Tests of `mdle test`: coverage, pictures, machine-readable results, recorded expectations, repeated runs, and faults
//! that are inserted into plans of the book.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;
use serde_json::Value;

/// A plan with an atom that the tests below never reach, and a condition of two parts.
const PLAN: &str = "{ Dock (bumper)
  (Atom (r0 < 60cm OR wait 20s) (go 20 0))
  { Shake (wait 15s) ((Atom (wait 500ms) (go 5 0)) (Atom (null) turn 90))^3 }
  (Atom (bumper AND NOT r0 < 60cm OR r1 < 1m) stop)
}
";
const TESTS: &str = "[[test]]
name = \"shakes\"
script = [{ t = 0 }, { t = 3, fired = [\"r0 < 60cm\"] }, { t = 4 }, { t = 5, fired = [\"bumper\"] }]
expect.end = \"bumper\"

[[test]]
name = \"does not shake <yet>\"
script = [{ t = 0 }, { t = 1 }]
expect.order = [\"Shake\"]

[[test]]
name = \"drives\"
world = \"room\"
start = \"0.7,0.7,0\"
seeds = 2
timeout = \"2s\"
expect.end = \"running\"
";

fn with(name: &str, tests: &str) -> PathBuf {
    let folder = folder(name);
    fs::write(folder.join("dock.mdle"), PLAN).unwrap();
    fs::write(folder.join("dock.test.toml"), tests).unwrap();
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(mdle()).arg("test").args(arguments).current_dir(folder).output().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn coverage_marks_what_no_test_reaches() {
    let folder = with("coverage", TESTS);
    let output = run(&folder, &["--coverage", "--pictures", "pictures"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!(out(&output));
    let picture = fs::read_to_string(folder.join("pictures/dock.svg")).unwrap();
    assert_eq!(picture.matches("stroke-dasharray:4 3").count(), 1, "one atom is never reached");
    let counts = ["4×", "1×", "0×"].map(|count| picture.contains(&format!(">{count}</text>")));
    assert_eq!(counts, [true; 3], "{picture}");
}

#[test]
fn results_are_json_and_junit() {
    let folder = with("results", TESTS);
    let output = run(&folder, &["--json", "--junit", "results.xml"]);
    let json: Value = serde_json::from_str(&out(&output)).unwrap();
    insta::assert_snapshot!(serde_json::to_string_pretty(&json["tests"]).unwrap());
    assert_eq!((json["passed"].as_bool(), json["coverage"][0]["atoms"][0].as_u64()), (Some(false), Some(3)));
    insta::assert_snapshot!(fs::read_to_string(folder.join("results.xml")).unwrap());
    let unwritten = run(&folder, &["--junit", "missing/results.xml"]);
    let message = String::from_utf8(unwritten.stderr).unwrap();
    assert!(
        unwritten.status.code() == Some(2) && message.contains("missing/results.xml cannot be written"),
        "{message}"
    );
}

#[test]
fn expectations_are_recorded_for_review() {
    let tests = "# Kept.
[[test]]
name = \"new\"
world = \"room\"    # kept too
start = \"0.7,0.7,0\"

[[test]]
name = \"old\"
script = [{ t = 0 }, { t = 3, fired = [\"r0 < 60cm\"] }, { t = 4 }]
expect.atoms = [\"go 20 0\"]
expect.end = \"bumper\"
expect.never = [\"turn 90\"]

[[test]]
name = \"good\"
script = [{ t = 0 }]
expect.order = [\"go 20 0\"]
";
    let folder = with("update", tests);
    let output = run(&folder, &["--update"]);
    // `expect.never` has no value that could be recorded.
    assert_eq!(output.status.code(), Some(1));
    let updated = fs::read_to_string(folder.join("dock.test.toml")).unwrap();
    insta::assert_snapshot!(format!("{}\n{updated}", out(&output)));
    let again = run(&folder, &["--update"]);
    assert!(!out(&again).contains("updated"), "{}", out(&again));
    assert_eq!(fs::read_to_string(folder.join("dock.test.toml")).unwrap(), updated);
}

#[test]
fn tests_run_again_when_a_file_changes() {
    let folder = with("watch", "[[test]]\nname = \"one\"\nscript = [{ t = 0 }]\nexpect.end = \"running\"\n");
    let mut child = Command::new(mdle());
    let child = child.args(["test", "--watch"]).current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = child.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut until = |text: &str| lines.by_ref().find(|line| line.contains(text)).is_some();
    assert!(until("1 passed"));
    fs::write(
        folder.join("dock.test.toml"),
        "[[test]]\nname = \"changed\"\nscript = [{ t = 0 }]\nexpect.end = \"bumper\"\n",
    )
    .unwrap();
    assert!(until("dock.test.toml has changed") && until("FAIL  changed") && until("1 failed"));
    fs::write(folder.join("dock.mdle"), "{ Dock (bumper) }\n").unwrap();
    assert!(until("dock.mdle has changed"));
    fs::write(folder.join("dock.mdle"), format!("// Well again.\n{PLAN}")).unwrap();
    assert!(until("dock.mdle has changed") && until("1 failed"));
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Faults in plans of the book, each with the plan, the text to replace, its replacement, and the test that must fail.
const FAULTS: [[&str; 4]; 4] = [
    ["patrol", "Leg(180deg, 3m, 40cm/s)", "Leg(100deg, 3m, 40cm/s)", "three rounds up and down the hall"],
    ["wall_following", "(r2 < 1m OR r0 < 70cm)", "(r2 < 1m)", "it bears left to the wall, and right off it"],
    ["retreat", "(wait 2s) (go -15 0)", "(wait 1s) (go -15 0)", "contact ends the drive ahead, not the retreat"],
    ["lab_tour", "FRAME 180deg Lab1ToOfficePlan", "Lab1ToOfficePlan", "the tour arrives at the office"],
];

#[test]
fn planted_faults_are_found() {
    let reports = FAULTS.map(|[plan, before, after, test]| {
        let folder = folder(&format!("fault_{plan}"));
        let text = fs::read_to_string(root().join(format!("plans/{plan}.mdle"))).unwrap();
        assert_eq!(text.matches(before).count(), 1, "{plan}");
        fs::write(folder.join(format!("{plan}.mdle")), text.replace(before, after)).unwrap();
        let tests = format!("{plan}.test.toml");
        fs::copy(root().join("plans").join(&tests), folder.join(&tests)).unwrap();
        let output = run(&folder, &[&tests, "--test", test, "--coverage"]);
        assert_eq!(output.status.code(), Some(1), "{plan}: {}", out(&output));
        format!("{before} -> {after}\n{}{}", out(&output), String::from_utf8(output.stderr).unwrap())
    });
    let [_, missing_guard, ..] = &reports;
    assert!(missing_guard.contains("go 0 -0.5235987755982988               began 0"), "{missing_guard}");
    insta::assert_snapshot!(reports.join("\n"));
}
