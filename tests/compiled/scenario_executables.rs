//! Tests executables of scenarios: `mdlec SCENARIO.toml --target sim` builds a program that needs no other file and
//! behaves like `mdle run SCENARIO.toml`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdle_tests::elf::sections;
use mdle_tests::executable::{folder, mdle, run_mdlec};

/// Robots that refer to files of every kind: a world, plans that use a plan, a path that is replayed and recorded, and
/// a plan that is sent.
const SCENARIO: &str = "world = \"square.toml\"
seed = 3
timeout = \"20s\"

[link]
latency = \"0ms..300ms\"
loss = 0.3

[[robot]]
name = \"ada\"
file = \"plans/meet.mdle\"
plan = \"Ada\"
start = \"0, 0, 0\"
start-noise = \"0.02, 0.5\"
body = \"scout\"
paths = \"ways\"
records = \"lane\"

[[robot]]
name = \"bob\"
file = \"plans/meet.mdle\"
plan = \"Bob\"
start = \"1.5, 1, 90\"
body = \"atrv\"
plans-from = [\"ada\"]

[[sent-plan]]
at = \"9s\"
from = \"ada\"
to = \"bob\"
file = \"sent.mdle\"
";

/// Files of the scenario, each with its path in the scenario's folder and its text.
const FILES: [(&str, &str); 7] = [
    ("two.toml", SCENARIO),
    ("square.toml", "[[wall]]\npoints = [[-3, -3], [5, -3], [5, 3], [-3, 3], [-3, -3]]\n"),
    (
        "plans/meet.mdle",
        "use \"../shared/ahead.mdle\"\n\
         use \"turned.mdle\"\n\
         { Ada (bumper OR wait 15s) (Atom (null) path(lane)) (Atom (rendezvous bob OR wait 2) stop) Turned Ahead }\n\
         { Bob (bumper OR wait 15s) (Atom (wait 2) (go 10 0)) (Atom (rendezvous ada) stop) Ahead }\n",
    ),
    // Both files use `turned.mdle`, by different paths.
    (
        "shared/ahead.mdle",
        "use \"../plans/../plans/turned.mdle\"\n\
         { Ahead (null) ((Atom (r0 < 60cm OR wait 2) (go 20 0)) Turned)^inf }\n",
    ),
    ("plans/turned.mdle", "{ Turned (Atom (null) turn 90) }\n"),
    ("ways/lane.csv", "time s, heading deg, speed cm/s\n0, 0, 0\n0.5, 5, 20\n1.5, -5, 20\n2, 0, 0\n"),
    ("sent.mdle", "{ Sent (wait 4) (Atom (null) go(-5 0.2)) }\n"),
];

/// Returns a folder that contains the scenario in the folder `scenes`.
fn prepared(test: &str) -> PathBuf {
    let folder = folder(test);
    for (name, text) in FILES {
        let file = folder.join("scenes").join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    folder
}

/// Standard output, standard error and exit status of a program.
type Outcome = (String, String, Option<i32>);

/// Runs a program under the name `mdle` with these arguments.
fn run(program: &Path, folder: &Path, arguments: &str) -> Outcome {
    let mut command = Command::new(program);
    let arguments = arguments.split(' ');
    let output = command.arg0("mdle").args(arguments).current_dir(folder).env_clear().output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code())
}

/// Runs `mdlec` with these arguments. Returns its messages and its exit status.
fn built(folder: &Path, arguments: &str) -> (String, Option<i32>) {
    let output = run_mdlec(folder, &arguments.split(' ').collect::<Vec<_>>());
    (String::from_utf8(output.stderr).unwrap(), output.status.code())
}

/// Returns the contents of all files in a folder and its subfolders.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = PathBuf::from(path.file_name().unwrap());
        if path.is_dir() {
            files.extend(contents(&path).into_iter().map(|(file, bytes)| (name.join(file), bytes)));
        } else {
            files.insert(name, fs::read(path).unwrap());
        }
    }
    files
}

/// Builds the executable of a scenario, and moves it away from the scenario's files. Returns its path, and an empty
/// folder to run it in.
fn alone(folder: &Path, scenario: &str) -> (PathBuf, PathBuf) {
    let (messages, status) = built(folder, &format!("{scenario} --target sim -o program"));
    assert_eq!(status, Some(0), "{messages}");
    let empty = folder.join("elsewhere/empty");
    fs::create_dir_all(&empty).unwrap();
    fs::rename(folder.join("program"), folder.join("elsewhere/program")).unwrap();
    (folder.join("elsewhere/program"), empty)
}

#[test]
fn the_program_does_what_mdle_run_does() {
    let folder = prepared("same");
    let (program, empty) = alone(&folder, "scenes/two.toml");
    let sections = sections(&fs::read(&program).unwrap());
    assert!(sections.iter().all(|(name, _)| name != ".interp"), "it needs a dynamic loader: {sections:?}");
    let whole = "--log log.mcap --trail trail.csv --plot plot.svg --trips trips.svg";
    let cases = [
        (format!("{whole} --seed 7 --recorded-paths paths"), 6),
        (format!("{whole} --timeout 3s"), 5),
        ("--log log.jsonl".to_owned(), 1),
        ("--plot no/such.svg".to_owned(), 0),
        ("--seed x".to_owned(), 0),
    ];
    for (number, (options, count)) in cases.into_iter().enumerate() {
        let [own, others] = [empty.join(number.to_string()), folder.join(format!("mdle-{number}"))];
        fs::create_dir(&own).unwrap();
        fs::create_dir(&others).unwrap();
        let outcome = run(&program, &own, &options);
        symlink(folder.join("scenes"), others.join("scenes")).unwrap();
        let expected = run(mdle(), &others, &format!("run scenes/two.toml {options}"));
        fs::remove_file(others.join("scenes")).unwrap();
        let without_usage = |(out, err, status): Outcome| {
            let err: Vec<String> = err.lines().filter(|line| !line.starts_with("Usage: ")).map(str::to_owned).collect();
            (out, err, status)
        };
        assert_eq!(without_usage(outcome), without_usage(expected), "{options}");
        let (made, wanted) = (contents(&own), contents(&others));
        assert_eq!(made.keys().collect::<Vec<_>>(), wanted.keys().collect::<Vec<_>>(), "{options}");
        let different: Vec<_> = made.keys().filter(|file| made[*file] != wanted[*file]).collect();
        assert!(different.is_empty() && made.len() == count, "{options}: {different:?} of {}", made.len());
    }
    let (help, _, status) = run(&program, &empty, "--help");
    assert!(help.contains("Usage: two [OPTIONS]\n") && help.contains("--trips <FILE.svg>"), "{help}");
    assert_eq!(status, Some(0));
    let (version, _, _) = run(&program, &empty, "--version");
    assert!(version.starts_with("two (text ") && version.contains(", target sim, alphabet "), "{version}");
    let (_, err, status) = run(&program, &empty, "--target scout");
    assert_eq!(err, "error: --target is for one robot, and a scenario names the plan of each\nhelp: leave it out\n");
    assert_eq!(status, Some(2));
}

#[test]
fn what_no_scenario_takes_is_refused() {
    let folder = prepared("refused");
    let scenario = folder.join("scenes/two.toml");
    let write = |text: &str| fs::write(&scenario, text).unwrap();
    let mut messages = String::new();
    let mut refuse = |arguments: &str, wanted: i32| {
        let (message, status) = built(&folder, arguments);
        assert_eq!(status, Some(wanted), "{arguments}: {message}");
        messages += &format!("$ mdlec {arguments}\n{message}");
    };
    refuse("scenes/two.toml", 2);
    refuse("scenes/two.toml --target scout", 2);
    refuse("scenes/two.toml --target sim --plan Ada", 2);
    refuse("scenes/two.toml --target sim --deny-warnings", 2);
    refuse("scenes/two.toml --target sim --message-format json", 2);
    refuse("scenes/two.toml --target sim --emit rust", 2);
    refuse("scenes/two.toml --target sim -o scenes/ways/lane.csv", 2);
    refuse("check scenes/two.toml --target all", 2);
    refuse("check scenes/two.toml", 0);
    write(&SCENARIO.replace("square.toml", "squire.toml"));
    refuse("scenes/two.toml --target sim", 2);
    refuse("check scenes/two.toml", 2);
    write(&SCENARIO.replace("sent.mdle", "/dev/zero"));
    refuse("scenes/two.toml --target sim", 2);
    write(SCENARIO);
    fs::write(folder.join("scenes/plans/turned.mdle"), "{ Turned (Atom (wait 1) go) }\n").unwrap();
    refuse("scenes/two.toml --target sim", 1);
    refuse("check scenes/two.toml scenes/sent.mdle", 1);
    refuse("missing.toml --target sim", 2);
    insta::assert_snapshot!(messages);
    assert!(!folder.join("two").exists(), "nothing is built");
}
