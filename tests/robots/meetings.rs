//! Tests `rendezvous`, `sync` and `Follow` between robots of a scenario, and the messages about wrong scenarios.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

/// Runs a scenario in which the robots `ada` and `bob`, 3 m apart, run these plans. Returns the report.
fn meets(test: &str, more: &str, ada: &str, bob: &str) -> String {
    let folder = folder(test);
    let mut text = more.to_owned();
    for (number, (name, plan)) in [("ada", ada), ("bob", bob)].into_iter().enumerate() {
        fs::write(folder.join(format!("{name}.mdle")), plan).unwrap();
        let start = 3 * number;
        text += &format!("[[robot]]\nname = \"{name}\"\nfile = \"{name}.mdle\"\nstart = \"{start}, 0, 180\"\n");
    }
    fs::write(folder.join("two.toml"), text).unwrap();
    let output = run(&folder, &["two.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let arguments = ["run"].iter().chain(arguments);
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// Returns the time and the first word of each line of the report about a robot.
fn course<'r>(report: &'r str, robot: &str) -> Vec<(&'r str, &'r str)> {
    let named = format!(" s  {robot}: ");
    let lines = report.lines().filter_map(|line| line.split_once(&named));
    lines.map(|(time, rest)| (time, rest.split(' ').next().unwrap())).collect()
}

#[test]
fn two_rounds_in_a_row_are_two_meetings() {
    let ada = "{ A (wait 1min) (Atom (rendezvous bob) stop) (Atom (rendezvous bob) stop) (Atom (wait 1) (go 0 0)) }";
    let bob = "{ B (wait 1min) (Atom (wait 2) (go 0 0)) (Atom (rendezvous ada) stop) (Atom (wait 3) (go 0 0))
        (Atom (rendezvous ada) stop) (Atom (wait 1) (go 0 0)) }";
    let report = meets("meet_twice", "", ada, bob);
    assert_eq!(course(&report, "ada"), [("2.1", "stop"), ("5.2", "go"), ("6.2", "plan")], "{report}");
    assert_eq!(
        course(&report, "bob"),
        [("2.0", "stop"), ("2.1", "go"), ("5.1", "stop"), ("5.2", "go"), ("6.2", "plan")]
    );
}

#[test]
fn a_skipped_round_counts() {
    let ada = "{ A (wait 1min) (Atom (rendezvous bob OR NOT bumper) stop) (Atom (wait 5) (go 0 0)) }";
    let bob = "{ B (wait 1min) (Atom (rendezvous ada) stop) (Atom (rendezvous ada OR wait 3) stop) }";
    let report = meets("meet_skipped", "", ada, bob);
    assert_eq!(course(&report, "bob"), [("0.1", "stop"), ("3.1", "plan")], "{report}");
}

#[test]
fn rounds_in_loops_and_behaviors_are_counted() {
    let ada = "{ A (wait 1min) ExecPlan 3 { { Leg (rendezvous bob) (Atom (null) stop) } (Atom (wait 1) (go 0 0)) } }";
    let bob = "{ B (wait 1min) ((Atom (rendezvous ada) stop) (Atom (wait 2) (go 0 0)))^3 }";
    let report = meets("meet_loops", "[link]\nlatency = \"0ms..300ms\"\nloss = 0.3\n", ada, bob);
    let meetings: Vec<_> = course(&report, "ada").into_iter().filter(|(_, law)| *law == "go").collect();
    assert_eq!(meetings.len(), 3, "{report}");
    let seconds = |number: usize| meetings[number].0.parse::<f64>().unwrap();
    assert!(seconds(1) - seconds(0) >= 2.0 && seconds(2) - seconds(1) >= 2.0, "bob is slower: {report}");
}

#[test]
fn sync_is_true_while_states_arrive() {
    let ada = "{ A (wait 1min) (Atom (sync bob) stop) (Atom (NOT sync bob) (go 0 0)) }";
    let bob = "{ B (Atom (wait 2) stop) }";
    let report = meets("sync_ends", "", ada, bob);
    // The last state that bob sends is that of the turn in which its plan is over; it arrives a turn later.
    assert_eq!(course(&report, "ada"), [("0.1", "go"), ("2.6", "plan")], "{report}");
}

#[test]
fn a_follower_stops_behind_its_leader_and_hears_it() {
    let ada = "{ A (bumper OR wait 1min) (Atom (wait 1) stop) (Atom (null) Follow(bob)) }";
    let bob = "{ B (bumper OR wait 1min) (Atom (wait 1) turn 90) (Atom (wait 5) (go -30 0.3)) (Atom (wait 9) stop) }";
    let report = meets("follow", "", ada, bob);
    assert!(report.contains("ada: plan over: completed"), "{report}");
    let gap = report.lines().last().unwrap();
    assert!(gap.starts_with("least gap between robots: ") && gap.ends_with("(ada and bob)"), "{gap}");
    let ada = "{ A (wait 1min) (Atom (r0 < 2.7m AND t > 1) stop) }";
    let report = meets("hears", "", &ada.replace("r0", "r8"), "{ B (Atom (wait 3) stop) }");
    assert!(report.contains("ada: plan over: r8 = 2.6 m"), "the other is behind: {report}");
}

#[test]
fn robots_touch_each_other() {
    let ada = "{ A (bumper) (Atom (null) (go -30 0)) }";
    let report = meets("touch", "timeout = \"30s\"\n", ada, "{ B (bumper) (Atom (null) stop) }");
    let [ada, bob] = ["ada", "bob"].map(|robot| course(&report, robot));
    assert_eq!((ada.len(), &ada), (1, &bob), "both feel it in the same turn: {report}");
    assert!(report.ends_with("least gap between robots: 0.0 cm (ada and bob)\n"), "{report}");
}

#[test]
fn a_wrong_scenario_is_refused_with_place_and_cure() {
    let folder = folder("scenario_errors");
    fs::write(folder.join("stand.mdle"), "{ Stand (Atom (wait 1) stop) }\n").unwrap();
    fs::write(folder.join("meet.mdle"), "{ Meet (wait 9) (Atom (sync robot2) stop) }\n").unwrap();
    fs::write(folder.join("replay.mdle"), "{ Replay (wait 9) (Atom (null) path(way)) }\n").unwrap();
    fs::write(folder.join("walker.toml"), "[[box]]\nsize = [1, 1]\nschedule = [[0, 9, 0], [4, 5, 0]]\n").unwrap();
    let robot = |name: &str, file: &str, start: &str| {
        format!("[[robot]]\nname = \"{name}\"\nfile = \"{file}.mdle\"\nstart = \"{start}\"\n")
    };
    let stand = |name: &str, start: &str| robot(name, "stand", start);
    let texts = [
        stand("robot1", "0,0,0") + &stand("robot1", "1,0,0"),
        stand("robot1", "0,0,0") + &stand("robot2", "0.4,0,0"),
        stand("robot1", "0,0") + &stand("robot2", "1,0,0"),
        robot("robot1", "meet", "0,0,0") + &stand("robot_2", "1,0,0"),
        robot("robot2", "meet", "0,0,0"),
        robot("robot1", "none", "0,0,0"),
        robot("robot1", "replay", "0,0,0"),
        robot("robot1", "replay", "0,0,0") + "records = \"ways\"\n",
        stand("robot1", "0,0,0") + "body = \"round\"\n",
        stand("robot1", "0,0,0") + "killed = \"soon\"\n",
        stand("robot1", "0,0,0") + "colour = \"red\"\n",
        stand("robot1", "0,0,0") + "ears = \"8.75cm\"\n",
        stand("robot1", "0,0,0") + "ears = \"2m\"\n",
        "world = \"rom\"\n".to_owned() + &stand("robot1", "0,0,0"),
        "world = \"walker.toml\"\n".to_owned() + &stand("robot1", "0,0,0"),
        "world = \"room\"\n".to_owned() + &stand("robot1", "0,0,0"),
        "[link]\nloss = 1.5\n".to_owned() + &stand("robot1", "0,0,0"),
        "[link]\nlatency = \"200ms..0ms\"\n".to_owned() + &stand("robot1", "0,0,0"),
        "seed = 1\n".to_owned(),
        "[[robot]\n".to_owned(),
    ];
    let messages = texts.map(|text| {
        fs::write(folder.join("s.toml"), &text).unwrap();
        let output = run(&folder, &["s.toml"]);
        assert_eq!(output.stdout, b"");
        format!("{text}{}[{}]\n", String::from_utf8_lossy(&output.stderr), output.status.code().unwrap())
    });
    insta::assert_snapshot!(messages.join("\n"));
    fs::write(folder.join("s.toml"), stand("robot1", "0,0,0")).unwrap();
    for arguments in
        [&["s.toml", "--target", "sim"][..], &["s.toml", "--log", "/none/a.jsonl"], &["s.toml", "--sed", "1"]]
    {
        let output = run(&folder, arguments);
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
