//! Tests three robots that drive in a triangle around a box (paper, sections II-C and III-G), with random seeds.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a test tells")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::chance::repeated;
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;
use mdle_tests::ways::{Point, distance};
use serde_json::Value;

/// Target positions of the members relative to the leader: ahead and to the left, in metres.
const PLACES: [(&str, Point); 2] = [("robot2", [-0.866, 0.5]), ("robot3", [-0.866, -0.5])];
/// Time constant with which the triangle follows the leader's heading, in seconds. `PERIOD` is the period of a turn, in
/// seconds.
const TURNS_IN: f64 = 1.5;
const PERIOD: f64 = 0.1;

/// Returns a folder with the scenario of the book, to which `more` is appended.
fn scenario(test: &str, more: &str) -> PathBuf {
    let folder = folder(test);
    let plans = root().join("plans/formation");
    for file in ["triangle.mdle", "floor.toml"] {
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

/// Returns the turns of a run. Each turn contains the line of the log about each robot.
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

fn place(of: &Value) -> Point {
    ["x", "y"].map(|axis| number(of, axis))
}

/// Returns how far the members are from their places, in true positions, while the leader leads.
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

/// Runs the scenario with a few seeds, and asserts the book's statements about each run.
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
fn a_member_off_its_place_is_no_obstacle() {
    // The third robot is 15 cm nearer than its odometry indicates: a leader that took it for an obstacle would turn
    // away from it until all three robots were at a wall.
    assert_keep("formation_off", "\n[link]\nloss = 0.1\n", 9_990_704);
}

#[test]
fn a_contact_of_one_robot_stops_all() {
    let folder = scenario("formation_contact", "");
    let file = folder.join("floor.toml");
    let text = fs::read_to_string(&file).unwrap();
    // The box is beside the leader, whose path is free, and ahead of a member.
    fs::write(&file, text.replace("[3.5, 0.7]", "[-0.3, 0.6]")).unwrap();
    let report = String::from_utf8(run(&folder, 9_800_020, "log.jsonl").stdout).unwrap();
    let line = |robot: &str, words: &str| report.lines().any(|line| line.contains(robot) && line.contains(words));
    assert!(line("robot2: stop", "<- any bumper"), "{report}");
    assert!(line("robot1: stop", "<- past robot2 3"), "{report}");
    assert!(line("robot3: stop", "<- past robot1 3"), "{report}");
}

#[test]
fn a_triangle_that_fits_through_no_door_stays_outside() {
    let folder = scenario("formation_door", "");
    let wall = |y: f64, end: f64| format!("[[wall]]\npoints = [[3.5, {y}], [3.5, {end}]]\n");
    let floor = "[[wall]]\npoints = [[-3, -4], [10, -4], [10, 4], [-3, 4], [-3, -4]]\n".to_owned();
    // A door of 1 m is wide enough for one robot, but not for a triangle with sides of 1 m.
    fs::write(folder.join("floor.toml"), floor + &wall(-4.0, -0.5) + &wall(0.5, 4.0)).unwrap();
    let output = run(&folder, 9_800_030, "log.jsonl");
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{report}");
    // A member that touches the wall while the robots drive along it stops all three.
    let over = report.lines().filter(|line| line.contains("plan over: wait 2 (triangle.mdle:")).count();
    assert_eq!(over, 3, "{report}");
    assert!(!report.contains("least gap between robots: 0.0 cm"), "{report}");
    let turns = turns(&folder.join("log.jsonl"));
    let farthest = turns.iter().flat_map(BTreeMap::values).map(|robot| number(robot, "x")).fold(0.0, f64::max);
    assert!(farthest < 3.5, "a robot was at {farthest} m: {report}");
}

#[test]
fn a_formation_has_room_for_the_bodies() {
    let folder = scenario("formation_room", "");
    let plan = fs::read_to_string(folder.join("triangle.mdle")).unwrap();
    for (spacing, status) in [("20cm", 2), ("41cm", 2), ("45cm", 4)] {
        fs::write(folder.join("triangle.mdle"), plan.replace("triangle 1m", &format!("triangle {spacing}"))).unwrap();
        let message = refused(&folder, &["run", "formation.toml", "--timeout", "200ms"]);
        assert!(message.ends_with(&format!("[{status}]")), "{spacing}: {message}");
        let touches = "`robot2` would touch `robot1` in the formation";
        assert_eq!(message.contains(touches), status == 2, "{spacing}: {message}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let folder = scenario("formation_bytes", "\n[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\n");
    let bytes = |name: &str| (run(&folder, 5, name).stdout, fs::read(folder.join(name)).unwrap());
    assert!(bytes("one.jsonl") == bytes("other.jsonl"), "two runs of one seed differ");
}

/// A plan of a group of two, in which each robot turns and drives, and an atom ends for all robots when it ends for the
/// first one.
const PAIR: &str = "{ Group [robot1 robot2] Pair (any bumper OR wait 1min)
  (Atom (null) (rotate 90))
  (Atom (all rendezvous) stop)
  (Atom (null) (advance 1m 20cm/s))
}
";

/// Returns the folder of a scenario of robots with these names, 2 m apart, which all run the plan `pair.mdle`.
fn pair(test: &str, robots: &[&str], more: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("pair.mdle"), PAIR.to_owned() + more).unwrap();
    let robot = |(number, name): (usize, &&str)| {
        format!("[[robot]]\nname = \"{name}\"\nfile = \"pair.mdle\"\nstart = \"0, {}, 0\"\n", 2 * number)
    };
    let robots: Vec<_> = robots.iter().enumerate().map(robot).collect();
    fs::write(folder.join("formation.toml"), robots.concat()).unwrap();
    folder
}

#[test]
fn robots_whose_laws_complete_wait_for_the_first() {
    let folder = pair("formation_completes", &["robot1", "robot2"], "");
    let output = run(&folder, 1, "log.jsonl");
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{report}");
    let lines: Vec<&str> = report.lines().filter(|line| line.contains("robot2: ")).collect();
    assert!(lines[0].contains("robot2: stop (pair.mdle:2, Pair)  <- completed"), "{report}");
    assert!(lines[1].contains("robot2: stop (pair.mdle:3, Pair)  <- past robot1 2 (pair.mdle:2"), "{report}");
    assert!(lines[2].contains("robot2: advance 1 20 (pair.mdle:4, Pair)  <- past robot1 3 (pair.mdle:3"), "{report}");
    assert_eq!(report.matches("plan over: wait 2 (pair.mdle").count(), 2, "{report}");
    let turns = turns(&folder.join("log.jsonl"));
    for (robot, start) in [("robot1", 0.0), ("robot2", 2.0)] {
        let y = number(&turns.last().unwrap()[robot], "y");
        assert!((y - start - 1.0).abs() < 0.05, "{robot}: {y}");
    }
}

/// Returns standard error of `mdle`, with its exit status.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap();
    format!("{}[{}]", String::from_utf8(output.stderr).unwrap(), output.status.code().unwrap())
}

#[test]
fn a_scenario_has_the_robots_of_its_group() {
    let refused =
        |test: &str, robots: &[&str], more: &str| refused(&pair(test, robots, more), &["run", "formation.toml"]);
    let lacks = refused("formation_lacks", &["robot1", "robot3"], "");
    let lacking = "the group `Pair` has the robot `robot2`, and the scenario has none";
    assert!(lacks.contains(&format!("{lacking}; did you mean `robot3`?")), "{lacks}");
    let alone = refused("formation_alone", &["robot1"], "");
    assert!(alone.contains(lacking) && !alone.contains("did you mean"), "{alone}");
    let more = refused("formation_more", &["robot1", "robot2", "robot3"], "");
    assert!(more.contains("the group `Pair` has no robot `robot3`"), "{more}");
    assert!(more.contains("the robots of the group are robot1, robot2"), "{more}");
    let several = "{ Other (wait 5) (Atom (null) stop) }\n";
    let several = refused("formation_several", &["robot1", "robot2"], several);
    assert!(several.contains("several plans that no other plan uses: Pair_robot1, Pair_robot2, Other"), "{several}");
    assert!([lacks, more, several].iter().all(|message| message.ends_with("[2]")));
}

#[test]
fn a_group_is_tested_by_the_part_that_a_file_names() {
    let folder = pair("formation_tested", &["robot1", "robot2"], "");
    let test = "[[test]]\nname = \"begins\"\ntimeout = \"1s\"\n";
    fs::write(folder.join("pair.test.toml"), test).unwrap();
    let unnamed = refused(&folder, &["test", "pair.test.toml"]);
    assert!(unnamed.contains("name one of them, as in `name = \"Pair_robot1\"` before the first test"), "{unnamed}");
}

#[test]
fn a_crowd_has_no_robots_of_a_group() {
    let folder = pair("formation_crowd", &["robot1", "robot2"], "");
    let crowd = "[crowd]\nrobots = 2\nfile = \"pair.mdle\"\n";
    fs::write(folder.join("crowd.toml"), crowd).unwrap();
    let crowd = refused(&folder, &["run", "crowd.toml"]);
    assert!(crowd.contains("the robots of the group `Pair` have names, and those of a crowd have none"), "{crowd}");
    assert!(crowd.contains("crowd.toml:3:8") && crowd.contains("write a `[[robot]]` with this file"), "{crowd}");
}

#[test]
fn a_scenario_places_its_errors() {
    let folder = pair("formation_places", &["robot1", "robot2"], "");
    let speed = refused(&folder, &["run", "formation.toml", "--speed", "max"]);
    assert!(speed.contains("--speed is for one robot, and a scenario always runs as fast as possible"), "{speed}");
    let paths = refused(&folder, &["run", "formation.toml", "--recorded-paths", "paths"]);
    assert!(paths.contains("no robot of the scenario records a path"), "{paths}");
    let text = fs::read_to_string(folder.join("formation.toml")).unwrap();
    let changed = |from: &str, to: &str| {
        fs::write(folder.join("other.toml"), text.replacen(from, to, 1)).unwrap();
        refused(&folder, &["run", "other.toml"])
    };
    let missing = changed("pair.mdle", "none.mdle");
    assert!(missing.contains("there is no file") && missing.contains("other.toml:3:8"), "{missing}");
    let unknown = changed("file = \"pair.mdle\"", "file = \"pair.mdle\"\nplan = \"Pear\"");
    assert!(unknown.contains("has no plan `Pear`") && unknown.contains("other.toml:4:8"), "{unknown}");
    let killed = changed("[[robot]]", "timeout = \"5s\"\n[[robot]]\nkilled = \"9s\"");
    assert!(killed.contains("the scenario ends after 5 s, before the robot is killed at 9 s"), "{killed}");
}

#[test]
fn a_part_of_a_group_runs_by_the_name_of_its_robot() {
    let folder = pair("formation_parts", &[], "");
    let link = |name: &str| format!("name = \"{name}\"\nlisten = \"127.0.0.1:0\"\nkey = \"k\"\nrobot = []\n");
    fs::write(folder.join("other.toml"), link("robot3")).unwrap();
    fs::write(folder.join("own.toml"), link("robot2")).unwrap();
    let run = |options: &[&str]| refused(&folder, &[&["run", "pair.mdle", "--target", "sim"], options].concat());
    let alone = run(&[]);
    assert!(alone.contains("`pair.mdle` is the plan of a group, and has one for each robot: Pair_robot1"), "{alone}");
    let other = run(&["--link", "other.toml"]);
    assert!(
        other.contains("other.toml is the link of the robot `robot3`, which is not in the group `Pair`"),
        "{other}"
    );
    for options in [&["--link", "own.toml"][..], &["--link", "own.toml", "--plan", "Pair"]] {
        let own = run(options);
        assert!(own.contains("the plan names the robot `robot1`, which is not in own.toml"), "{own}");
    }
    let first = run(&["--link", "own.toml", "--plan", "Pair_robot1"]);
    assert!(first.contains("the plan names the robot `robot2`"), "{first}");
    let unlinked = run(&["--plan", "Pair_robot1"]);
    assert!(unlinked.contains("the plan names the robot `robot2`, and there is no link to it"), "{unlinked}");
}
