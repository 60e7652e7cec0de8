//! Tests the modules `pings` and `map`: with `--map`, an evidence grid is built while the robot drives.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

const AROUND: &str = "{ Around (bumper OR wait 12s)\n  (Atom (null) turn 360)\n  (Atom (null) (go 20 0.1))\n}\n";

/// Runs `mdle` with these arguments; returns its output.
fn run(folder: &Path, arguments: &str) -> Output {
    Command::new(mdle()).args(arguments.split(' ')).current_dir(folder).output().unwrap()
}

/// Returns the output of a run, with its exit status.
fn text(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    format!("{out}{err}[{}]\n", output.status.code().unwrap())
}

/// Returns the text of a map without the line that names its image, and its images.
fn map(folder: &Path, name: &str) -> (String, [Vec<u8>; 2]) {
    let yaml = fs::read_to_string(folder.join(format!("{name}.yaml"))).unwrap();
    let (first, rest) = yaml.split_once('\n').unwrap();
    assert_eq!(first, format!("image: {name}.pgm"));
    (rest.to_owned(), ["pgm", "png"].map(|ending| fs::read(folder.join(format!("{name}.{ending}"))).unwrap()))
}

#[test]
fn a_map_of_a_run_is_that_of_its_record() {
    let folder = folder("same");
    fs::write(folder.join("around.mdle"), AROUND).unwrap();
    for (body, at) in [("ideal", "-0.75,0,0"), ("scout", "-0.5,0.25,30")] {
        let plain = format!("run around.mdle --target sim --world office --speed max --body {body} --seed 4");
        let report = text(&run(&folder, &plain));
        let mapped = format!("{plain} --map {body}.yaml --map-at {at} --log {body}.mcap");
        assert_eq!(text(&run(&folder, &mapped)), report, "a map changes nothing");
        let again = format!("{plain} --map-at={at} --map=again-{body}.yaml --log again.mcap");
        assert_eq!(text(&run(&folder, &again)), report);
        let recorded = format!("map {body}.mcap of-{body}.yaml --at {at} --png of-{body}.png");
        assert_eq!(text(&run(&folder, &recorded)), "[0]\n");
        let live = map(&folder, body);
        let others = [format!("of-{body}"), format!("again-{body}")].map(|name| map(&folder, &name) == live);
        assert_eq!(others, [true; 2], "{body}");
        let greys = &live.1[0];
        let known = greys[greys.len() - 150 * 150..].iter().filter(|grey| **grey != 128).count();
        assert!(known > 3000, "{body}: {known} cells are known");
        // The command that repeats the run writes no map.
        let info = text(&run(&folder, &format!("log info {body}.mcap")));
        assert!(info.contains("run around.mdle --target sim") && !info.contains("--map"), "{info}");
        let replayed = text(&run(&folder, &format!("replay {body}.mcap")));
        assert!(replayed.starts_with("the same to the bit, "), "{replayed}");
    }
}

#[test]
fn a_session_saves_a_map_on_command() {
    let folder = folder("session");
    fs::write(folder.join("around.mdle"), AROUND).unwrap();
    fs::write(
        folder.join("commands"),
        "get /usr/map/cells\nwait 2s\nget /usr/pings/count\nget /usr/map/pings\nset /usr/map/save true\nwait 1s\n\
         get /usr/map/saved\nset /usr/map/save false\nwait 1s\nset /usr/map/save true\nwait 1s\nset /usr/map/save true\n\
         wait 1s\nget /usr/map/saved\nget /usr/map/cells\nquit\n",
    )
    .unwrap();
    let words = "--target sim --world office --speed max --body scout --seed 4";
    let output = run(&folder, &format!("shell around.mdle --paused -x -c commands {words} --map door.yaml"));
    insta::assert_snapshot!(String::from_utf8(output.stdout.clone()).unwrap(), @r#"
    > get /usr/map/cells
    (no value yet)
    > wait 2s
    21 turns, 2s
    > get /usr/pings/count
    81
    > get /usr/map/pings
    79
    > set /usr/map/save true
    > wait 1s
    31 turns, 3s
    > get /usr/map/saved
    1
    > set /usr/map/save false
    > wait 1s
    41 turns, 4s
    > set /usr/map/save true
    > wait 1s
    51 turns, 5s
    > set /usr/map/save true
    > wait 1s
    61 turns, 6s
    > get /usr/map/saved
    3
    > get /usr/map/cells
    6423
    > quit
    "#);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    let whole = map(&folder, "door");
    // The map is saved 2 s after the start and replaced by the final one at the end of the run.
    fs::write(folder.join("commands"), "wait 2s\nset /usr/map/save true\nwait 1s\nquit\n").unwrap();
    let output = run(&folder, &format!("shell around.mdle --paused -c commands {words} --map short.yaml"));
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert!(map(&folder, "short").1[0] != whole.1[0], "a longer run has another map");
    let entries = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(!entries.into_iter().any(|name| name.ends_with(".tmp")), "no unfinished file is left");
}

#[test]
fn a_map_that_cannot_be_is_refused() {
    let folder = folder("refused");
    fs::write(folder.join("around.mdle"), AROUND).unwrap();
    fs::write(folder.join("wait.mdle"), "{ Wait (wait 1) (Atom (null) stop) }\n").unwrap();
    fs::write(folder.join("one.toml"), "[[robot]]\nname = \"a\"\nfile = \"wait.mdle\"\nstart = \"0, 0, 0\"\n").unwrap();
    for file in ["old.yaml", "image.pgm", "picture.png"] {
        fs::write(folder.join(file), "").unwrap();
    }
    let run_sim = "run wait.mdle --target sim --speed max";
    let lines = [
        format!("{run_sim} --map old.yaml"),
        format!("{run_sim} --map image.yaml"),
        format!("{run_sim} --map picture.yaml"),
        format!("{run_sim} --map map.png"),
        format!("{run_sim} --map no/such/folder.yaml"),
        format!("{run_sim} --map a.yaml --map-at 1,2"),
        format!("{run_sim} --map a.yaml --runs 3"),
        format!("{run_sim} --map a.yaml --world nowhere"),
        "run wait.mdle --target scout --device /dev/null --map a.yaml".to_owned(),
        "run one.toml --map a.yaml".to_owned(),
        "navigate around.mdle a b --map a.yaml".to_owned(),
    ];
    let answers = lines.map(|line| format!("$ mdle {line}\n{}", text(&run(&folder, &line))));
    insta::assert_snapshot!(answers.concat());
    assert!(!folder.join("a.yaml").exists(), "no map is written");
}

#[test]
fn a_map_that_becomes_impossible_is_a_fault() {
    let folder = folder("impossible");
    fs::write(folder.join("around.mdle"), AROUND).unwrap();
    fs::create_dir(folder.join("maps")).unwrap();
    // A child process removes the folder while the robot drives.
    let remove = "exec python3 -c \"print('{}',flush=True);__import__('shutil').rmtree('maps',True)\"";
    let words =
        ["run", "around.mdle", "--target", "sim", "--world", "office", "--speed", "max", "--map", "maps/a.yaml"];
    let module = format!("gone={remove}");
    let output = Command::new(mdle()).args(words).args(["--module", &module]).current_dir(&folder).output().unwrap();
    let report = text(&output);
    assert!(report.contains("error: the map maps/a.pgm cannot be written: No such file or directory"), "{report}");
    assert_eq!(output.status.code(), Some(3), "{report}");
}

#[test]
fn a_map_that_cannot_be_saved_is_saved_later() {
    let folder = folder("later");
    fs::write(folder.join("around.mdle"), AROUND).unwrap();
    fs::create_dir(folder.join("maps")).unwrap();
    // A child process moves the folder away before the first turn, and restores it after 2.5 s.
    let child = "import os, sys\nos.rename('maps', 'away')\nprint('{}', flush=True)\nturn = 0\n\
                 for line in sys.stdin:\n    turn += 1\n    if turn == 25:\n        os.rename('away', 'maps')\n    print('{}', flush=True)\n";
    fs::write(folder.join("away.py"), child).unwrap();
    let save = "set /usr/map/save true\nwait 1s\nget /usr/map/saved\nget /usr/map/pings\n";
    fs::write(folder.join("commands"), format!("wait 1s\n{save}wait 2s\n{save}quit\n")).unwrap();
    let words = "shell around.mdle --paused -x -c commands --target sim --world office --speed max --map maps/a.yaml";
    let module = "away=exec python3 away.py";
    let words = words.split(' ').chain(["--module", module]);
    let output = Command::new(mdle()).args(words).current_dir(&folder).output().unwrap();
    let report = text(&output);
    let numbers: Vec<u64> = report.lines().filter_map(|line| line.parse().ok()).collect();
    let [none, early, once, late] = numbers[..] else { panic!("{report}") };
    assert!((none, once) == (0, 1) && early < late, "the module goes on: {report}");
    let warning =
        "warning: the map maps/a.pgm cannot be written: No such file or directory (os error 2); it can be saved";
    assert!(report.contains(warning) && report.ends_with("[0]\n"), "{report}");
}
