//! Tests modules and plans that read attributes that are misspelt, of another type, or late.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

/// Returns a folder with a plan that reads `range` of the module `ears`, and a plan that reads no module.
fn with_plans(test: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("near.mdle"), "{ Near (bumper)\n  (Atom (range(ears module) < 50cm) stop)\n}\n").unwrap();
    fs::write(folder.join("stand.mdle"), "{ Stand (bumper)\n  (Atom (wait 1s) stop)\n}\n").unwrap();
    folder
}

/// Runs a plan with the module `ears` in simulated time. Returns standard output, standard error and the exit status.
fn report(folder: &Path, plan: &str, ears: &str) -> String {
    let mut command = Command::new(mdle());
    command.args(["run", plan, "--target", "sim", "--world", "hall", "--speed", "max", "--module"]);
    let Output { status, stdout, stderr } = command.arg(format!("ears={ears}")).current_dir(folder).output().unwrap();
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}{err}[{}]\n", status.code().unwrap())
}

/// Returns the command of a process with this declaration that publishes no values.
fn silent(declaration: &str) -> String {
    format!("echo '{declaration}'; while read line; do echo '{{}}'; done")
}

/// Returns the command of a process that takes `seconds` for each answer. `latency` is a part of its declaration.
fn slow(seconds: f64, latency: &str) -> String {
    format!(
        "echo '{{\"publishes\": {{\"range\": \"m\"}}{latency}}}'; while read line; do sleep {seconds}; \
         echo '{{\"range\": 0.3}}'; done"
    )
}

#[test]
fn what_a_module_reads_in_vain_is_reported_once() {
    let folder = with_plans("reads_in_vain");
    let reads = [
        r#"{"sensor/r0": "m"}"#,
        r#"{"sensors/rO": "m", "sensors/x": "m"}"#,
        r#"{"gps/latitude": "deg", "sensors/yy": "m"}"#,
        r#"{"sensors/r0": "m"}"#,
    ];
    let reports = reads.map(|reads| report(&folder, "stand.mdle", &silent(&format!("{{\"reads\": {reads}}}"))));
    insta::assert_snapshot!(reports.join("\n"), @"
    1.0 s  plan over: wait 1s (stand.mdle:2)
    warning: module `ears` reads /usr/sensor/r0, which no module publishes; did you mean /usr/sensors/r0?
    [0]

    1.0 s  plan over: wait 1s (stand.mdle:2)
    warning: module `ears` reads /usr/sensors/rO, which no module publishes; did you mean /usr/sensors/r0?
    [0]

    1.0 s  plan over: wait 1s (stand.mdle:2)
    warning: module `ears` reads /usr/gps/latitude, /usr/sensors/yy, which no module publishes; did you mean /usr/sensors/y?
    [0]

    1.0 s  plan over: wait 1s (stand.mdle:2)
    [0]
    ");
}

#[test]
fn a_plan_is_refused_if_a_module_publishes_another_kind() {
    let folder = with_plans("reads_other_kind");
    let report = report(&folder, "near.mdle", &silent(r#"{"publishes": {"range": "deg"}}"#));
    assert_eq!(report, "error: the plan reads /usr/ears/range in m, and it is an angle\n[2]\n");
}

#[test]
fn a_plan_waits_as_long_as_a_module_declares() {
    let folder = with_plans("reads_late");
    let over = "3.1 s  plan over: range(ears module) = 0.3 m < 50cm (near.mdle:2)\n[0]\n";
    assert_eq!(report(&folder, "near.mdle", &slow(0.0, ", \"latency\": 3")), over);
    assert_eq!(report(&folder, "near.mdle", &slow(1.5, ", \"latency\": 3")), over, "time of this computer");
    let silent = report(&folder, "near.mdle", &silent(r#"{"publishes": {"range": "m"}, "latency": 3}"#));
    assert!(
        silent.contains("which no module has published within 5 s\nhelp: a module in the background that needs longer"),
        "{silent}"
    );
}

#[test]
fn the_tree_shows_what_is_read_and_why() {
    let folder = with_plans("reads_in_the_tree");
    fs::write(folder.join("rules.toml"), "[guards.near]\nwhen = \"range(ears module) < 10cm\"\nthen = \"hold\"\n")
        .unwrap();
    let commands = "load_plan near.mdle\nload_plan { Back (bumper)\n(Atom (x < 1m) (go -10 0)) }\n\
                    load_plan { Back (bumper) (Atom (x < 1m) (go -10 0)) }\nload_plan near.mdle stand.mdle\n\
                    get /plans/Near/reads\nget /plans/Back/text\nget /usr/mdle/main\n\
                    get /usr/ears/.reads\nget /usr/ears/.priority\nget /usr/ears/.fault\n\
                    get /safety/rules/near/when\nget /safety/rules/near/then\nls /safety/rules/speed\n\
                    step 5\nget /usr/ears/.state\nget /usr/ears/.fault\n";
    fs::write(folder.join("commands.txt"), commands).unwrap();
    let ears = "ears=echo '{\"publishes\": {\"range\": \"m\"}, \"reads\": {\"sensors/r0\": \"m\"}}'; read line; \
                echo '{\"range\": 0.3}'; read line; exit 3";
    let mut command = Command::new(mdle());
    command.args(["shell", "stand.mdle", "--target", "sim", "--world", "hall", "--speed", "max", "--paused", "-x"]);
    command.args(["--safety", "rules.toml", "--module", ears, "-c", "commands.txt"]).current_dir(&folder);
    let Output { status, stdout, stderr } = command.output().unwrap();
    let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    insta::assert_snapshot!(format!("{out}---\n{err}[{}]\n", status.code().unwrap()));
}
