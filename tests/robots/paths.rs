//! Tests plans that replay paths, with the executables that `mdlec` builds: where and when they end, which paths they
//! refuse, and that a recorded path can be replayed.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_emulator::{Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};

/// A plan that replays the path twice, with both notations for the name of its file. The second replay begins where the
/// first one ends.
const TWICE: &str = "{ Twice (bumper) (Atom (null) path(bend)) FRAME 200deg (Atom (null) path \"bend.csv\") }\n";
/// A plan that replays the path once, and is emitted as rows of tables.
const ONCE: &str = "{ Once (RISING bumper) (Atom (null) path(bend)) }\n";

/// A path that turns by 180° at changing speeds, and ends with a heading of 200°.
const BEND: &str = "# To the left and back.
time s, heading deg, speed cm/s
0, 0, 0
1, 0, 20
2, 0, 20     # now to the left
3, 30, 20
4, 60, 25
5, 90, 25
6, 120, 25
7, 150, 25
8, 180, 20
8.5, -170, 10
9, -160, 0
";

/// A floor with a single wall, far away.
const WORLD: &str = "start = { x = 1, y = 2, heading = 30 }\n[[wall]]\npoints = [[-20, -20], [20, -20]]\n";

/// Returns the folder of the plan's executable for the simulator, which is built once, and of its path and floor.
fn twice() -> &'static Path {
    static TWICE_FOLDER: OnceLock<PathBuf> = OnceLock::new();
    TWICE_FOLDER.get_or_init(|| built("paths_sim", "twice", TWICE, "sim"))
}

fn built(name: &str, plan: &str, text: &str, target: &str) -> PathBuf {
    let folder = folder(name);
    fs::write(folder.join(format!("{plan}.mdle")), text).unwrap();
    fs::write(folder.join("bend.csv"), BEND).unwrap();
    fs::write(folder.join("floor.toml"), WORLD).unwrap();
    let output = run_mdlec(&folder, &[&format!("{plan}.mdle"), "--target", target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

fn run(options: &[&str]) -> Output {
    let mut run = Command::new("./twice");
    run.args(["--speed", "max", "--world", "floor.toml"]).args(options).current_dir(twice()).output().unwrap()
}

/// Returns the output of a run that succeeds.
fn good(options: &[&str]) -> String {
    let output = run(options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Place in metres, and heading in degrees.
type At = [f64; 3];

/// Returns the pose to which the setpoints of a path lead from the pose `from`, in a frame that is turned by `frame`
/// degrees, and the time at which they end. The test parses and integrates the setpoints itself, in steps of a
/// millisecond.
fn integrated(path: &str, from: At, frame: f64) -> (At, f64) {
    let report = path.lines().map(|line| line.split('#').next().unwrap()).filter(|line| !line.trim().is_empty());
    let numbers = |row: &str| row.split(',').map(|number| number.trim().parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<_> = report.skip(1).map(numbers).collect();
    let [mut x, mut y, mut heading] = from;
    for pair in rows.windows(2) {
        let ([t, alpha, v], [until, beta, w]) = (&pair[0][..], &pair[1][..]) else { panic!("{pair:?}") };
        let turn = (beta - alpha + 180.0).rem_euclid(360.0) - 180.0;
        let steps = ((until - t) * 1000.0).round();
        for step in 0..steps as u32 {
            let part = (f64::from(step) + 0.5) / steps;
            let way = (v + part * (w - v)) / 100.0 * (until - t) / steps;
            heading = frame + alpha + part * turn;
            x += way * libm::cos(heading.to_radians());
            y += way * libm::sin(heading.to_radians());
        }
    }
    ([x, y, heading], rows.last().unwrap()[0])
}

/// Returns the pose at which the plan [`TWICE`] should end with this path.
fn twice_integrated(path: &str) -> At {
    let (half, _) = integrated(path, [1.0, 2.0, 30.0], 30.0);
    integrated(path, half, 230.0).0
}

fn assert_near([x, y, heading]: At, [to_x, to_y, to_heading]: At, metres: f64, degrees: f64) {
    let away = libm::hypot(x - to_x, y - to_y);
    let turned = (heading - to_heading + 180.0).rem_euclid(360.0) - 180.0;
    assert!(away <= metres && turned.abs() <= degrees, "{away} m and {turned}° from ({to_x}, {to_y}) at {to_heading}°");
}

/// Returns the robot's pose at a time, from the row of the trail that begins with this time.
fn was_at(trail: &str, seconds: &str) -> At {
    let trail = fs::read_to_string(twice().join(trail)).unwrap();
    let row = trail.lines().find(|row| row.split(',').next() == Some(seconds)).unwrap_or_else(|| panic!("{trail}"));
    let numbers: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
    let [_, x, y, heading] = numbers[..] else { panic!("{row}") };
    [x, y, heading]
}

#[test]
fn a_plan_ends_when_its_path_does_and_where_the_setpoints_lead() {
    let message = good(&["--trail", "trail.csv", "--log", "log"]);
    assert_eq!(
        message,
        "9.0 s  path \"bend.csv\" (twice.mdle:1)  <- completed (twice.mdle:1)\n18.0 s  plan over: completed (twice.mdle:1)\n"
    );
    let log = fs::read_to_string(twice().join("log")).unwrap();
    assert!(log.lines().last().unwrap().contains("\"t\":18.0,"), "{log}");
    assert_near(was_at("trail.csv", "18"), twice_integrated(BEND), 0.03, 1.0);
}

#[test]
fn what_is_recorded_is_a_path_that_leads_to_the_same_place() {
    fs::create_dir_all(twice().join("recorded")).unwrap();
    // The first half of the plan, including the turn in which it ends.
    let half = run(&["--turns", "91", "--record-path", "recorded/bend.csv", "--trail", "recorded/trail.csv"]);
    assert_eq!(half.status.code(), Some(4));
    let recorded = fs::read_to_string(twice().join("recorded/bend.csv")).unwrap();
    assert_eq!(recorded.lines().count(), 92, "the header, and a turn each tenth of a second");
    let (end, seconds) = integrated(&recorded, [1.0, 2.0, 30.0], 30.0);
    assert_eq!(seconds, 9.0);
    assert_near(end, was_at("recorded/trail.csv", "9"), 0.03, 0.1);

    // The result does not depend on the period of the turns, nor on sensor and wheel errors.
    let options = ["--paths", "recorded", "--period", "0.07", "--trail", "replayed.csv"];
    let message = good(&options);
    assert!(message.starts_with("9.03 s  path \"bend.csv\""), "the first turn from 9 s on: {message}");
    assert_near(was_at("replayed.csv", "18.06"), twice_integrated(&recorded), 0.06, 2.0);
    good(&[&options[..], &["--body", "scout", "--seed", "3"]].concat());
    assert_near(was_at("replayed.csv", "18.06"), twice_integrated(&recorded), 0.25, 8.0);
}

#[test]
fn each_of_several_runs_has_the_paths() {
    let message = good(&["--runs", "3", "--body", "scout", "--jobs", "2"]);
    assert!(message.starts_with("3 runs, seeds 1 to 3: 3 ended"), "{message}");
}

#[test]
fn what_is_no_path_is_refused_before_anything_begins() {
    let bad = twice().join("bad");
    fs::create_dir_all(bad.join("bend.csv.d")).unwrap();
    let mut all = String::new();
    let mut refused = |options: &[&str]| {
        let written: &[&str] =
            if options.contains(&"--runs") { &[] } else { &["--log", "bad/log", "--trail", "bad/trail"] };
        let output = run(&[options, written].concat());
        let [message, why] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        all += &format!("{options:?} [{}]\n{message}{why}\n", output.status.code().unwrap());
        let left: Vec<_> = ["log", "trail"].into_iter().filter(|file| bad.join(file).exists()).collect();
        assert!(left.is_empty(), "{options:?} leaves {left:?}");
    };
    let file = bad.join("bend.csv");
    refused(&["--paths", "bad"]);
    refused(&["--paths", "nowhere"]);
    refused(&["--paths", "bend.csv"]);
    for text in [
        BEND.replace("\n4, 60, 25\n5, 90, 25", ""),
        BEND.replace("60, 25", "60, 250"),
        BEND.replace("time s", "time"),
        String::new(),
    ] {
        fs::write(&file, text).unwrap();
        refused(&["--paths", "bad"]);
        refused(&["--paths", "bad", "--runs", "2"]);
    }
    fs::write(&file, b"time s, heading deg, speed \xb5m/s").unwrap();
    refused(&["--paths", "bad"]);
    fs::File::create(&file).unwrap().set_len(100_000_000).unwrap();
    refused(&["--paths", "bad"]);
    fs::remove_file(&file).unwrap();
    fs::rename(bad.join("bend.csv.d"), &file).unwrap();
    refused(&["--paths", "bad"]);
    refused(&["--record-path", "bad/none/path.csv"]);
    refused(&["--record-path", "bad/path.csv", "--period", "2"]);
    refused(&["--record-path", "bad/path.csv", "--runs", "2"]);
    assert!(!bad.join("path.csv").exists());
    insta::assert_snapshot!(all);
}

#[test]
fn a_scout_replays_a_path_and_reads_it_before_it_looks_for_the_robot() {
    const PERIOD: Duration = Duration::from_millis(100);
    let folder = built("paths_scout", "once", ONCE, "scout");
    let world = World::parse("floor.toml", WORLD).unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let mut robot = Scout::new(Simulated::with(&make, &world, world.start, PERIOD).unwrap()).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving =
            scope.spawn(|| serve(&mut robot, &port, Pace::Lockstep(PERIOD), &|| !over.load(Ordering::Relaxed)));
        let mut once = Command::new("./once");
        once.current_dir(&folder).args(["--lockstep", "--timeout", "60", "--device"]).arg(port.path());
        let output = once.output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    });
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "9.0 s  plan over: completed (once.mdle:1)\n");
    let pose = robot.pose();
    let (end, _) = integrated(BEND, [1.0, 2.0, 30.0], 30.0);
    assert_near([pose.x.0, pose.y.0, pose.theta.degrees()], end, 0.06, 3.0);

    fs::remove_file(folder.join("bend.csv")).unwrap();
    let refused = Command::new("./once").current_dir(&folder).args(["--device", "/nowhere"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    insta::assert_snapshot!(String::from_utf8(refused.stderr).unwrap(), @"error: there is no file `bend.csv` in the current folder, and the plan replays its path; `--paths FOLDER` says where it is");
}
