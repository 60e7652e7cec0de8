//! Tests `mdle run PLAN --records PATH`: while the plan runs, the recorded way back replaces the path that was driven.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

const PLAN: &str = "{ There (wait 1min)\n  (Atom (null) path(way))\n  (Atom (wait 1) stop)\n  (Atom (wait 8) turn 180)\n  \
                    (Atom (null) path(way))\n  (Atom (wait 1) stop)\n}\n";
/// A path of 1.9 m with a bend to the left.
const WAY: &str =
    "time s, heading deg, speed cm/s\n0, 0, 0\n0.5, 0, 50\n1.3, 0, 50\n2, 0, 50\n3, 30, 50\n4, 60, 50\n4.5, 60, 0\n";

fn run(folder: &Path, options: &str) -> Output {
    let line = format!("run there.mdle --target sim --world floor.toml --speed max{options}");
    Command::new(mdle()).args(line.split(' ')).current_dir(folder).output().unwrap()
}

fn prepared(test: &str) -> std::path::PathBuf {
    let folder = folder(test);
    fs::write(folder.join("there.mdle"), PLAN).unwrap();
    fs::write(folder.join("way.csv"), WAY).unwrap();
    fs::write(folder.join("floor.toml"), "[[wall]]\npoints = [[-9, -9], [9, -9], [9, 9], [-9, 9], [-9, -9]]\n")
        .unwrap();
    folder
}

#[test]
fn a_recorded_way_leads_back() {
    let folder = prepared("back");
    let output = run(&folder, " --records way --trail trail.csv --log run.mcap");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let trail = fs::read_to_string(folder.join("trail.csv")).unwrap();
    let places = trail.lines().skip(1).map(|line| {
        let number = |column: usize| line.split(',').nth(column).unwrap().parse::<f64>().unwrap();
        libm::hypot(number(1), number(2))
    });
    let (far, end) = places.fold((0.0, 0.0), |(far, _): (f64, f64), off| (far.max(off), off));
    assert!(far > 1.7 && end < 0.2, "{far} m away, and {end} m off at the end");
    assert_eq!(fs::read_to_string(folder.join("way.csv")).unwrap(), WAY, "the file stays");
    let replayed = Command::new(mdle()).args(["replay", "run.mcap"]).current_dir(&folder).output().unwrap();
    let text = String::from_utf8(replayed.stdout).unwrap();
    assert!(text.starts_with("the same to the bit, ") && replayed.status.success(), "{text}");
}

#[test]
fn a_path_that_is_recorded_may_be_missing() {
    let folder = prepared("missing");
    fs::remove_file(folder.join("way.csv")).unwrap();
    let refused = run(&folder, "");
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stdout));
    for options in [" --records way", " --records way --paths gone"] {
        let output = run(&folder, options);
        let report = String::from_utf8(output.stdout).unwrap();
        assert!(
            output.status.success() && report.contains("plan over: wait 1min"),
            "without a path it stands: {report}"
        );
    }
    for (options, folder_name) in [(" --paths gone", "gone"), (" --records way --paths there.mdle", "there.mdle")] {
        let refused = String::from_utf8(run(&folder, options).stderr).unwrap();
        assert!(refused.contains(&format!("--paths {folder_name}: there is no such folder")), "{refused}");
    }
}

#[test]
fn a_wrong_name_of_a_recorded_path_is_refused() {
    let folder = prepared("wrong");
    let output = run(&folder, " --records wey");
    let refused = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{refused}");
    assert!(refused.contains("--records wey: the plan replays no path `wey`; did you mean `way`?"), "{refused}");
}
