//! Tests the effects of the target's options, and that wrong options are rejected before anything moves.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Pace, Refusal, StopRequest, Target, Time, view_options};
use mdle_runtime::{Robot, Twist};
use mdle_sim::Sim;

fn matches(options: &[&str]) -> ArgMatches {
    Sim::arguments(view_options(Command::new("plan").no_binary_name(true)))
        .try_get_matches_from(options)
        .expect("known options")
}

/// Returns the error message with which these options are rejected.
fn refused(options: &[&str]) -> String {
    match Sim::connect(&matches(options), Sim::PERIOD, &StopRequest::default()) {
        Ok(_) => panic!("{options:?} were accepted"),
        Err(Refusal::Usage(sentence)) => sentence,
        Err(refusal @ (Refusal::Fault(_) | Refusal::Ended(_))) => panic!("{refusal:?}"),
    }
}

/// Returns an empty folder for this test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder of our own");
    folder
}

#[test]
fn speed_is_real_by_default() {
    let speed = |options: &[&str]| Sim::time(&matches(options));
    assert_eq!(speed(&[]), Ok(Time::Stepped(Pace::Times(1.0))));
    assert_eq!(speed(&["--speed", "real"]), Ok(Time::Stepped(Pace::Times(1.0))));
    assert_eq!(speed(&["--speed", "max"]), Ok(Time::Stepped(Pace::Max)));
    assert_eq!(speed(&["--speed", "2.5"]), Ok(Time::Stepped(Pace::Times(2.5))));
    for nonsense in ["0", "-1", "nan", "inf", "fast", "", "MAX", "1e999"] {
        let sentence = speed(&["--speed", nonsense]).expect_err(nonsense);
        assert!(sentence.contains("as in `--speed 10`"), "{sentence}");
    }
}

#[test]
fn bad_starts_are_refused_with_a_hint() {
    let sentences = ["1,2", "-0.6,2,0", "3.65,4.25,0", "11.5,5,0"].map(|start| refused(&["--start", start]));
    insta::assert_snapshot!(sentences.join("\n"), @r#"
    --start 1,2: expected x,y,heading: three numbers in metres and degrees, as in `0.1,-0.05,90`
    --start -0.6,2,0: the robot, 0.205 m around its centre, would stand in "A west"; there is room at `--start -0.3,2,0`
    --start 3.65,4.25,0: the robot would stand inside "obstacle"; there is room at `--start 3.65,4.85,0`
    --start 11.5,5,0: the robot would stand outside the walls of the world; the world's own start is `--start 0,0,0`
    "#);
}

#[test]
fn a_noise_that_finds_no_start_is_named() {
    let cell = folder("cell").join("cell.toml");
    let around = "[[wall]]\npoints = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25], [-0.25, -0.25]]";
    fs::write(&cell, around).expect("a file of our own");
    let world = cell.to_str().expect("UTF-8");
    let sentence = refused(&["--world", world, "--body", "scout", "--seed", "1", "--start-noise", "50,180"]);
    let runs = matches(&["--world", world, "--body", "scout", "--runs", "3", "--start-noise", "50,180"]);
    let batch = (Sim::OBSERVATION.expect("simulated").batch)(&runs, Sim::PERIOD);
    assert!(matches!(batch, Err(Refusal::Usage(of_batch)) if of_batch == sentence), "the same refusal");
    insta::assert_snapshot!(sentence, @"--start-noise: no random start has room; the last one tried: the robot would stand outside the walls of the world; give less, as in `0.1,5`");
}

/// The start of the world has room for a disc, but not for an ATRV-mini.
#[test]
fn no_hint_names_a_start_without_room() {
    let walls = |far: f64, heading: f64| {
        let points = format!("[[-5, 0], [5, 0], [5, {far}], [-5, {far}], [-5, 0]]");
        format!("start = {{ y = 0.25, heading = {heading} }}\n[[wall]]\nname = \"side\"\npoints = {points}")
    };
    let folder = folder("no_room");
    let world = |name: &str, far: f64, heading: f64| {
        let path = folder.join(name);
        fs::write(&path, walls(far, heading)).expect("a file of our own");
        path.to_str().expect("UTF-8").to_owned()
    };
    let wide = world("wide.toml", 2.0, 0.0);
    let (across, narrow) = (world("across.toml", 0.65, 90.0), world("narrow.toml", 0.5, 0.0));
    let starts = [&wide, &across, &narrow].map(|world| refused(&["--body", "atrv", "--world", world]));
    let given = refused(&["--body", "atrv", "--world", &wide, "--start", "0,0.1,0"]);
    let sentences = [&starts[..], &[given]].concat().join("\n").replace(&format!("{}/", folder.display()), "");
    insta::assert_snapshot!(sentences, @r#"
    wide.toml:1:9: the robot, 0.63 m long and 0.54 m wide, would stand in "side"; there is room at `--start 0,0.55,0`
    across.toml:1:9: the robot, 0.63 m long and 0.54 m wide, would stand in "side"; there is room at `--start 0,0.35,180`
    narrow.toml:1:9: the robot, 0.63 m long and 0.54 m wide, would stand in "side"; no place with room was found within 2 m of this start
    --start 0,0.1,0: the robot, 0.63 m long and 0.54 m wide, would stand in "side"; there is room at `--start 0,0.5,0`
    "#);
    for (world, start) in [(&wide, "0,0.55,0"), (&wide, "0,0.5,0"), (&across, "0,0.35,180")] {
        let options = matches(&["--body", "atrv", "--world", world, "--start", start]);
        assert!(Sim::connect(&options, Sim::PERIOD, &StopRequest::default()).is_ok());
    }
    assert!(Sim::connect(&matches(&["--world", &wide]), Sim::PERIOD, &StopRequest::default()).is_ok());
}

#[test]
fn a_start_outside_the_walls_around_the_goal_is_refused_with_its_place() {
    let path = folder("outside").join("outside.toml");
    let room = "[[wall]]\nname = \"room\"\npoints = [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]]";
    let text = format!("start = {{ x = -1, y = 1 }}\ngoal = {{ min = [1, 1], max = [2, 2] }}\n{room}");
    fs::write(&path, text).expect("a file of our own");
    let sentence = refused(&["--world", path.to_str().expect("UTF-8")]);
    let sentence = sentence.rsplit_once('/').expect("a path").1;
    insta::assert_snapshot!(sentence, @r#"outside.toml:1:9: the robot would stand outside "room", and the goal or the charger is inside; there is room at `--start 0.5,1,0`"#);
}

#[test]
fn bad_worlds_are_refused() {
    let folder = folder("worlds");
    let world = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, bytes).expect("a file of our own");
        refused(&["--world", path.to_str().expect("UTF-8")])
    };
    assert!(world("typo.toml", b"[[wall]]\npoinst = 3").contains("typo.toml:2:1: unknown field `poinst`"));
    assert!(world("bytes.toml", b"\xff\xfe").ends_with("bytes.toml: the file is not UTF-8 text"));
    assert!(world("boxed.toml", b"[[box]]\nmin = [-1, -1]\nmax = [1, 1]").contains("inside \"box 1\""));
    let worlds = "there is no such world or file; the worlds are office, maze, hall, room";
    assert!(refused(&["--world", folder.join("missing.toml").to_str().expect("UTF-8")]).ends_with(worlds));
    assert_eq!(refused(&["--world", "moon"]), format!("--world moon: {worlds}"));
    assert!(refused(&["--world", folder.to_str().expect("UTF-8")]).contains("cannot be read"));
}

#[test]
fn outputs_of_other_formats_are_refused() {
    let error = |option: &str, file: &str| {
        let command = Sim::arguments(view_options(Command::new("plan").no_binary_name(true)));
        let error = command.try_get_matches_from([option, file]).expect_err(file).to_string();
        error.lines().next().unwrap_or_default().to_owned()
    };
    let outputs = [("--plot", "a.png"), ("--record", "out/a.mp4"), ("--trail", "a.xlsx")];
    insta::assert_snapshot!(outputs.map(|(option, file)| error(option, file)).join("\n"), @"
    error: invalid value 'a.png' for '--plot <FILE.svg>': this option writes SVG, not PNG; name the file `a.svg`
    error: invalid value 'out/a.mp4' for '--record <FILE.svg>': this option writes SVG, not MP4; name the file `out/a.svg`
    error: invalid value 'a.xlsx' for '--trail <FILE.csv>': this option writes CSV, not XLSX; name the file `a.csv`
    ");
}

#[test]
fn a_plot_that_could_not_be_written_is_refused_and_leaves_nothing() {
    let folder = folder("plots");
    let plot = |path: PathBuf| refused(&["--plot", path.to_str().expect("UTF-8")]);
    assert!(plot(folder.join("none/plot.svg")).contains("the folder does not exist"));
    assert!(plot(folder.clone()).contains("that is a folder"));
    assert!(plot(PathBuf::from("/dev/null")).contains("not a regular file"));
    fs::write(folder.join("file"), "").expect("a file of our own");
    assert!(plot(folder.join("file/plot.svg")).contains("nothing can be written there"));
    let good = folder.join("plot.svg");
    assert!(
        Sim::connect(&matches(&["--plot", good.to_str().expect("UTF-8")]), Sim::PERIOD, &StopRequest::default())
            .is_ok()
    );
    assert!(!good.exists(), "nothing is written before the run is finished");
    assert_eq!(fs::read_dir(&folder).expect("our folder").count(), 1);
}

#[test]
fn an_input_that_is_not_a_number_is_a_fault() {
    let mut robot = Sim::connect(&matches(&[]), Sim::PERIOD, &StopRequest::default()).expect("no bad options");
    let mut input = Twist::default();
    input.omega.0 = f64::NAN;
    let fault = robot.exchange(&input).expect_err("nonsense");
    assert_eq!(fault.to_string(), "the plan asked for a speed that is not a number");
}

#[test]
fn the_target_is_what_its_alphabet_says() {
    let alphabet = include_str!("../alphabet.mdle");
    let target = alphabet.lines().find(|line| line.starts_with("target ")).expect("a target");
    let message = format!("target {} : crate mdle_sim, period {}ms;", Sim::NAME, Sim::PERIOD.as_millis());
    assert_eq!(target, message);
}

#[test]
fn a_world_is_a_name_a_file_or_a_map() {
    let folder = folder("maps");
    let connect = |world: &str| {
        Sim::connect(&matches(&["--world", world]), Sim::PERIOD, &StopRequest::default()).map(|robot| robot.pose())
    };
    assert!(connect("maze").is_ok());
    fs::write(folder.join("map.pgm"), [&b"P5 9 9 255\n"[..], &[254; 80], &[0]].concat()).expect("a file of our own");
    let yaml = folder.join("map.yaml");
    fs::write(&yaml, "image: map.pgm\nresolution: 1.0\norigin: [-4.5, -4.5, 0.0]\n").expect("a file of our own");
    assert!(connect(yaml.to_str().expect("UTF-8")).is_ok());
    fs::remove_file(folder.join("map.pgm")).expect("our own file");
    assert!(refused(&["--world", yaml.to_str().expect("UTF-8")]).contains("map.pgm: the file cannot be read"));
}

#[test]
fn a_body_and_its_parts_are_named() {
    let connect = |options: &[&str]| {
        Sim::connect(&matches(options), Sim::PERIOD, &StopRequest::default()).map(|robot| robot.pose())
    };
    assert!(connect(&["--body", "scout", "--without", "specular, slip,order", "--seed", "3"]).is_ok());
    assert!(connect(&["--body", "atrv", "--without", ""]).is_ok());
    let sentences =
        [&["--body", "pioneer"][..], &["--without", "order,lobes"], &["--without", "lobe,,slip"]].map(refused);
    insta::assert_snapshot!(sentences.join("\n"), @r#"
    --body pioneer: expected `ideal`, `scout` or `atrv`
    --without order,lobes: "lobes" is no part of a body; expected some of lobe, specular, minimum, steps, noise, outliers, order, slip
    --without lobe,,slip: "" is no part of a body; expected some of lobe, specular, minimum, steps, noise, outliers, order, slip
    "#);
}
