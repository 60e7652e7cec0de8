//! Three robots that drive in a triangle round a box (paper, sections II-C and III-G), over random seeds.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a test tells")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::chance::repeated;
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;
use mdle_tests::ways::{Place, distance};
use serde_json::Value;

/// Places of the members: ahead of the leader and to its left, in metres.
const PLACES: [(&str, Place); 2] = [("robot2", [-0.866, 0.5]), ("robot3", [-0.866, -0.5])];
/// Time constant with which the triangle turns after its leader, and the period of a turn, in seconds.
const TURNS_IN: f64 = 1.5;
const PERIOD: f64 = 0.1;

/// A folder with the scenario of the book, to which `more` is added.
fn scenario(test: &str, more: &str) -> PathBuf {
    let folder = folder(test);
    let plans = root().join("plans/formation");
    for file in ["first_robot.mdle", "second_robot.mdle", "third_robot.mdle", "floor.toml"] {
        fs::copy(plans.join(file), folder.join(file)).unwrap();
    }
    let text = fs::read_to_string(plans.join("formation.toml")).unwrap();
    fs::write(folder.join("formation.toml"), text + more).unwrap();
    folder
}

fn run(folder: &Path, seed: u64, log: &str) -> Output {
    let arguments = ["run", "formation.toml", "--seed", &seed.to_string(), "--log", log];
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// The turns of a run, each with what the log says of each robot.
fn turns(log: &Path) -> Vec<BTreeMap<String, Value>> {
    let mut turns: BTreeMap<u64, BTreeMap<String, Value>> = BTreeMap::new();
    for line in fs::read_to_string(log).unwrap().lines() {
        let value: Value = serde_json::from_str(line).unwrap();
        let robot = value["robot"].as_str().unwrap().to_owned();
        turns.entry(value["turn"].as_u64().unwrap()).or_default().insert(robot, value);
    }
    turns.into_values().collect()
}

fn number(of: &Value, key: &str) -> f64 {
    of[key].as_f64().unwrap()
}

fn place(of: &Value) -> Place {
    ["x", "y"].map(|axis| number(of, axis))
}

/// Returns the distances of the members from their places while the leader leads, by where the robots really are.
fn errors(turns: &[BTreeMap<String, Value>]) -> Vec<f64> {
    let mut direction = None;
    let mut errors = Vec::new();
    for turn in turns.iter().filter(|turn| turn["robot1"]["law"].as_str().unwrap().starts_with("lead")) {
        let leader = &turn["robot1"];
        let heading = number(leader, "heading").to_radians();
        let before = direction.unwrap_or(heading);
        let (sin, cos) = libm::sincos(heading - before);
        let now = before + libm::atan2(sin, cos) * (1.0 - libm::exp(-PERIOD / TURNS_IN));
        direction = Some(now);
        let ([x, y], (sin, cos)) = (place(leader), libm::sincos(now));
        for (robot, [ahead, left]) in PLACES {
            let own = [x + ahead * cos - left * sin, y + ahead * sin + left * cos];
            errors.push(distance(place(&turn[robot]), own));
        }
    }
    errors
}

/// Runs the scenario with a few seeds, and checks what is promised of each run.
fn assert_keep(test: &str, more: &str, first: u64) {
    let folder = scenario(test, more);
    let mut all = Vec::new();
    for seed in first..first + repeated(3) {
        let output = run(&folder, seed, "log.jsonl");
        let report = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(0), "seed {seed}: {report}{}", String::from_utf8_lossy(&output.stderr));
        let turns = turns(&folder.join("log.jsonl"));
        let pressed = turns.iter().flat_map(BTreeMap::values).any(|turn| turn["pressed"] == true);
        assert!(!pressed, "seed {seed}: a contact: {report}");
        let errors = errors(&turns);
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let arrived = distance(place(&turns.last().unwrap()["robot1"]), [7.0, 0.0]);
        println!("{test}, seed {seed}: {rms:.3} m rms, {arrived:.2} m from the goal");
        assert!(rms <= 0.25 && arrived < 0.9, "seed {seed}: {rms} m, {arrived} m: {report}");
        assert!(turns.len() < 900 && !report.contains("2min"), "seed {seed}: {report}");
        all.push(rms);
    }
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!(mean <= 0.12, "{mean} m: {all:?}");
}

#[test]
fn three_robots_keep_their_triangle() {
    assert_keep("formation_clean", "", 9_800_000);
}

#[test]
fn a_bad_link_does_not_break_the_triangle() {
    assert_keep("formation_bad_link", "\n[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\n", 9_800_010);
}

#[test]
fn a_contact_of_one_robot_stops_all() {
    let folder = scenario("formation_contact", "");
    let file = folder.join("floor.toml");
    let text = fs::read_to_string(&file).unwrap();
    // Beside the leader, whose way is free, and ahead of a member.
    fs::write(&file, text.replace("[3.5, 0.7]", "[-0.3, 0.6]")).unwrap();
    let report = String::from_utf8(run(&folder, 9_800_020, "log.jsonl").stdout).unwrap();
    let line = |robot: &str, words: &str| report.lines().any(|line| line.contains(robot) && line.contains(words));
    assert!(line("robot2: stop", "<- bumper"), "{report}");
    assert!(line("robot1: stop", "<- past robot2 3"), "{report}");
    assert!(line("robot3: stop", "<- past robot1 3"), "{report}");
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let folder = scenario("formation_bytes", "\n[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\n");
    let bytes = |name: &str| (run(&folder, 5, name).stdout, fs::read(folder.join(name)).unwrap());
    assert!(bytes("one.jsonl") == bytes("other.jsonl"), "two runs of one seed differ");
}
