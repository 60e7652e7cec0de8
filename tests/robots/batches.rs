//! Tests batches, several runs of a plan by the executable that `mdlec` builds: the summary, and that it is correct.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use mdle_tests::executable::{folder, run_mdlec};
use serde_json::Value;

/// A plan that drives a metre ahead in five seconds. The start determines whether the robot reaches the goal, and which
/// obstacles are in its way.
const PLAN: &str = "{ Ahead (bumper) (Atom (wait 5) (go 20 0)) }\n";
const WORLD: &str = "goal = { min = [0.7, -0.3], max = [1.3, 0.3] }\n\
                     [[wall]]\nname = \"left\"\npoints = [[0.2, 0.65], [1.5, 0.65]]\n";

/// Returns the folder of the executable, which is built once, and of its world.
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

/// Options with a random offset of the start that is large enough for runs to end in every possible way.
const OFF: [&str; 8] = ["--goal", "world", "--runs", "40", "--start-noise", "0.1,50", "--seed", "7"];

#[test]
fn the_number_of_jobs_changes_no_output() {
    for form in [&[][..], &["--json"]] {
        let message = |jobs| {
            let output = run(&[&OFF[..], form, &["--jobs", jobs]].concat());
            assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(1), &b""[..]));
            text(output.stdout)
        };
        let once = message("1");
        assert!(once == message("2") && once == message("7"), "{once}");
        let starts =
            if form.is_empty() { "40 runs, seeds 7 to 46: " } else { "{\"runs\":40,\"done\":40,\"first_seed\":7," };
        assert!(once.starts_with(starts), "{once}");
    }
}

#[test]
fn each_runs_command_repeats_it() {
    let output = run(&[&OFF[..], &["--json"]].concat());
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let each = summary["each"].as_array().unwrap();
    let count = |outcome: &str| each.iter().filter(|run| run["outcome"] == outcome).count() as u64;
    for outcome in ["ended", "arrived", "bumped", "astray", "ended_otherwise", "timed_out", "failed"] {
        assert_eq!(summary[outcome], count(outcome), "{outcome}");
    }
    assert!(count("arrived") > 5 && count("bumped") > 3 && count("astray") > 3, "{summary}");
    assert_eq!(each.iter().map(|run| run["seed"].as_u64().unwrap()).collect::<Vec<_>>(), (7..47).collect::<Vec<_>>());
    for run in each {
        let log = format!("seed{}.jsonl", run["seed"]);
        let command = format!("{} --log {log}", run["command"].as_str().unwrap());
        let alone = Command::new("sh").args(["-c", &command]).current_dir(ahead()).output().unwrap();
        let report = text(alone.stdout);
        let (_, end) = report.split_once(" s  plan over: ").expect("an end");
        let outcome = match run["outcome"].as_str().unwrap() {
            "astray" => format!("astray at {}", run["said"].as_str().unwrap()),
            outcome => outcome.to_owned(),
        };
        assert_eq!(end, format!("{}\n{outcome}\n", run["cause"].as_str().unwrap()), "{command}");
        assert_eq!(alone.status.code(), Some(if outcome == "arrived" { 0 } else { 5 }), "{command}");
        let log = fs::read_to_string(ahead().join(log)).unwrap();
        let last: Value = serde_json::from_str(log.lines().last().unwrap()).unwrap();
        assert_eq!(last["t"], run["t"], "{command}");
        assert_eq!(run["outcome"] == "bumped", run["by"] == "bumper", "{run}");
    }
}

#[test]
fn the_status_is_0_only_if_all_arrive() {
    let output = run(&["--runs", "6", "--goal", "world"]);
    assert_eq!(output.status.code(), Some(0));
    insta::assert_snapshot!(text(output.stdout), @"
    6 runs, seeds 1 to 6: 6 arrived
    time to arrive: median 5.0 s, worst 5.0 s (seed 1)
    ");
    let output = run(&["--runs", "2", "--turns", "20", "--start=-0.5,0,0", "--seed", "3"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!(text(output.stdout), @"
    2 runs, seeds 3 to 4: 2 timed out

    2 timed out; the first is seed 3 at 1.9 s
      ./ahead --world 'one wall.toml' --turns 20 --start=-0.5,0,0 --seed 3 --speed max
    ");
}

#[test]
fn without_a_goal_runs_are_grouped_by_their_cause() {
    let output = run(&OFF[2..]);
    assert_eq!(output.status.code(), Some(0));
    let summary = text(output.stdout);
    insta::assert_snapshot!(summary, @"
    40 runs, seeds 7 to 46: 40 ended
    time: median 5.0 s, worst 5.0 s (seed 7)
    9 contacts in 9 runs

    31 ended by wait 5 (ahead.mdle:1); the first is seed 7 at 5.0 s
      ./ahead --world 'one wall.toml' --start-noise 0.1,50 --seed 7 --speed max

    9 ended by bumper (ahead.mdle:1); the first is seed 9 at 4.2 s
      ./ahead --world 'one wall.toml' --start-noise 0.1,50 --seed 9 --speed max
    ");
    let lines: Vec<&str> = summary.lines().filter(|line| line.starts_with("  ./ahead")).collect();
    assert_eq!(lines.len(), 2, "{summary}");
    let output = run(&[&OFF[2..], &["--require", "wait 5s"]].concat());
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!(text(output.stdout), @"
    40 runs, seeds 7 to 46: 31 ended, 9 ended otherwise
    time: median 5.0 s, worst 5.0 s (seed 7)
    9 contacts in 9 runs

    31 ended by wait 5 (ahead.mdle:1); the first is seed 7 at 5.0 s
      ./ahead --world 'one wall.toml' --start-noise 0.1,50 --require 'wait 5s' --seed 7 --speed max

    9 ended otherwise, plan over: bumper (ahead.mdle:1); the first is seed 9 at 4.2 s
      ./ahead --world 'one wall.toml' --start-noise 0.1,50 --require 'wait 5s' --seed 9 --speed max
    ");
}

/// Returns the output of a single run at maximum speed, and its exit status.
fn alone(options: &[&str]) -> String {
    let output = run(&[&["--speed", "max"], options].concat());
    let [out, err] = [output.stdout, output.stderr].map(text);
    format!("$ ./ahead {}\n{out}{err}[{}]\n", options.join(" "), output.status.code().unwrap())
}

#[test]
fn a_goal_judges_a_run_only_if_asked() {
    let cases: [&[&str]; 8] = [
        &["--start", "5,5,0"],
        &["--start", "5,5,0", "--goal", "world"],
        &["--goal", "world"],
        &["--start", "0,0.3,20", "--goal", "world"],
        &["--start", "5,5,0", "--goal", "600cm,5,0.1"],
        &["--start", "5,5,0", "--goal", "6,5,0.1,10deg,11"],
        &["--start", "5,5,0", "--goal", "6,5,0.1,90,15"],
        &["--start=-5,5,0", "--goal=-4,5,10cm", "--require", "completed"],
    ];
    insta::assert_snapshot!(cases.map(alone).concat());
}

#[test]
fn a_goal_that_cannot_be_is_refused() {
    let cases: [&[&str]; 5] = [
        &["--goal", "wrold"],
        &["--goal", "1,2"],
        &["--goal", "1,2,3kg"],
        &["--goal", "1,2,0.5,90,200"],
        &["--world", "hall", "--goal", "world"],
    ];
    let refused = cases.map(|options| {
        let options = [options, &["--speed", "max"]].concat();
        let output = Command::new("./ahead").args(&options).current_dir(ahead()).output().unwrap();
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{options:?}");
        text(output.stderr)
    });
    insta::assert_snapshot!(refused.concat());
}

#[test]
fn a_picture_shows_the_goal_that_judges() {
    let plot = |options: &[&str]| {
        let output = run(&[&["--speed", "max", "--plot", "goal.svg"], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(output.stderr));
        fs::read_to_string(ahead().join("goal.svg")).unwrap()
    };
    let goals = |svg: &str, shape: &str| {
        svg.lines().filter(|line| line.starts_with(&format!("<{shape} ")) && line.contains("class=\"goal\"")).count()
    };
    let (world, circle) = (plot(&[]), plot(&["--goal", "1,0,0.2"]));
    assert_eq!([goals(&world, "rect"), goals(&world, "circle")], [1, 0]);
    assert_eq!([goals(&circle, "rect"), goals(&circle, "circle")], [0, 1]);
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
    let mut message = String::new();
    for options in cases {
        let output = run(options);
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{options:?}");
        message += &format!("$ ./ahead {}\n{}\n", options.join(" "), text(output.stderr));
    }
    insta::assert_snapshot!(message);
    assert!(fs::read_dir(ahead()).unwrap().all(|file| !file.unwrap().file_name().to_string_lossy().starts_with('x')));
}
