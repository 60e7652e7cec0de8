//! Tests `mdle test`: messages about failed tests, errors in test files, and the tests of the plans in `plans/`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;

/// A plan with a scope, a loop, and operands of each kind.
const DOCK: &str = "{ Dock (bumper)
  (Atom (r0 < 60cm OR wait 20s) (go 20 0))
  { Shake (wait 15s) ((Atom (wait 500ms) (go 5 0)) (Atom (null) turn 90))^3 }
}
";

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(mdle()).arg("test").args(arguments).current_dir(folder).output().unwrap()
}

/// Runs `mdle test` with these arguments, and returns its standard output, its standard error and its exit status.
fn report(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = run(folder, arguments);
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("$ mdle test {}\n{out}{err}[{}]\n", arguments.join(" "), status.code().unwrap())
}

/// Returns a folder with this plan and a file of tests for it.
fn with(name: &str, plan: &str, tests: &str) -> PathBuf {
    let folder = folder(name);
    fs::write(folder.join("dock.mdle"), plan).unwrap();
    fs::write(folder.join("dock.test.toml"), tests).unwrap();
    folder
}

/// Returns the report of a single test of the plan [`DOCK`].
fn of_one(name: &str, test: &str) -> String {
    report(&with(name, DOCK, &format!("[[test]]\nname = \"one\"\n{test}")), &[])
}

#[test]
fn every_plan_of_ours_passes_its_tests() {
    let plans = root().join("plans");
    let of = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let files: Vec<_> = ["", "paper", "sound"].iter().flat_map(|folder| of(&plans.join(folder))).collect();
    let plan_files: Vec<_> = files.iter().filter(|file| file.extension().is_some_and(|end| end == "mdle")).collect();
    assert!(plan_files.len() > 10, "the plans are gone");
    for plan in &plan_files {
        assert!(plan.with_extension("test.toml").exists(), "{plan:?} has no tests");
    }
    let output = run(&root(), &["plans"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    for plan in &plan_files {
        let tests = plan.strip_prefix(root()).unwrap().with_extension("test.toml").display().to_string();
        assert!(text.lines().any(|line| line == tests), "{tests}: {text}");
    }
}

#[test]
fn failures_show_test_plan_and_transitions() {
    let script =
        "script = [{ t = 0 }, { t = 3, fired = [\"r0 < 60cm\"] }, { t = 3.5 }, { t = 4, fired = [\"bumper\"] }]\n";
    let expectations = [
        "expect.atoms = [\"go 20 0\", \"turn 90\"]",
        "expect.atoms = [\"go 20 0\"]",
        "expect.atoms = [\"go 20 0\", \"go 5 0\", \"turn 90\", \"go 5 0\"]",
        "expect.order = [\"go 20 0\", \"turn 90\", \"go 5 0\"]",
        "expect.transitions = [{ from = \"go 20 0\", by = \"wait 20s\" }]",
        "expect.transitions = [{ from = \"go 20 0\", to = \"Shake\", by = \"r0 < 0.6\", within = \"2s\" }]",
        "expect.never = [\"turn 90\"]",
        "expect.never = [\"Shake while r0 < 60cm\"]",
        "expect.end = \"wait 15s\"",
        "expect.end = \"completed\"",
        "expect.end = \"running\"",
        "expect.most-turns = 3\nexpect.most-transitions = 2\nexpect.most-time = \"3s\"",
    ];
    let reports = expectations.map(|expected| of_one("failures", &format!("{script}{expected}\n")));
    assert!(reports.iter().all(|report| report.ends_with("[1]\n")));
    insta::assert_snapshot!(reports.join("\n"));
    let good = "expect.atoms = [\"go 20cm/s 0\", \"Shake\", \"turn 90deg\"]\nexpect.end = \"bumper\"\n\
                expect.transitions = [{ from = \"Shake\", to = \"end\", by = \"Dock\", within = \"4s\" }]\n\
                expect.never = [\"go 20 0 while bumper\", \"r0 < 60cm AND bumper\"]\n";
    let good = of_one("met", &format!("{script}{good}"));
    assert!(good.ends_with("1 passed\n[0]\n"), "{good}");
}

#[test]
fn runs_in_the_simulator_fail_with_commands() {
    let tests = "[[test]]
name = \"too close\"
world = \"room\"
start = \"0.7,0.7,0\"
body = \"scout\"
seed = 3
seeds = 4
expect.never = [\"closer than 1 m\"]
expect.end = \"wait 15s\"
expect.pose = \"1,1,10cm,0,5\"

[[test]]
name = \"faults\"
world = \"room\"
faults = [{ fault = \"sonar\", sonar = 0, range = \"30cm\", from = \"2s\" }, { fault = \"robot\", from = \"9s\" }]
expect.transitions = [{ by = \"r0 < 60cm\", within = \"2s\" }]

[[test]]
name = \"a fault that is expected\"
world = \"room\"
faults = [{ fault = \"robot\", from = \"1s\" }]
expect.end = \"failed\"
";
    let folder = with("simulated", DOCK, tests);
    insta::assert_snapshot!(report(&folder, &[]));
    let again = report(&folder, &["dock.test.toml", "--test", "too close", "--seed", "4", "--seeds", "1"]);
    assert!(
        again.contains("error: too close, seed 4: the robot came too close") && again.ends_with("[1]\n"),
        "{again}"
    );
    let by_jobs = ["1", "7"].map(|jobs| report(&folder, &["--jobs", jobs]).replace(&format!("--jobs {jobs}"), ""));
    assert_eq!(by_jobs[0], by_jobs[1]);
}

#[test]
fn a_run_is_that_of_mdle_run() {
    let test = "world = \"room\"\nstart = \"0.7,0.7,20\"\nbody = \"scout\"\nseed = 5\nexpect.end = \"wait 15s\"\n";
    let folder = with("same_run", DOCK, &format!("[[test]]\nname = \"one\"\n{test}"));
    let tested = report(&folder, &[]);
    let why = tested.lines().find_map(|line| line.trim().strip_prefix("= why: mdle ")).expect(&tested);
    let why = why.replace(" --log failed.mcap", "");
    let ran = Command::new(mdle()).args(why.split(' ')).current_dir(&folder).output().unwrap();
    let ran = String::from_utf8(ran.stdout).unwrap();
    let last = ran.lines().last().unwrap();
    let (time, cause) = last.split_once(" s  plan over: ").unwrap();
    assert!(tested.contains(&format!("it ended at {time} s by {cause}")), "{last}\n{tested}");
}

#[test]
fn a_test_has_the_modules_of_its_plan() {
    let plan = "{ Near (bumper OR wait 5s OR range(ears module) < 50cm)\n  (Atom (null) (go 20 0))\n}\n";
    let test = "[[test]]\nname = \"one\"\nworld = \"hall\"\nexpect.end = \"range(ears module) < 50cm\"\nexpect.most-time = \"2s\"\n";
    let folder = with("test_modules", plan, test);
    let ears = "echo '{\"publishes\": {\"range\": \"m\"}}'; while read line; do echo '{\"range\": 0.3}'; done";
    fs::write(folder.join("mdle.toml"), format!("target = \"sim\"\n\n[modules]\nears = \"\"\"{ears}\"\"\"\n")).unwrap();
    let tested = report(&folder, &[]);
    assert!(tested.contains("1 passed"), "{tested}");
    fs::write(folder.join("mdle.toml"), "target = \"sim\"\n\n[modules]\nsensors = \"true\"\n").unwrap();
    let tested = report(&folder, &[]);
    assert!(tested.contains("mdle.toml:4: a module `sensors` is loaded already"), "{tested}");
}

#[test]
fn a_script_has_the_words_of_a_group() {
    let plan = "{ Group [a b] Pair (any bumper OR wait 20)\n  (Atom (all rendezvous) stop)\n  (Atom (a.x > 10cm) (go 20 0))\n}\n";
    let test = "name = \"Pair_a\"\n[[test]]\nname = \"meets\"\nscript = [{ t = 0 }, { t = 1, fired = [\"all rendezvous\"] }, \
                { t = 2, fired = [\"a.x > 10cm\"] }, { t = 4.5 }]\nexpect.end = \"wait 2s\"\n[[test]]\nname = \"touches\"\n\
                script = [{ t = 0 }, { t = 1, fired = [\"any bumper\"] }, { t = 4.5 }]\n\
                expect.transitions = [{ by = \"any bumper\" }]\nexpect.end = \"wait 2s\"\n";
    let tested = report(&with("test_group", plan, test), &[]);
    assert!(tested.contains("2 passed"), "{tested}");
}

#[test]
fn a_refused_module_is_loaded_once() {
    let plan = "{ Near (bumper OR wait 5s OR range(ears module) < 50cm)\n  (Atom (null) (go 20 0))\n}\n";
    let test = "[[test]]\nname = \"one\"\nworld = \"hall\"\nseeds = 9\nexpect.end = \"wait 5s\"\n";
    let folder = with("test_refused_module", plan, test);
    let starts = folder.join("starts");
    let ears = format!("echo one >> '{}'; exec false", starts.display());
    fs::write(folder.join("mdle.toml"), format!("target = \"sim\"\n\n[modules]\nears = \"\"\"{ears}\"\"\"\n")).unwrap();
    let tested = report(&folder, &["--jobs", "1"]);
    let sentence =
        "the run could not be made: module `ears` cannot be loaded: its process has ended (exit status: 1)\n";
    assert!(tested.contains(sentence) && tested.contains("9 of 9 seeds failed"), "{tested}");
    assert_eq!(fs::read_to_string(starts).unwrap(), "one\n");
}

#[test]
fn faulty_files_of_tests_have_a_help() {
    let tests = [
        "wrold = \"room\"",
        "expect.nevr = []",
        "expect.never",
        "expect.atoms = [\"go 20 1\"]",
        "expect.order = [\"Shak\"]",
        "expect.end = \"bumber\"",
        "expect.end = \"wait 20s\"",
        "expect.never = [\"rubbish\"]",
        "expect.never = [\"turn 90 while RISING bumper\"]",
        "expect.never = [\"closer than 10 s\"]",
        "expect.transitions = [{ by = \"r0 < 60m\", within = \"2s\" }]",
        "expect.transitions = [{ after = \"3s\", within = \"2s\" }]",
        "expect.pose = \"1,1\"",
        "world = \"moon\"",
        "world = \"room\"\nstart = \"0,0,0\"",
        "body = \"tank\"",
        "seeds = 0",
        "seeds = -2",
        "world = \"room\"\nstart-noise = \"0.1,5\"",
        "battery = 1.5",
        "faults = [{ fault = \"bumber\" }]",
        "faults = [{ fault = \"sonar\", sonar = 16, range = \"1m\" }]",
        "faults = [{ fault = \"battery\" }]",
        "faults = [{ fault = \"bumper\", from = \"2s\", until = \"1s\" }]",
        "script = []",
        "script = [{ t = 0 }, { t = 1, fired = [\"bumber\"] }]",
        "script = [{ t = 1 }, { t = 0 }]",
        "script = [{ t = 0 }, { t = 1, completed = [\"go 20 0\"] }]",
        "script = [{ t = 0 }]\nworld = \"room\"",
        "script = [{ t = 0 }]\nexpect.never = [\"closer than 1m\"]",
        "script = [{ t = 0 }]\nexpect.pose = \"1,1,1\"",
        "[[test]]\nname = \"one\"",
        "world = \"room\"",
        "expect.never = []\nexpect.order = []\nexpect.transitions = []",
        "expect.most-turns = 0",
        "expect.transitions = [{}]",
        "expect.transitions = [{ from = \"go 20 0\", to = \"turn 90\" }]",
        "expect.transitions = [{ from = \"turn 90\", by = \"r0 < 60cm\" }]",
        "expect.transitions = [{ to = \"end\", by = \"wait 20s\", within = \"9s\" }]",
        "expect.transitions = [{ to = \"go 20 0\" }]",
        "expect.order = [\"Shake\", \"go 20 0\"]",
        "expect.atoms = [\"go 20 0\", \"turn 90\", \"turn 90\", \"go 20 0\"]",
    ];
    let reports = tests.map(|test| of_one("refused", &format!("{test}\n")));
    assert!(reports.iter().all(|report| report.ends_with("[2]\n")), "{}", reports.join("\n"));
    insta::assert_snapshot!(reports.join("\n"));
}

/// A message about a plan's name, its file or a target that does not exist names the line in the test file.
#[test]
fn what_tests_name_in_vain_has_its_place() {
    let heads = ["plan = \"nix.mdle\"", "plan = \".\"", "name = \"Dokc\"", "target = \"smi\"", "target = \"../robot\""];
    let reports = heads.map(|head| {
        let test = "[[test]]\nname = \"one\"\nexpect.end = \"bumper\"\n";
        report(&with("places", DOCK, &format!("# Of a plan.\n{head}\n{test}")), &[])
    });
    assert!(reports.iter().all(|report| report.ends_with("[2]\n")), "{}", reports.join("\n"));
    insta::assert_snapshot!(reports.join("\n"));
}

/// The time of a fault is the time of the turn in which the robot does not answer.
#[test]
fn a_fault_has_the_time_of_its_turn() {
    let fault = "faults = [{ fault = \"robot\", from = \"2s\" }]";
    let text = of_one("fault-time", &format!("world = \"room\"\n{fault}\nexpect.end = \"running\"\n"));
    assert!(text.contains("one (20 turns, a fault at 2.0 s)"), "{text}");
}

#[test]
fn files_that_are_not_there_are_named() {
    let folder = with("files", DOCK, "[[test]]\nname = \"one\"\nscript = [{ t = 0 }]\nexpect.end = \"running\"\n");
    fs::create_dir_all(folder.join("empty")).unwrap();
    fs::write(folder.join("lost.test.toml"), "[[test]]\nname = \"one\"\n").unwrap();
    fs::write(folder.join("bad.mdle"), "{ P (bumber) (Atom (null) stop) }\n").unwrap();
    fs::write(folder.join("bad.test.toml"), "[[test]]\nname = \"one\"\n").unwrap();
    fs::write(folder.join("scout.test.toml"), "plan = \"dock.mdle\"\ntarget = \"scout\"\n[[test]]\nname = \"one\"\n")
        .unwrap();
    let calls: [&[&str]; 12] = [
        &["dock.mdle"],
        &["dock.test.toml", "dock.mdle"],
        &["missing.mdle"],
        &["empty"],
        &["lost.test.toml"],
        &["bad.mdle"],
        &["bad.mdle", "dock.mdle"],
        &["scout.test.toml"],
        &["dock.mdle", "--test", "on"],
        &["dock.mdle", "--seeds", "0"],
        &["dock.mdle", "--seeds", "-2"],
        &["dock.mdle", "--jobs", "-1"],
    ];
    insta::assert_snapshot!(calls.map(|call| report(&folder, call)).join("\n"));
}
