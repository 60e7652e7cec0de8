//! Tests executables that contain the engine: `mdlec PLAN --target TARGET --engine` builds a program that needs no
//! other file and behaves like `mdle run PLAN --target TARGET`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use mdle_emulator::Pace;
use mdle_tests::executable::{folder, mdle, run_mdlec};
use mdle_tests::pursuit::{PERIOD, ROBOTS, assert_converge, on_scouts, prepare};

/// Builds the executable of a plan in a folder, with these arguments after the file of the plan. Returns the messages
/// and the exit status.
fn built(folder: &Path, arguments: &str) -> (String, Option<i32>) {
    let output = run_mdlec(folder, &arguments.split(' ').collect::<Vec<_>>());
    (String::from_utf8(output.stderr).unwrap(), output.status.code())
}

/// Returns three addresses at which no program listens.
fn addresses() -> [SocketAddr; 3] {
    let listeners = [(); 3].map(|()| TcpListener::bind("127.3.0.1:0").unwrap());
    listeners.map(|listener| listener.local_addr().unwrap())
}

/// Experiment D of the paper, as three executables on three emulated Scouts in one world, linked over TCP.
#[test]
fn three_executables_on_three_scouts_learn_a_short_way() {
    let folder = folder("pursuit");
    prepare(&folder, (2, "10min"), addresses(), &|_, _, peer| peer);
    for (name, plan, ..) in ROBOTS {
        let (messages, status) = built(&folder, &format!("{plan}.mdle --target scout --engine -o {name}/program"));
        assert_eq!(status, Some(0), "{messages}");
        // Who asks for the version needs no link, although the plan names other robots.
        let (version, err, status, _) = run(&folder.join(name).join("program"), &folder, "version", "--version");
        assert!(status == Some(0) && version.contains(", target scout, "), "{version}{err}");
        // The executable contains the text of its plan.
        fs::remove_file(folder.join(plan).with_extension("mdle")).unwrap();
    }
    let begin = |folder: &Path, number: usize, options: &str| {
        let (name, _, _, records) = ROBOTS[number];
        let line = format!("--link {name}-link.toml{records} --log {name}.mcap {options}");
        let options = line.replace("--target scout", "");
        let mut command = Command::new(folder.join(name).join("program"));
        let command = command.args(options.split_whitespace()).current_dir(folder).env_clear();
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let courses = on_scouts(&folder, &begin, Pace::Lockstep(PERIOD), 0, None);
    assert_converge("executables", &courses, 2);
}

/// A plan that reads a module, in two files.
const PLAN: &str = "use \"back.mdle\"\n\
                    { Approach (bumper OR wait 20s)\n  (Atom (range(heading module) < 60cm) goAvoid(heading module))\n  \
                    Back\n}\n";
const BACK: &str = "{ Back (wait 2s) (Atom (null) (go -10 0)) }\n";
/// A plan of a group, and the file of the link of its second robot.
const GROUP: &str = "{ Group [ada bob] Pair (wait 30s)\n  (Atom (all rendezvous) stop)\n}\n";

/// Runs a program in a folder, and returns its output, its exit status and the files `name.jsonl` and `name.csv` that
/// it has written.
fn run(program: &Path, folder: &Path, name: &str, arguments: &str) -> (String, String, Option<i32>, Vec<Vec<u8>>) {
    let line = format!("{arguments} --log {name}.jsonl --trail {name}.csv");
    let output = Command::new(program).args(line.split_whitespace()).current_dir(folder).env_clear().output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    let files = ["jsonl", "csv"].map(|ending| fs::read(folder.join(name).with_extension(ending)).unwrap_or_default());
    (out, err, output.status.code(), files.to_vec())
}

/// Returns a folder with the plans of this file.
fn prepared(test: &str) -> PathBuf {
    let folder = folder(test);
    for (name, text) in [("approach.mdle", PLAN), ("back.mdle", BACK), ("pair.mdle", GROUP)] {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

#[test]
fn the_program_does_what_mdle_run_does() {
    let folder = prepared("same");
    let (messages, status) = built(&folder, "approach.mdle --target sim --engine -o program");
    assert_eq!(status, Some(0), "{messages}");
    let options =
        ["--world hall --speed max --point 3,0.5 --seed 4", "--speed max --point 1,0 --timeout 1s", "--speed x"];
    let expected = options.map(|options| {
        let line = format!("run approach.mdle --target sim {options}");
        run(mdle(), &folder, "expected", &line)
    });
    ["approach.mdle", "back.mdle"].iter().for_each(|file| fs::remove_file(folder.join(file)).unwrap());
    let made = options.map(|options| run(&folder.join("program"), &folder, "made", options));
    for ((made, expected), options) in made.iter().zip(&expected).zip(options) {
        let without_usage = |err: &str| err.lines().filter(|line| !line.starts_with("Usage: ")).count();
        assert_eq!((&made.0, made.2, &made.3), (&expected.0, expected.2, &expected.3), "{options}: {}", made.1);
        assert_eq!(without_usage(&made.1), without_usage(&expected.1), "{options}");
    }
    assert_eq!(made.map(|(_, _, status, _)| status), [Some(0), Some(4), Some(2)]);
    let (help, messages, status, _) = run(&folder.join("program"), &folder, "help", "--help");
    assert!(help.contains("--link <FILE>") && help.contains("Usage: program [OPTIONS]\n"), "{help}");
    assert_eq!((&*messages, status), ("", Some(0)));
    let (version, messages, ..) = run(&folder.join("program"), &folder, "version", "--version");
    assert_eq!(messages, "");
    assert!(version.starts_with("Approach (text ") && version.contains(", target sim, alphabet "), "{version}");
}

#[test]
fn what_cannot_have_the_engine_is_refused() {
    let folder = prepared("refused");
    fs::write(folder.join("wrong.mdle"), "{ Wrong (range(heading module) < 60deg) (Atom (null) stop) }\n").unwrap();
    fs::write(folder.join("two.toml"), "[[robot]]\nname = \"a\"\nfile = \"back.mdle\"\n").unwrap();
    for (folder_name, text) in [("ruled", "safety = \"rules.toml\"\n"), ("heard", "[modules]\nnose = \"cat\"\n")] {
        fs::create_dir(folder.join(folder_name)).unwrap();
        fs::write(folder.join(folder_name).join("mdle.toml"), text).unwrap();
        fs::write(folder.join(folder_name).join("back.mdle"), BACK).unwrap();
    }
    let mut messages = String::new();
    for (arguments, wanted) in [
        ("approach.mdle --target sim", 1),
        ("approach.mdle --engine", 2),
        ("approach.mdle --target ros2 --engine", 2),
        ("approach.mdle --target rover --engine", 2),
        ("approach.mdle --target sim --engine --emit rust", 2),
        ("wrong.mdle --target sim --engine", 1),
        ("approach.mdle --target sim --engine --plan Back2", 2),
        ("two.toml --target sim --engine", 2),
        ("ruled/back.mdle --target sim --engine", 2),
        ("heard/back.mdle --target sim --engine", 2),
    ] {
        let (message, status) = built(&folder, arguments);
        assert_eq!(status, Some(wanted), "{arguments}: {message}");
        messages += &format!("$ mdlec {arguments}\n{message}");
    }
    insta::assert_snapshot!(messages);
}

/// The executable of a group drives the part of the robot that the file of its link names.
#[test]
fn the_program_of_a_group_drives_the_part_of_its_link() {
    let folder = prepared("group");
    let (messages, status) = built(&folder, "pair.mdle --target sim --engine -o pair");
    assert_eq!(status, Some(0), "{messages}");
    let addresses = addresses();
    let robots = ["ada", "bob"];
    let started: Vec<_> = (0..2)
        .map(|own| {
            let (name, other) = (robots[own], robots[1 - own]);
            let text = format!(
                "name = \"{name}\"\nlisten = \"{}\"\nkey = \"key\"\nstart = \"0,0,0\"\n[[robot]]\nname = \"{other}\"\n\
                 address = \"{}\"\n",
                addresses[own],
                addresses[1 - own]
            );
            fs::write(folder.join(format!("{name}.toml")), text).unwrap();
            let mut command = Command::new(folder.join("pair"));
            let line = format!("--link {name}.toml --speed 1 --world hall");
            command.args(line.split(' ')).current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::piped());
            command.spawn().unwrap()
        })
        .collect();
    // The first robot of a group coordinates it; the other one follows its atoms.
    for (child, cause) in started.into_iter().zip(["all rendezvous", "past ada 2"]) {
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{text}");
        assert!(text.contains(&format!("stop (pair.mdle:1)  <- {cause} (pair.mdle:2)")), "{text}");
    }
}
