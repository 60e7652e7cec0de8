//! Tests `mdle navigate` and `mdle map` on the paper's office floor (docs/src/navigation.md).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod reckoning;

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use mdle_tests::chance::repeated;
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;

/// Runs `mdle` with these arguments in a folder.
fn run(folder: &Path, words: &[&str]) -> Output {
    Command::new(mdle()).args(words).current_dir(folder).output().unwrap()
}

/// Returns standard output, standard error and the exit status as text.
fn text(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
    format!("{out}{err}[{}]\n", output.status.code().unwrap())
}

/// Navigates by the repository's graph in the simulator, at maximum speed.
fn navigate(folder: &Path, words: &[&str]) -> Output {
    let graph = root().join("plans/navigation/office.mdle");
    let usual = ["--target", "sim", "--speed", "max"];
    run(folder, &[&["navigate", graph.to_str().unwrap()], words, &usual].concat())
}

/// Returns the lines about the route and the landmarks.
fn landmarks(output: &Output) -> String {
    let text = text(output);
    let is_about = |line: &&str| line.contains("route: ") || line.contains(" at ") || line.starts_with("at ");
    text.lines().filter(is_about).collect::<Vec<_>>().join("\n")
}

/// Returns a folder with a graph of four landmarks. Its edges are a plan that ends, a plan that never ends, a plan that
/// its timer cuts short, and two plans that end only by their own conditions.
fn small_graph(test: &str) -> PathBuf {
    let folder = folder(test);
    let graph = "Γ_a^b = { AToB (bumper) (Atom (wait 1s) (go 20 0)) }\n\
                 Γ_b^c = { BToC (Atom (null) (go 0 0)) (Atom (wait 1s) (go 20 0)) }\n\
                 Γ_b^d = { BToD (bumper OR wait 2s) (Atom (x > 100m) (go 5 0)) }\n\
                 Γ_c^d = { CToD (bumper) (Atom (null) (go 5 0)) }\n\
                 Γ_d^b = { DToB (wait 2h) ExecPlan inf { (Atom (wait 1) (go 5 0.5)) } }\n";
    fs::write(folder.join("graph.mdle"), graph).unwrap();
    folder
}

#[test]
fn a_route_of_one_plan_is_driven() {
    let folder = folder("navigation_one");
    let words = ["office", "lab1", "--start", "11.5,0,270", "--goal", "7.45,0.3,0.8,270,15"];
    let output = navigate(&folder, &words);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    insta::assert_snapshot!(landmarks(&output), @r#"
    route: office -> lab1 (OfficeToLab1Plan)
    at office
    at lab1
    "#);
}

#[test]
fn a_route_of_two_plans_is_driven() {
    let folder = folder("navigation_two");
    let graph = fs::read_to_string(root().join("plans/navigation/office.mdle")).unwrap();
    let without = graph.replace("Γ_lab2^office = ", "");
    fs::write(folder.join("office.mdle"), without).unwrap();
    fs::copy(root().join("plans/navigation/landmarks.toml"), folder.join("landmarks.toml")).unwrap();
    let goal = ["--goal", "world"];
    let words = ["navigate", "office.mdle", "lab2", "office", "--target", "sim", "--body", "scout", "--seed", "1"];
    let output = run(&folder, &[&words[..], &["--speed", "max"], &goal].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    insta::assert_snapshot!(landmarks(&output), @r#"
    route: lab2 -> lab1 (Lab2ToLab1Plan) -> office (Lab1ToOfficePlan)
    at lab2
    at lab1
    at office
    "#);
}

/// While this Scout turned fast into the hallway, one sonar missed the wall behind and the next one had a range at
/// random: the plan took the place for the first way on the right, and turned there without end.
#[test]
fn a_place_that_a_turning_robot_mishears_is_no_landmark() {
    let plan = root().join("plans/navigation/office.mdle");
    let words = ["run", plan.to_str().unwrap(), "--plan", "Lab2ToLab1Plan", "--target", "sim", "--speed", "max"];
    let start = ["--body", "scout", "--start", "0,0,0", "--start-noise", "10cm,5deg", "--seed", "9954556"];
    let goal = ["--world", "office", "--timeout", "300", "--goal", "7.45,0.3,0.8,270,180"];
    let output = run(&folder("navigation_misheard"), &[&words[..], &start, &goal].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
}

/// This Scout turned at a place where no heading showed it the pattern 0010. Without a timer, the turn never ended.
#[test]
fn a_turn_that_hears_no_pattern_ends() {
    let words = ["office", "lab2", "--body", "scout", "--start", "11.5,0,270", "--start-noise", "10cm,5deg"];
    let goal = ["--seed", "9998021", "--timeout", "400", "--goal", "0,0,0.45,0,15"];
    let output = navigate(&folder("navigation_turns"), &[&words[..], &goal].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert!(text(&output).contains("of \"atIsection 0010 OR wait 30\""), "{}", text(&output));
}

/// Returns a folder for a test with the repository's graph and with maps of its landmarks, which a Scout makes once for
/// all tests.
fn mapped(test: &str) -> PathBuf {
    static MADE: OnceLock<PathBuf> = OnceLock::new();
    let made = MADE.get_or_init(with_maps);
    let folder = folder(test);
    for file in fs::read_dir(made).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.join(file.file_name())).unwrap();
    }
    folder
}

fn with_maps() -> PathBuf {
    let folder = folder("navigation_made");
    fs::copy(root().join("plans/navigation/office.mdle"), folder.join("office.mdle")).unwrap();
    let drive = root().join("plans/navigation/map.mdle");
    let mut landmarks = String::new();
    for (name, start, axis) in [("lab2", "0,0,0", 0), ("lab1", "7.45,0.4,180", 180), ("office", "11.5,0,270", 270)] {
        let words = ["run", drive.to_str().unwrap(), "--target", "sim", "--speed", "max", "--body", "scout"];
        let output = run(&folder, &[&words[..], &["--seed", "1", "--start", start, "--log", "drive.mcap"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        let output = run(&folder, &["map", "drive.mcap", &format!("{name}.yaml"), "--at", "-0.75,0,0"]);
        assert_eq!(text(&output), "[0]\n");
        fs::remove_file(folder.join("drive.mcap")).unwrap();
        landmarks += &format!("[[landmark]]\nname = \"{name}\"\naxis = \"{axis}\"\nmap = \"{name}.yaml\"\n");
        landmarks += "at = \"-0.75,0,0\"\n\n";
    }
    fs::write(folder.join("landmarks.toml"), landmarks).unwrap();
    folder
}

/// Navigates a simulated Scout by the graph and the maps in a folder.
fn by_maps(folder: &Path, words: &[&str]) -> Output {
    let usual = ["--target", "sim", "--speed", "max", "--body", "scout"];
    run(folder, &[&["navigate", "office.mdle"], words, &usual].concat())
}

#[test]
fn a_robot_turns_at_landmarks_and_names_them() {
    let folder = mapped("navigation_maps");
    let off = ["--start-noise", "10cm,5deg", "--seed", "9803000"];
    let output = by_maps(&folder, &[&["lab2", "lab1,office", "--goal", "11.5,0,0.8,270,15"], &off[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    let lines = landmarks(&output);
    let places: Vec<&str> = lines.lines().map(|line| line.split(':').next().unwrap()).collect();
    assert_eq!(places, ["route", "at lab2", "at lab1", "at office"], "{lines}");
    // The robot begins at another landmark than the command names.
    for (start, there) in [("7.45,0.4,180", "lab1"), ("11.5,0,270", "office")] {
        let output = by_maps(&folder, &[&["lab2", "lab1", "--start", start], &off[..]].concat());
        assert_eq!(output.status.code(), Some(3), "{}", text(&output));
        let expected = format!("the robot is at {there} and not at lab2, by its maps");
        assert!(text(&output).contains(&expected), "{}", text(&output));
    }
    // All six plans one after another, each in the frame of its landmark.
    let runs = repeated(2).to_string();
    let circuit = ["lab2", "lab1,office,lab1,lab2,office,lab2", "--goal", "0,0,0.45,0,15"];
    let output = by_maps(
        &folder,
        &[&circuit[..], &["--start-noise", "10cm,5deg", "--seed", "9804000", "--runs", &runs]].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    // A landmark without a map is not checked.
    let file = fs::read_to_string(folder.join("landmarks.toml")).unwrap();
    fs::write(folder.join("landmarks.toml"), file.replace("map = \"lab1.yaml\"\nat = \"-0.75,0,0\"\n", "")).unwrap();
    let output = by_maps(&folder, &[&["lab1", "office", "--start", "7.45,0.4,180"], &off[..]].concat());
    assert!(landmarks(&output).contains("\nat lab1\nat office: "), "{}", text(&output));
    fs::remove_file(folder.join("office.pgm")).unwrap();
    let output = by_maps(&folder, &["lab2", "lab1"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
}

#[test]
fn a_graph_without_the_way_is_refused() {
    let folder = small_graph("navigation_refused");
    let routes =
        ["c a", "b a", "a lab", "A b", "a a", "a c", "b d", "c d", "d b"].map(|route| route.split_once(' ').unwrap());
    let answers = routes.map(|(from, to)| {
        let output = run(&folder, &["navigate", "graph.mdle", from, to, "--target", "sim", "--speed", "max"]);
        format!("$ {from} {to}\n{}", text(&output))
    });
    insta::assert_snapshot!(answers.join("\n"), @r#"
    $ c a
    error: graph.mdle has no route from c to a
    help: routes lead from c to b, d
    [1]

    $ b a
    error: graph.mdle has no route from b to a
    help: routes lead from b to c, d
    [1]

    $ a lab
    error: graph.mdle has no landmark `lab`
    help: its landmarks are a, b, c, d
    [2]

    $ A b
    error: graph.mdle has no landmark `A`; did you mean `a`?
    help: its landmarks are a, b, c, d
    [2]

    $ a a
    the robot is at a already
    [0]

    $ a c
    error: the plan `BToC` from b to c never ends
    help: `mdlec analyze graph.mdle --plan BToC` says why
    [1]

    $ b d
    route: b -> d (BToD)
    2.0 s  plan over: wait 2s (graph.mdle:3, of "bumper OR wait 2s")
    warning: there is no file `landmarks.toml`, so all landmarks have the axis 0
    help: write `[[landmark]]`, `name = "…"` and `axis = "…deg"` of each landmark there, or name another file by `--landmarks`
    at b
    error: the way from b to d is not done: `BToD` was ended by `wait 2s`
    [3]

    $ c d
    error: the plan `CToD` from c to d never arrives: only its own condition `bumper` can end it
    help: end its last element where the landmark is, as in `(Atom (wait 10s) …)`
    [1]

    $ d b
    error: the plan `DToB` from d to b never arrives: only its own condition `wait 7200` can end it
    help: end its last element where the landmark is, as in `(Atom (wait 10s) …)`
    [1]

    "#);
}

/// Runs `mdle` on a record, asserts that it succeeds, and returns its output.
fn read(folder: &Path, words: &[&str]) -> String {
    let output = run(folder, words);
    assert_eq!(output.status.code(), Some(0), "{words:?}: {}", text(&output));
    text(&output)
}

#[test]
fn a_record_has_the_plan_of_each_leg() {
    let folder = folder("navigation_record");
    let graph = "Γ_a^b = { AToB (Atom (wait 2s) (go 20 0)) }\nΓ_b^c = { BToC (Atom (wait 3s) (go 10 0)) }\n";
    fs::write(folder.join("graph.mdle"), graph).unwrap();
    read(&folder, &["navigate", "graph.mdle", "a", "c", "--target", "sim", "--speed", "max", "--log", "n.mcap"]);
    assert!(read(&folder, &["replay", "n.mcap"]).contains("52 turns"));
    let of_second_leg = read(&folder, &["why", "n.mcap", "3"]);
    assert!(of_second_leg.contains("go 10 0") && of_second_leg.contains("wait 3s"), "{of_second_leg}");
    read(&folder, &["why", "n.mcap", "--not", "go 10 0"]);
    read(&folder, &["plot", "n.mcap", "n.svg"]);
    read(&folder, &["plot", "n.mcap", "over.svg", "--over-time"]);
    assert!(fs::read_to_string(folder.join("over.svg")).unwrap().contains("go 10 0"));
}

#[test]
fn the_record_of_a_way_that_is_cut_short_says_by_what() {
    let folder = small_graph("navigation_cut_short");
    let words = ["navigate", "graph.mdle", "b", "d", "--target", "sim", "--speed", "max", "--log", "n.mcap"];
    assert_eq!(run(&folder, &words).status.code(), Some(3));
    read(&folder, &["replay", "n.mcap"]);
    let last = read(&folder, &["why", "n.mcap", "2"]);
    assert!(last.contains("wait 2s"), "{last}");
    let before = read(&folder, &["why", "n.mcap", "1"]);
    assert!(before.contains("plan over") || before.contains("wait 2s"), "{before}");
}

#[test]
fn a_robot_that_is_elsewhere_is_refused() {
    let folder = mapped("navigation_elsewhere");
    let seed = ["--seed", "9870500"];
    // Starts outside the range of the search: 80 cm along the hallway, 40 degrees, and at no landmark.
    for start in ["8.25,0.4,180", "7.45,0.4,220", "4,0.6,90"] {
        let output = by_maps(&folder, &["lab1", "office", "--start", start, "--seed", "9870500"]);
        assert_eq!(output.status.code(), Some(3), "{start}: {}", text(&output));
        assert!(text(&output).contains("not at lab1, by its map"), "{start}: {}", text(&output));
    }
    let turn = "{ Turn (bumper OR wait 1min) (Atom (null) turn 360) }\n";
    fs::write(folder.join("turn.mdle"), turn).unwrap();
    let locate = |start: &str, log: &str| {
        let words = ["run", "turn.mdle", "--target", "sim", "--speed", "max", "--body", "scout", "--start", start];
        read(&folder, &[&words[..], &["--log", log], &seed[..]].concat());
        run(&folder, &["locate", log, "lab1.yaml", "lab2.yaml", "office.yaml"])
    };
    let there = locate("7.45,0.4,180", "there.mcap");
    assert_eq!(there.status.code(), Some(0), "{}", text(&there));
    assert!(
        text(&there).starts_with("lab1: score ") && text(&there).matches("not there: ").count() == 2,
        "{}",
        text(&there)
    );
    let nowhere = locate("4,0.6,90", "nowhere.mcap");
    assert_eq!(nowhere.status.code(), Some(1), "{}", text(&nowhere));
    assert_eq!(text(&nowhere).matches("; not there: ").count(), 3, "{}", text(&nowhere));
    // A single map cannot distinguish landmarks.
    let alone = "[[landmark]]\nname = \"lab2\"\naxis = \"0deg\"\nmap = \"lab2.yaml\"\n";
    fs::write(folder.join("landmarks.toml"), alone).unwrap();
    let output = by_maps(&folder, &["lab2", "lab1", "--start", "7.45,0.4,180", "--seed", "9870500"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output));
    assert!(text(&output).contains("warning: lab2 is the only landmark with a map"), "{}", text(&output));
}

#[test]
fn a_graph_that_vanishes_is_not_read_again() {
    let folder = folder("navigation_vanishes");
    let graph = "Γ_a^b = { AToB (Atom (wait 2s) (go 20 0)) }\nΓ_b^c = { BToC (Atom (wait 1s) (go 20 0)) }\n";
    fs::write(folder.join("graph.mdle"), graph).unwrap();
    let mut command = Command::new(mdle());
    command.args(["navigate", "graph.mdle", "a", "c", "--target", "sim"]).current_dir(&folder);
    let mut running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::new(running.stdout.take().unwrap());
    let (mut first, mut rest) = (String::new(), String::new());
    // The route is printed after all files have been read, two seconds before the second plan begins.
    out.read_line(&mut first).unwrap();
    fs::remove_file(folder.join("graph.mdle")).unwrap();
    out.read_to_string(&mut rest).unwrap();
    let output = running.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert!(first.starts_with("route: a -> b (AToB) -> c (BToC)"), "{first}");
    assert!(String::from_utf8(output.stderr).unwrap().contains("at c"), "{rest}");
}

#[test]
fn faulty_landmarks_are_refused() {
    let folder = small_graph("navigation_landmarks");
    fs::write(folder.join("own.toml"), "[[landmark]]\nname = \"e\"\naxis = \"0\"\n").unwrap();
    fs::write(folder.join("none.mdle"), "{ P (Atom (wait 1s) stop) }\n").unwrap();
    let parameter = "Γ_a^b = { AToB(d: length) (Atom (null) (advance d)) }\n";
    fs::write(folder.join("parameter.mdle"), parameter).unwrap();
    let answers = [
        &["graph.mdle", "a", "b", "--landmarks", "own.toml"][..],
        &["graph.mdle", "a", "b", "--landmarks", "missing.toml"],
        &["none.mdle", "a", "b"],
        &["missing.mdle", "a", "b"],
        &["graph.mdle", "a", "--seed", "1"],
        &["graph.mdle", "a", "b", "--safety", "rules.toml"],
        &["parameter.mdle", "a", "b"],
    ]
    .map(|words| text(&run(&folder, &[&["navigate"], words, &["--target", "sim"]].concat())));
    insta::assert_snapshot!(answers.join("\n"), @r#"
    error: own.toml:2: the graph has no landmark `e`
    [2]

    error: the landmarks in missing.toml cannot be read: No such file or directory (os error 2)
    [2]

    error: no plan of none.mdle leads from one landmark to another
    help: write the landmarks before the plan, as in `Γ_a^b = { Name … }`
    [2]

    error: there is no file `missing.mdle`
    [2]

    error: `--seed` comes before the landmark to which the robot is to go
    help: the options of a run follow the landmarks, as in `mdle navigate GRAPH FROM TO --seed …`
    [2]

    error: `--safety` is for one plan, and a route has several
    help: leave it out
    [2]

    error: the plan `AToB` from a to b takes parameters, and a route gives it none
    help: label a plan that uses it: `Γ_a^b = { Name AToB(…) }`
    [1]

    "#);
}

#[test]
fn a_map_shows_the_walls_at_lab_2() {
    let folder = folder("navigation_map");
    let drive = root().join("plans/navigation/map.mdle");
    let words = ["run", drive.to_str().unwrap(), "--target", "sim", "--speed", "max", "--start", "0,0,0"];
    let output = run(&folder, &[&words[..], &["--log", "drive.mcap"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    let output = run(&folder, &["map", "drive.mcap", "lab2.yaml", "--at", "-0.75,0,0", "--png", "lab2.png"]);
    assert_eq!(text(&output), "[0]\n");
    insta::assert_snapshot!(fs::read_to_string(folder.join("lab2.yaml")).unwrap(), @r#"
    image: lab2.pgm
    resolution: 0.0254
    origin: [-1.905, -1.905, 0.0]
    negate: 0
    occupied_thresh: 0.65
    free_thresh: 0.35
    least_score: 2.3

    "#);
    let map = fs::read(folder.join("lab2.pgm")).unwrap();
    // The PNG shows the image of the map.
    let png = fs::File::open(folder.join("lab2.png")).unwrap();
    let mut png = png::Decoder::new(std::io::BufReader::new(png)).read_info().unwrap();
    let mut rows = vec![0; png.output_buffer_size().unwrap()];
    let frame = png.next_frame(&mut rows).unwrap();
    assert_eq!((frame.width, frame.height), (150, 150));
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Grayscale, png::BitDepth::Eight));
    assert_eq!(rows, map[map.len() - 150 * 150..]);
    let grey = |x: f64, y: f64| {
        let cell = |at: f64| ((at + 1.905) / 0.0254) as usize;
        map[map.len() - 150 * 150 + (149 - cell(y)) * 150 + cell(x)]
    };
    // The doorway, the hallway in front of it and the room behind it are free; the wall across is occupied.
    for (x, y) in [(0.0, 0.0), (-0.75, 0.0), (-0.75, 0.3), (0.6, 0.0)] {
        assert!(grey(x, y) > 166, "({x}, {y}) is {}", grey(x, y));
    }
    let darkest = |x: f64, y: f64| [-0.04, 0.0, 0.04].map(|by| grey(x + by, y)).into_iter().min().unwrap();
    for y in [-0.4, 0.0, 0.4] {
        assert!(darkest(-1.5, y) < 89, "the wall at {y} is {}", darkest(-1.5, y));
    }
    let output = run(&folder, &["map", "drive.mcap", "lab2.yaml"]);
    insta::assert_snapshot!(text(&output), @r#"
    error: lab2.yaml exists already
    help: remove it, or name another file
    [2]

    "#);
    fs::write(folder.join("other.pgm"), "").unwrap();
    let output = run(&folder, &["map", "drive.mcap", "third.yaml", "--png", "lab2.png"]);
    assert_eq!(text(&output), "error: lab2.png exists already\nhelp: remove it, or name another file\n[2]\n");
    assert!(!folder.join("third.yaml").exists());
    let words = |name| ["map", "drive.mcap", name];
    let answers = ["other.yaml", "other.png", "other"].map(|name| text(&run(&folder, &words(name)))).concat();
    insta::assert_snapshot!(answers, @r#"
    error: other.pgm exists already
    help: remove it, or name another file
    [2]
    error: other.png is no name of a map: it has to end in .yaml
    help: name it other.yaml
    [2]
    error: other is no name of a map: it has to end in .yaml
    help: name it other.yaml
    [2]
    "#);
    assert!(!folder.join("other.yaml").exists(), "half a map is none");
}
