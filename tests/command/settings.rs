//! Tests `mdle.toml` beside a plan (docs/src/reference/interfaces.md, 1.4): the settings that commands take from it,
//! and its errors.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Output;

use mdle_tests::executable::{folder, run_mdlec};

/// A plan that any robot with a bumper can run.
const PLAN: &str = "{ P (bumper)\n  (Atom (wait 1s) (go 20 0))\n}\n";

/// A third-party robot without a bumper.
const CART: &str = "target cart : crate cart, period 100ms;\ncapability diff_drive, odometry;\nuse atoms;\n";

/// A world that differs from all other worlds in its start.
const WORLD: &str = "start = { x = 7.25, y = 1.5, heading = 90 }\n";

/// Returns a folder with the folder `home`, which contains a plan, a robot, a world and these settings.
fn home(test: &str, settings: &str) -> PathBuf {
    let folder = folder(test);
    for (name, text) in [("plan.mdle", PLAN), ("cart/alphabet.mdle", CART), ("rooms/own.toml", WORLD)] {
        let file = folder.join("home").join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    fs::write(folder.join("home/mdle.toml"), settings).unwrap();
    folder
}

/// Returns standard error and the exit status, without the parts that depend on earlier builds.
fn message(folder: &Path, arguments: &[&str]) -> String {
    let output = run_mdlec(folder, arguments);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{arguments:?}");
    let text = std::str::from_utf8(&output.stderr).unwrap();
    let is_progress = |line: &&str| line.starts_with("compiling ") || line.contains(": built in ");
    let text: String = text.lines().filter(|line| !is_progress(line)).map(|line| format!("{line}\n")).collect();
    format!("$ mdlec {}\n{text}exit status {}\n", arguments.join(" "), output.status.code().unwrap())
}

fn assert_success(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Returns the line about the first turn of a run in the run's trail, which contains the pose.
fn first_pose(folder: &Path) -> String {
    let trail = fs::read_to_string(folder.join("trail.csv")).unwrap();
    trail.lines().nth(1).unwrap().to_owned()
}

#[test]
fn a_run_takes_its_robot_world_and_options() {
    let settings = "target = \"sim\"\nworld = \"rooms/own.toml\"\n\
                    [options]\nspeed = \"max\"\ntrail = \"trail.csv\"\nperiod = 0.25\nwatch = false\n";
    let folder = home("settings_run", settings);
    for arguments in [&["run", "home/plan.mdle"][..], &["home/plan.mdle", "--run"]] {
        let output = run_mdlec(&folder, arguments);
        assert_success(&output);
        assert_eq!(String::from_utf8_lossy(&output.stdout), "1.0 s  plan over: wait 1s (plan.mdle:2)\n");
        assert!(first_pose(&folder).starts_with("0,7.25,1.5,90"), "{}", first_pose(&folder));
        let trail = fs::read_to_string(folder.join("trail.csv")).unwrap();
        assert!(trail.contains("\n0.25,"), "a period of 0.25 s: {trail}");
        fs::remove_file(folder.join("trail.csv")).unwrap();
    }
}

#[test]
fn options_of_the_command_line_win() {
    let settings = "target = \"sim\"\nworld = \"rooms/own.toml\"\n\
                    [options]\nspeed = \"max\"\ntrail = \"no/folder.csv\"\nturns = 2\n";
    let folder = home("settings_win", settings);
    let run = |arguments: &[&str]| run_mdlec(&folder, &[&["run", "home/plan.mdle", "--"][..], arguments].concat());
    assert_success(&run(&["--trail", "trail.csv", "--turns=1000"]));
    assert!(first_pose(&folder).starts_with("0,7.25,"), "{}", first_pose(&folder));
    let cut_short = run(&["--trail=trail.csv", "--world", "home/rooms/own.toml", "--start", "1,2,0"]);
    assert_eq!(cut_short.status.code(), Some(4), "{}", String::from_utf8_lossy(&cut_short.stderr));
    assert!(first_pose(&folder).starts_with("0,1,2,0"), "{}", first_pose(&folder));
}

#[test]
fn options_are_for_the_robot_of_the_file() {
    let folder = home("settings_other", "target = \"./cart\"\n[options]\nturns = 1\nport = \"/dev/null\"\n");
    let run = |target: &str| run_mdlec(&folder, &["run", "home/plan.mdle", "--target", target, "--", "--speed", "max"]);
    assert_success(&run("sim"));
    fs::write(folder.join("home/mdle.toml"), "[options]\nturns = 1\n").unwrap();
    assert_eq!(run("sim").status.code(), Some(4), "options without a target are for every robot");
}

#[test]
fn every_command_takes_the_robot_of_the_file() {
    let folder = home("settings_commands", "target = \"cart\"\n");
    fs::write(folder.join("script"), "{\"t\": 0}\n").unwrap();
    for arguments in [
        &["check"][..],
        &["build"],
        &["run"],
        &["--emit", "plan"],
        &["--emit", "rust"],
        &["--emit", "matrices"],
        &["analyze"],
        &["draw"],
        &["trace", "--script", "script"],
    ] {
        let refused = message(&folder, &[arguments, &["home/plan.mdle"]].concat());
        assert!(refused.contains("error[E0401]: `cart` cannot") && refused.ends_with("status 1\n"), "{refused}");
    }
    let output = run_mdlec(&folder, &["check", "home/plan.mdle", "--target", "sim"]);
    assert_success(&output);
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    let both = message(&folder, &["check", "plan.mdle", "home/plan.mdle"]);
    assert_eq!(both.matches("error[E0401]").count(), 1, "the other plan has no file beside it: {both}");
}

#[test]
fn errors_name_the_file_and_the_line() {
    let settings = [
        "target = \"sim\"\ntagret = \"sim\"\n",
        "target = 7\n",
        "target = sim\n",
        "target = \"sin\"\n",
        "target = \"../rover\"\n",
        "target = \"sim\"\nworld = \"rooms/other.toml\"\n",
        "target = \"sim\"\nworld = \"hal\"\n",
        "target = \"sim\"\n[options]\nsped = \"max\"\n",
        "target = \"sim\"\n[options]\nspeed = true\n",
        "target = \"sim\"\n[options]\nspeed = \"max\"\nturns = 0\n",
        "target = \"sim\"\n[options]\nwatch = \"yes\"\n",
        "target = \"sim\"\n\n[options]\nworld = \"hall\"\n",
        "\"\\u001b[2J\" = 1\n",
    ];
    let folder = home("settings_errors", "");
    let messages = settings.map(|text| {
        fs::write(folder.join("home/mdle.toml"), text).unwrap();
        format!("{text}{}", message(&folder, &["run", "home/plan.mdle"]))
    });
    insta::assert_snapshot!(messages.join("\n"));
    let unknown = message(&folder, &["check", "home/plan.mdle"]);
    assert!(unknown.contains("home/mdle.toml:1: there is no key"), "a check reads it too: {unknown}");
}

#[test]
fn wrong_options_are_found_before_a_build() {
    let folder = home("settings_early", "");
    for option in ["sped = \"max\"", "speed = true", "watch = \"yes\"", "watch = [1]", "sped = false"] {
        fs::write(folder.join("home/mdle.toml"), format!("target = \"sim\"\n[options]\n{option}\n")).unwrap();
        for command in ["check", "run"] {
            let refused = message(&folder, &[command, "home/plan.mdle"]);
            assert!(refused.contains("error: home/mdle.toml:3: ") && refused.ends_with("status 2\n"), "{refused}");
        }
        assert!(!folder.join("plan").exists(), "nothing is built");
    }
    // The options of a user's own robot are known to its executable only.
    fs::write(folder.join("home/mdle.toml"), "target = \"cart\"\n[options]\nsped = \"max\"\n").unwrap();
    assert!(message(&folder, &["check", "home/plan.mdle"]).contains("error[E0401]"));
}

#[test]
fn a_check_names_a_world_that_is_none() {
    let folder = home("settings_world", "target = \"sim\"\nworld = \"hal\"\n");
    let refusal = "error: home/mdle.toml:2: there is no such world or file: `hal`; the worlds are";
    let unknown = message(&folder, &["check", "home/plan.mdle"]);
    assert!(unknown.contains(&format!("{refusal} hall, maze, office, room\nexit status 2\n")), "{unknown}");
    // The error is reported before anything is built.
    assert!(message(&folder, &["run", "home/plan.mdle"]).contains(refusal));
    assert!(!folder.join("plan").exists());
    // The setting is not an error if the command line names another robot, or if the folder contains a file with this
    // name.
    assert!(message(&folder, &["check", "home/plan.mdle", "--target", "scout"]).ends_with("exit status 0\n"));
    fs::write(folder.join("home/hal"), WORLD).unwrap();
    assert!(message(&folder, &["check", "home/plan.mdle"]).ends_with("exit status 0\n"));
}

#[test]
fn an_executable_has_no_safety_rules() {
    let folder = home("settings_safety", "target = \"sim\"\nsafety = \"rules.toml\"\n");
    let refused = "error: home/mdle.toml:2: `mdlec run` has no safety rules\nhelp: use `mdle run home/plan.mdle`\n";
    for arguments in [&["run", "home/plan.mdle"][..], &["home/plan.mdle", "--run"]] {
        let run = message(&folder, arguments);
        assert!(run.ends_with(&format!("{refused}exit status 2\n")), "{run}");
    }
    assert!(!folder.join("plan").exists(), "nothing is built");
    assert!(message(&folder, &["check", "home/plan.mdle"]).ends_with("exit status 0\n"));
}

#[test]
fn the_file_is_a_regular_one_of_text() {
    let folder = home("settings_files", "");
    let file = folder.join("home/mdle.toml");
    fs::write(&file, b"target = \"caf\xE9\"\n").unwrap();
    let mut messages = vec![message(&folder, &["run", "home/plan.mdle"])];
    File::create(&file).unwrap().set_len(1 << 40).unwrap();
    messages.push(message(&folder, &["check", "home/plan.mdle"]));
    fs::remove_file(&file).unwrap();
    fs::create_dir(&file).unwrap();
    messages.push(message(&folder, &["check", "home/plan.mdle"]));
    insta::assert_snapshot!(messages.join("\n"));
}

#[test]
fn no_output_goes_over_the_file() {
    let folder = home("settings_output", "target = \"sim\"\n");
    let build = message(&folder, &["build", "home/plan.mdle", "-o", "home/mdle.toml"]);
    assert!(build.contains("home/mdle.toml") && build.ends_with("exit status 2\n"), "{build}");
    let draw = message(&folder, &["draw", "home/plan.mdle", "-o", "home/cart/../mdle.toml"]);
    assert!(draw.ends_with("exit status 2\n"), "{draw}");
    assert_eq!(fs::read_to_string(folder.join("home/mdle.toml")).unwrap(), "target = \"sim\"\n");
}

#[test]
fn a_scenario_is_checked_for_the_robot_that_it_is_built_for() {
    let folder = home("settings_scenario", "target = \"scout\"\n");
    let robot = "[[robot]]\nname = \"one\"\nfile = \"plan.mdle\"\nstart = \"0, 0, 0\"\n";
    fs::write(folder.join("home/one.toml"), robot).unwrap();
    let refusal = "error: `home/one.toml` is a scenario, whose robots are simulated, and the target is `scout`";
    for arguments in [&["check", "home/one.toml"][..], &["home/one.toml"]] {
        let text = message(&folder, arguments);
        assert!(text.contains(refusal) && text.ends_with("exit status 2\n"), "{text}");
    }
    assert!(message(&folder, &["check", "home/one.toml", "--target", "sim"]).ends_with("exit status 0\n"));
}
