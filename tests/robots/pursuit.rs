//! Tests local pursuit by three robots (paper, section IV-D, Fig. 12), with random seeds: the paths become straighter
//! from trip to trip.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a test tells")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::chance::{repeated, sized};
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;
use mdle_tests::ways::{Point, bulge, excess};
use serde_json::Value;

/// Number of trips: four laps there and back.
const TRIPS: usize = 8;

/// Returns a folder with the scenario of the book, to which `more` is appended.
fn scenario(test: &str, more: &str) -> PathBuf {
    let folder = folder(test);
    let plans = root().join("plans/pursuit");
    fs::create_dir_all(folder.join("robot1")).unwrap();
    for file in ["first_robot.mdle", "second_robot.mdle", "third_robot.mdle", "robot1/lastPath.csv"] {
        fs::copy(plans.join(file), folder.join(file)).unwrap();
    }
    let text = fs::read_to_string(plans.join("pursuit.toml")).unwrap();
    fs::write(folder.join("pursuit.toml"), text + more).unwrap();
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let arguments = ["run", "pursuit.toml"].iter().chain(arguments);
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// Trips of a robot by `path` and `Follow`, in order, according to the log of a run.
struct Trips {
    /// For each trip, `true` if the robot led it, and the robot's positions.
    trips: Vec<(bool, Vec<Point>)>,
}

impl Trips {
    fn of(log: &[Value], robot: &str) -> Self {
        let mut trips: Vec<(bool, Vec<Point>)> = Vec::new();
        let mut last = 0;
        for turn in log.iter().filter(|turn| turn["robot"] == robot) {
            let (state, law) = (turn["state"].as_u64().unwrap(), turn["law"].as_str().unwrap());
            let is_led = law.starts_with("path");
            if is_led || law.starts_with("Follow") {
                if state != last {
                    trips.push((is_led, Vec::new()));
                }
                let place = ["x", "y"].map(|axis| turn[axis].as_f64().unwrap());
                trips.last_mut().unwrap().1.push(place);
            }
            last = state;
        }
        Self { trips }
    }

    /// Returns the positions on the trips that the robot led.
    fn led(&self) -> impl Iterator<Item = &Vec<Point>> {
        self.trips.iter().filter(|(is_led, _)| *is_led).map(|(_, way)| way)
    }
}

/// Measures of a run: the time of its end in seconds, the minimum gap in centimetres and, for each trip, the excess
/// length of the leader's path and of the second robot's path in percent, and the maximum distance of the leader from
/// the line between the ends in metres.
struct Figures {
    seconds: f64,
    gap: f64,
    leader: Vec<f64>,
    second: Vec<f64>,
    bulges: Vec<f64>,
}

/// Runs the scenario with this seed, asserts conditions that hold for every run, and returns the measures of the run.
fn figures(folder: &Path, seed: u64) -> Figures {
    let log = format!("{seed}.jsonl");
    let output = run(folder, &["--seed", &seed.to_string(), "--log", &log]);
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "seed {seed}: {report}{}", String::from_utf8_lossy(&output.stderr));
    let log = fs::read_to_string(folder.join(&log)).unwrap();
    let log: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(log.iter().all(|turn| turn["pressed"] == false), "seed {seed}: a contact");
    let [first, second, third] = ["robot1", "robot2", "robot3"].map(|robot| Trips::of(&log, robot));
    let mut led = first.led().zip(third.led()).flat_map(|(there, back)| [there, back]);
    let ways: Vec<_> = led.by_ref().collect();
    assert_eq!((ways.len(), second.trips.len()), (TRIPS, TRIPS), "seed {seed}: {report}");
    let gap = report.lines().last().unwrap().strip_prefix("least gap between robots: ").unwrap();
    Figures {
        seconds: log.last().unwrap()["t"].as_f64().unwrap(),
        gap: gap.split(' ').next().unwrap().parse().unwrap(),
        leader: ways.iter().map(|way| excess(way)).collect(),
        second: second.trips.iter().map(|(_, way)| excess(way)).collect(),
        bulges: ways.iter().map(|way| bulge(way)).collect(),
    }
}

/// Asserts the book's statements about each run, and prints the measures of all runs.
fn assert_converge(test: &str, more: &str, first: u64) {
    let folder = scenario(test, more);
    let seeds = first..first + repeated(5);
    let all: Vec<_> = seeds.clone().map(|seed| (seed, figures(&folder, seed))).collect();
    for (seed, Figures { seconds, gap, leader, second, bulges }) in &all {
        let figures = format!("seed {seed}: {seconds} s, {gap} cm, {leader:?}, {second:?}, {bulges:?}");
        assert!(*gap > 0.0 && *seconds < 180.0, "{figures}");
        assert!(leader[..5].windows(2).all(|pair| pair[1] < pair[0]), "{figures}");
        assert!(leader.windows(3).all(|trips| trips[2] < trips[0]), "{figures}");
        assert!(leader[0] >= 20.0 && leader[4] <= 2.0 && leader[6] <= 1.0, "{figures}");
        assert!(bulges[6] <= 0.3 && second[..6].windows(2).all(|pair| pair[1] < pair[0]), "{figures}");
    }
    let mean = |of: &dyn Fn(&Figures) -> f64| all.iter().map(|(_, run)| of(run)).sum::<f64>() / all.len() as f64;
    let greatest = |of: &dyn Fn(&Figures) -> f64| all.iter().map(|(_, run)| of(run)).fold(f64::MIN, f64::max);
    let least = |of: &dyn Fn(&Figures) -> f64| -greatest(&|run| -of(run));
    println!(
        "{test}, {} seeds: at most {:.1} s, gap at least {:.1} cm",
        all.len(),
        greatest(&|run| run.seconds),
        least(&|run| run.gap)
    );
    for trip in 0..TRIPS {
        println!(
            "trip {}: leader {:.1} % (at most {:.1}), second {:.1} %, {:.0} cm from the line (at most {:.0})",
            trip + 1,
            mean(&|run| run.leader[trip]),
            greatest(&|run| run.leader[trip]),
            mean(&|run| run.second[trip]),
            mean(&|run| run.bulges[trip] * 100.0),
            greatest(&|run| run.bulges[trip] * 100.0),
        );
    }
}

#[test]
fn the_ways_become_straight() {
    assert_converge("pursuit_clean", "", 100);
}

#[test]
fn the_ways_become_straight_by_a_bad_link() {
    assert_converge("pursuit_bad_link", "[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\nduplication = 0.1\n", 200);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let folder = scenario("pursuit_bytes", "[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\n");
    let bytes = |name: &str| {
        let [log, trail, plot, trips] =
            [format!("{name}.jsonl"), format!("{name}.csv"), format!("{name}.svg"), format!("{name}-trips.svg")];
        let options = ["--seed", "5", "--log", &log, "--trail", &trail, "--plot", &plot, "--trips", &trips];
        let output = run(&folder, &[&options[..], &["--recorded-paths", name]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let files = [&log, &trail, &plot, &trips].map(|file| fs::read(folder.join(file)).unwrap());
        let paths =
            ["robot1", "robot3"].map(|robot| fs::read(folder.join(name).join(robot).join("lastPath.csv")).unwrap());
        (output.stdout, files, paths)
    };
    let (one, other) = (bytes("one"), bytes("other"));
    assert!(one == other, "two runs of one seed differ");
    let original = fs::read(root().join("plans/pursuit/robot1/lastPath.csv")).unwrap();
    assert_eq!(fs::read(folder.join("robot1/lastPath.csv")).unwrap(), original, "the scenario's own path stays");
    assert!(one.2[0] != original, "the recorded path is another one");
}

/// Returns the times at which the atoms of a robot's plan begin in the first lap, according to the report of a run.
fn begins(report: &str, robot: &str) -> Vec<f64> {
    let named = format!(" s  {robot}: ");
    let lines = report.lines().filter_map(|line| line.split_once(&named));
    let first_lap = lines.filter(|(_, rest)| rest.contains("pass 1 of 4"));
    [0.0].into_iter().chain(first_lap.map(|(time, _)| time.parse().unwrap())).collect()
}

#[test]
fn a_robot_that_dies_in_any_atom_leaves_nobody_waiting() {
    let robots = ["robot1", "robot2", "robot3"];
    let folder = scenario("pursuit_dies", "");
    let whole = String::from_utf8(run(&folder, &["--seed", "9800000"]).stdout).unwrap();
    let text = fs::read_to_string(folder.join("pursuit.toml")).unwrap().replace("180s", "700s");
    let atoms: Vec<(&str, f64)> =
        robots.iter().flat_map(|robot| begins(&whole, robot).into_iter().map(move |t| (*robot, t))).collect();
    assert_eq!(atoms.len(), 24, "eight atoms of each plan: {whole}");
    // A short test kills a robot in every sixth atom, and a long test in every atom.
    let step = 24 / sized(4, 24) as usize;
    for (victim, begun) in atoms.into_iter().step_by(step) {
        let named = format!("name = \"{victim}\"\n");
        let killed = format!("{named}killed = \"{}s\"\n", begun + 0.3);
        fs::write(folder.join("pursuit.toml"), text.replace(&named, &killed)).unwrap();
        let output = run(&folder, &["--seed", "9800000"]);
        let report = String::from_utf8(output.stdout).unwrap();
        let over = report.lines().filter(|line| line.contains(": plan over: ")).count();
        assert_eq!((output.status.code(), over), (Some(4), 2), "{victim} at {begun} s: {report}");
    }
}

#[test]
fn a_robot_that_dies_is_not_run_into() {
    let bad = "\n[link]\nlatency = \"0ms..200ms\"\nloss = 0.1\n";
    // Runs in which two robots would collide if `go` did not end when other robots fall silent; in the last run, both
    // of them are still running.
    let runs =
        [("robot2", "0.8s", "", "9940350"), ("robot1", "35.1s", "", "9940313"), ("robot3", "52.4s", bad, "9940398")];
    for (victim, time, link, seed) in runs {
        let folder = scenario(&format!("pursuit_met_{victim}"), link);
        let file = folder.join("pursuit.toml");
        let named = format!("name = \"{victim}\"\n");
        let text = fs::read_to_string(&file).unwrap().replace(&named, &format!("{named}killed = \"{time}\"\n"));
        fs::write(&file, text.replace("180s", "80s")).unwrap();
        let report = String::from_utf8(run(&folder, &["--seed", seed]).stdout).unwrap();
        assert!(report.contains(&format!("{victim}: its program was killed\n")), "{report}");
        assert!(!report.contains("plan over: bumper"), "{victim} at {time}: {report}");
        assert!(!report.contains("least gap between robots: 0.0 cm"), "{victim} at {time}: {report}");
    }
}

#[test]
fn a_robot_that_dies_leaves_nobody_waiting() {
    for (number, time) in (0..repeated(6)).zip([0.0f64, 7.0, 23.0, 41.0].into_iter().cycle()) {
        let victim = ["robot1", "robot2", "robot3"][number as usize % 3];
        let folder = scenario(&format!("pursuit_killed_{number}"), "");
        let file = folder.join("pursuit.toml");
        let text = fs::read_to_string(&file).unwrap().replace("180s", "700s");
        let time = time + number as f64 * 1.7;
        let named = format!("name = \"{victim}\"\n");
        fs::write(&file, text.replace(&named, &format!("{named}killed = \"{time}s\"\n"))).unwrap();
        let output = run(&folder, &["--seed", &number.to_string()]);
        let report = String::from_utf8(output.stdout).unwrap();
        // The exit status reports a plan that is not over: that of the killed robot.
        assert_eq!(output.status.code(), Some(4), "{report}");
        let over: Vec<_> = report.lines().filter(|line| line.contains(": plan over: ")).collect();
        assert_eq!(over.len(), 2, "{victim} at {time} s: {report}");
        for line in over {
            assert!(line.contains("wait 10min") || line.contains("bumper") || line.contains("completed"), "{line}");
        }
        assert!(report.contains(&format!("{victim}: its program was killed\n")), "{report}");
    }
}
