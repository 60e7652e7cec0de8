//! Several runs of a plan by the executable that `mdlec` builds: what is said of them, and that it is true.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use mdle_tests::executable::{folder, run_mdlec};
use serde_json::Value;

/// A metre ahead in five seconds; whether that is where one wants to be, and what is in the way, the start decides.
const PLAN: &str = "{ Ahead (bumper) (Atom (wait 5) (go 20 0)) }\n";
const WORLD: &str = "goal = { min = [0.7, -0.3], max = [1.3, 0.3] }\n\
                     [[wall]]\nname = \"left\"\npoints = [[0.2, 0.65], [1.5, 0.65]]\n";

/// The executable, built once, beside its world.
fn ahead() -> &'static Path {
    static AHEAD: OnceLock<PathBuf> = OnceLock::new();
    AHEAD.get_or_init(|| {
        let folder = folder("batches");
        fs::write(folder.join("ahead.mdle"), PLAN).unwrap();
        fs::write(folder.join("one wall.toml"), WORLD).unwrap();
        let output = run_mdlec(&folder, &["ahead.mdle", "--target", "sim"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        folder
    })
}

fn run(options: &[&str]) -> Output {
    Command::new("./ahead").args(["--world", "one wall.toml"]).args(options).current_dir(ahead()).output().unwrap()
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap()
}

/// Starts so far off that runs end in every way there is.
const OFF: [&str; 6] = ["--runs", "40", "--start-noise", "0.1,50", "--seed", "7"];

#[test]
fn what_is_said_does_not_depend_on_the_number_of_jobs() {
    for form in [&[][..], &["--json"]] {
        let said = |jobs| {
            let output = run(&[&OFF[..], form, &["--jobs", jobs]].concat());
            assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(1), &b""[..]));
            text(output.stdout)
        };
        let once = said("1");
        assert!(once == said("2") && once == said("7"), "{once}");
        let starts =
            if form.is_empty() { "40 runs, seeds 7 to 46: " } else { "{\"runs\":40,\"done\":40,\"first_seed\":7," };
        assert!(once.starts_with(starts), "{once}");
    }
}

#[test]
fn each_run_told_is_the_run_that_its_command_makes() {
    let output = run(&[&OFF[..], &["--json"]].concat());
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let each = summary["each"].as_array().unwrap();
    let count = |outcome: &str| each.iter().filter(|run| run["outcome"] == outcome).count() as u64;
    for outcome in ["arrived", "bumped", "astray", "timed_out", "failed"] {
        assert_eq!(summary[outcome], count(outcome), "{outcome}");
    }
    assert!(count("arrived") > 5 && count("bumped") > 3 && count("astray") > 3, "{summary}");
    assert_eq!(each.iter().map(|run| run["seed"].as_u64().unwrap()).collect::<Vec<_>>(), (7..47).collect::<Vec<_>>());
    for run in each.iter().filter(|run| run["outcome"] != "arrived") {
        let log = format!("seed{}.jsonl", run["seed"]);
        let command = format!("{} --log {log}", run["command"].as_str().unwrap());
        let alone = Command::new("sh").args(["-c", &command]).current_dir(ahead()).output().unwrap();
        let told = text(alone.stdout);
        let (_, cause) = told.split_once(" s  plan over: ").expect("an end");
        assert_eq!(cause.trim_end(), run["cause"].as_str().unwrap(), "{command}");
        let log = fs::read_to_string(ahead().join(log)).unwrap();
        let last: Value = serde_json::from_str(log.lines().last().unwrap()).unwrap();
        assert_eq!(last["t"], run["t"], "{command}");
        assert_eq!(run["outcome"] == "bumped", run["by"] == "bumper", "{run}");
    }
}

#[test]
fn the_status_is_0_only_if_all_arrive() {
    let output = run(&["--runs", "6"]);
    assert_eq!(output.status.code(), Some(0));
    insta::assert_snapshot!(text(output.stdout), @"
    6 runs, seeds 1 to 6: 6 arrived
    time to arrive: median 5.0 s, worst 5.0 s (seed 1)
    ");
    let output = run(&["--runs", "2", "--turns", "20", "--start=-0.5,0,0", "--seed", "3"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!(text(output.stdout), @"
    2 runs, seeds 3 to 4: 0 arrived, 2 timed out

    seed 3: timed out at 1.9 s
      ./ahead --world 'one wall.toml' --turns 20 --start=-0.5,0,0 --seed 3 --speed max

    seed 4: timed out at 1.9 s
      ./ahead --world 'one wall.toml' --turns 20 --start=-0.5,0,0 --seed 4 --speed max
    ");
}

#[test]
fn options_that_contradict_each_other_are_refused() {
    let cases: [&[&str]; 12] = [
        &["--runs", "3", "--plot", "x.svg"],
        &["--runs", "3", "--record", "x.svg"],
        &["--runs", "3", "--trail", "x.csv"],
        &["--runs", "3", "--watch"],
        &["--runs", "3", "--log", "x.jsonl"],
        &["--runs", "3", "--speed", "10"],
        &["--runs", "0"],
        &["--runs", "3", "--jobs", "0"],
        &["--runs", "3", "--seed", "18446744073709551614"],
        &["--json"],
        &["--start-noise", "0.1,5"],
        &["--runs", "3", "--start-noise", "0.1"],
    ];
    let mut said = String::new();
    for options in cases {
        let output = run(options);
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{options:?}");
        said += &format!("$ ./ahead {}\n{}\n", options.join(" "), text(output.stderr));
    }
    insta::assert_snapshot!(said);
    assert!(fs::read_dir(ahead()).unwrap().all(|file| !file.unwrap().file_name().to_string_lossy().starts_with('x')));
}
