//! Tests `mdle run CROWD.toml`: the output does not depend on the number of threads, robots never overlap, and a single
//! robot drives as in a scenario.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

/// A plan that drives, and turns away after a contact.
const WANDER: &str = "{ Wander (wait 1h)\n  ExecPlan inf {\n    (Atom (wait 6 OR bumper) (goAvoid 0 40 30))\n    \
                      (Atom (wait 1) (go -20 0))\n    (Atom (wait 9) (turn 100))\n  }\n}\n";
/// Radius of a Scout, in metres.
const RADIUS: f64 = 0.205;

fn run(folder: &Path, arguments: &str) -> Output {
    let arguments = ["run"].into_iter().chain(arguments.split(' '));
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// Writes a crowd with these entries, and its plan.
fn crowd(folder: &Path, keys: &str) {
    fs::write(folder.join("wander.mdle"), WANDER).unwrap();
    fs::write(folder.join("crowd.toml"), format!("seed = 3\n[crowd]\nfile = \"wander.mdle\"\n{keys}")).unwrap();
}

/// Returns the positions of all robots, by time.
fn places(trail: &str) -> BTreeMap<String, Vec<[f64; 2]>> {
    let mut places: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for line in trail.lines().skip(1) {
        let [t, _, x, y, _] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
        places.entry(t.to_owned()).or_default().push([x.parse().unwrap(), y.parse().unwrap()]);
    }
    places
}

#[test]
fn threads_change_no_byte_and_no_robots_overlap() {
    let folder = folder("threads");
    crowd(&folder, "robots = 400\nbody = \"scout\"\nspacing = \"80cm\"\n");
    let all = ["1", "2", "4"].map(|threads| {
        let output = run(&folder, &format!("crowd.toml --timeout 4s --threads {threads} --trail {threads}.csv"));
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(4), "{error}");
        let words = if threads == "1" { "with a thread\n".to_owned() } else { format!("with {threads} threads\n") };
        assert!(error.ends_with(&words), "{error}");
        (output.stdout, fs::read_to_string(folder.join(format!("{threads}.csv"))).unwrap())
    });
    assert!(all[0] == all[1] && all[0] == all[2], "the number of threads changes something");
    let report = String::from_utf8(all[0].0.clone()).unwrap();
    assert!(report.starts_with("400 robots for 4.0 s\nplans that are over: 0\n"), "{report}");
    assert!(!report.contains("touched something: 0\n") && !report.contains("mean way: 0.00"), "{report}");
    for (t, places) in places(&all[0].1) {
        assert_eq!(places.len(), 400);
        for (number, one) in places.iter().enumerate() {
            for other in &places[..number] {
                let apart = libm::hypot(one[0] - other[0], one[1] - other[1]);
                assert!(apart >= 2.0 * RADIUS - 1e-6, "{t} s: {apart} m between {one:?} and {other:?}");
            }
        }
    }
}

#[test]
fn a_robot_alone_drives_as_in_a_scenario() {
    let folder = folder("alone");
    let world =
        "start = { x = 1.0, y = 1.0, heading = 0.0 }\n[[wall]]\npoints = [[0, 0], [6, 0], [6, 5], [0, 5], [0, 0]]";
    fs::write(folder.join("floor.toml"), world).unwrap();
    crowd(&folder, "robots = 1\nbody = \"scout\"\nspacing = \"4m\"\n");
    let text = fs::read_to_string(folder.join("crowd.toml")).unwrap();
    fs::write(folder.join("crowd.toml"), format!("world = \"floor.toml\"\ntimeout = \"30s\"\n{text}")).unwrap();
    assert_eq!(run(&folder, "crowd.toml --trail crowd.csv").status.code(), Some(4));
    let crowd = fs::read_to_string(folder.join("crowd.csv")).unwrap();
    let heading = crowd.lines().nth(1).unwrap().rsplit(',').next().unwrap();
    let robot =
        format!("[[robot]]\nname = \"ada\"\nfile = \"wander.mdle\"\nbody = \"scout\"\nstart = \"2,2,{heading}\"\n");
    let text = format!("world = \"floor.toml\"\ntimeout = \"30s\"\nseed = 3\n{robot}");
    fs::write(folder.join("alone.toml"), text).unwrap();
    assert_eq!(run(&folder, "alone.toml --trail alone.csv").status.code(), Some(4));
    let alone = places(&fs::read_to_string(folder.join("alone.csv")).unwrap());
    for (t, place) in places(&crowd) {
        let apart = libm::hypot(place[0][0] - alone[&t][0][0], place[0][1] - alone[&t][0][1]);
        assert!(apart < 1e-6, "{t} s: {apart} m");
    }
}

#[test]
fn robots_hear_and_avoid_each_other() {
    let folder = folder("hear");
    crowd(&folder, "robots = 25\nspacing = \"1.5m\"\n");
    fs::write(folder.join("wander.mdle"), "{ Stop (r0 < 1m OR wait 60) (Atom (bumper) (go 20 0)) }").unwrap();
    let output = run(&folder, "crowd.toml");
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{report}");
    assert!(report.contains("plans that are over: 25\n"), "{report}");
    assert!(report.contains("25 robots for ") && !report.contains("for 60"), "all heard somebody: {report}");
}

#[test]
fn a_wrong_crowd_is_refused_with_place_and_cure() {
    let folder = folder("errors");
    fs::write(folder.join("meet.mdle"), "{ Meet (wait 9) (Atom (sync robot2) stop) }\n").unwrap();
    fs::write(folder.join("replay.mdle"), "{ Replay (wait 9) (Atom (null) path(way)) }\n").unwrap();
    let robot = "[[robot]]\nname = \"ada\"\nfile = \"wander.mdle\"\nstart = \"0,0,0\"\n";
    let crowds = [
        "robots = 0\n".to_owned(),
        "robots = 1000000\n".to_owned(),
        "robots = -1\n".to_owned(),
        "robots = 4\nspacing = \"30cm\"\n".to_owned(),
        "robots = 4\nspacing = \"2s\"\n".to_owned(),
        "robots = 4\nbody = \"round\"\n".to_owned(),
        "robots = 4\nbodies = \"scout\"\n".to_owned(),
        format!("robots = 4\n{robot}"),
    ];
    let texts = crowds.into_iter().map(|keys| format!("[crowd]\nfile = \"wander.mdle\"\n{keys}"));
    let plans = ["meet", "replay", "none"].map(|plan| format!("[crowd]\nrobots = 4\nfile = \"{plan}.mdle\"\n"));
    let full = "world = \"room\"\n[crowd]\nrobots = 5000\nfile = \"wander.mdle\"\n".to_owned();
    let messages = texts.chain(plans).chain([full]).map(|text| {
        crowd(&folder, "");
        fs::write(folder.join("crowd.toml"), &text).unwrap();
        let output = run(&folder, "crowd.toml");
        assert_eq!(output.stdout, b"", "{text}");
        format!("{text}{}[{}]\n", String::from_utf8_lossy(&output.stderr), output.status.code().unwrap())
    });
    insta::assert_snapshot!(messages.collect::<Vec<_>>().join("\n"));
    crowd(&folder, "robots = 4\n");
    for option in ["--log a.jsonl", "--plot a.svg", "--threads 0", "--trail /none/a.csv"] {
        let output = run(&folder, &format!("crowd.toml {option}"));
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    }
    fs::write(folder.join("s.toml"), robot).unwrap();
    let output = run(&folder, "s.toml --threads 2");
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Each robot has a record, which replays to the bit and does not depend on the number of threads.
#[test]
fn each_robot_of_a_crowd_has_a_record() {
    let folder = folder("recorded");
    crowd(&folder, "robots = 120\nbody = \"scout\"\nspacing = \"80cm\"\n");
    let records = ["1", "2"].map(|threads| {
        let output = run(&folder, &format!("crowd.toml --timeout 6s --threads {threads} --log run{threads}.mcap"));
        assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
        (1..=120).map(|robot| fs::read(folder.join(format!("run{threads}.{robot}.mcap"))).unwrap()).collect::<Vec<_>>()
    });
    let [one, other] = &records;
    // Only the lengths are compared, because the recorded commands contain the numbers of threads.
    assert!(one.iter().zip(other).all(|(one, other)| one.len() == other.len()), "threads change a record");
    for robot in [1, 2, 60, 120] {
        let output = Command::new(mdle()).args(["replay", &format!("run2.{robot}.mcap")]).current_dir(&folder).output();
        let text = String::from_utf8(output.unwrap().stdout).unwrap();
        assert_eq!(text, "the same to the bit, 61 turns\n", "{robot}");
    }
    fs::create_dir(folder.join("less.3.mcap")).unwrap();
    let refused = run(&folder, "crowd.toml --timeout 1s --log less.mcap");
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stderr));
    assert!(!folder.join("less.1.mcap").exists() && !folder.join("less.2.mcap").exists());
    crowd(&folder, "robots = 300\nbody = \"scout\"\nspacing = \"80cm\"\n");
    let refused = run(&folder, "crowd.toml --timeout 1s --log more.mcap");
    let error = String::from_utf8(refused.stderr).unwrap();
    assert!(
        error.contains("for at most 250 robots, and this crowd has 300\n") && refused.status.code() == Some(2),
        "{error}"
    );
}
