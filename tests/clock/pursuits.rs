//! Tests local pursuit by three programs that are linked over TCP (paper, section IV-D): simulated robots on a line
//! that loses and delays states, and emulated Scouts in one world. In some tests, a program is killed.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a test tells")]

use std::fs;
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use mdle_emulator::Pace;
use mdle_tests::book::{fences, pages};
use mdle_tests::chance::{Chance, repeated, sized};
use mdle_tests::executable::{folder, mdle};
use mdle_tests::pursuit::{Course, PERIOD, ROBOTS, assert_converge, on_scouts, prepare};

use crate::bad_line::Line;

/// Returns a folder with the plans and the link file of each robot. The plans drive `laps` laps and have the timer
/// `timer`; the links use lines with the faults `line`.
fn prepared(test: &str, laps: u64, timer: &str, line: Option<Line>, seed: u64) -> PathBuf {
    let folder = folder(test);
    prepare(&folder, (laps, timer), super::addresses(), &|own, other, peer| {
        line.map_or(peer, |line| line.before(peer, seed + (3 * own + other) as u64))
    });
    folder
}

/// Starts the program of a robot, with options for its target.
fn begin(folder: &Path, number: usize, options: &str) -> Child {
    let (name, plan, _, records) = ROBOTS[number];
    let _ = fs::remove_file(folder.join(format!("{name}.mcap")));
    let line = format!("run {plan}.mdle --link {name}-link.toml{records} --log {name}.mcap {options}");
    let mut command = Command::new(mdle());
    let command = command.args(line.split_whitespace()).current_dir(folder);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

pub(crate) fn simulated_robots_learn_over_a_bad_line() {
    // All laps in real time; a short test runs two laps with a robot and a line that are four times as fast.
    let (laps, speed) = (sized(2, 4), sized(4, 1));
    for seed in 0..sized(1, 5) {
        let line = Line { loss: 10, longest: Duration::from_millis(200) / speed };
        let folder = prepared("bad_line", laps, "10min", Some(line), 100 * seed);
        let children = [0, 1, 2].map(|number| {
            let (x, seed) = (ROBOTS[number].2, 3 * seed + number as u64);
            let world = format!("--target sim --world floor.toml --body scout --seed {seed} --start {x},0,0");
            begin(&folder, number, &format!("{world} --speed {speed}"))
        });
        let mut number = 0;
        let courses = children.map(|child| {
            number += 1;
            Course::of(&folder, number - 1, child)
        });
        assert_converge("bad line", &courses, laps);
    }
}

/// The commands of the book start three robots, and the first one drives its path when all of them have met. The free
/// addresses replace those of the page.
pub(crate) fn the_commands_of_the_book_begin_a_pursuit() {
    let folder = prepared("pursuit_of_the_book", 4, "10min", None, 0);
    fs::remove_dir(folder.join("robot3")).unwrap();
    let page = pages().into_iter().find(|page| page.path.ends_with("many_robots.md")).unwrap();
    let (fences, addresses) = (fences(&page), super::addresses::<3>());
    for name in ["robot1", "robot2", "robot3", "floor"] {
        let file = format!("{name}.toml");
        let block = fences.iter().find(|fence| fence.file() == Some(&file)).unwrap();
        let replaced = (1..).zip(addresses).fold(block.text.clone(), |text, (number, address)| {
            text.replace(&format!("127.0.0.1:741{number}"), &address.to_string())
        });
        fs::write(folder.join(file), replaced).unwrap();
    }
    let block = fences.iter().find(|fence| fence.text.starts_with("mdle run first_robot.mdle")).unwrap();
    assert_eq!(block.text.lines().count(), 3, "{}", block.text);
    let children: Vec<Child> = block
        .text
        .lines()
        .map(|line| {
            let mut command = Command::new(mdle());
            command.args(line.split_whitespace().skip(1)).args(["--timeout", "5s"]).current_dir(&folder);
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
        })
        .collect();
    for (child, law) in children.into_iter().zip(["path lastPath", "go 50 0", "go 50 0"]) {
        let output = child.wait_with_output().unwrap();
        let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
        let report = format!("{out}{err}");
        assert!(report.contains(law) && report.contains("<- rendezvous"), "{report}");
    }
}

pub(crate) fn scouts_in_one_world_learn_over_tcp() {
    // In real time a Scout obeys one turn later than in lockstep. All laps take more than two minutes.
    let (laps, pace) = (sized(2, 4), sized(Pace::Lockstep(PERIOD), Pace::Real));
    for seed in 0..sized(1, 5) {
        let folder = prepared("scouts", laps, "10min", None, 0);
        let courses = on_scouts(&folder, &begin, pace, seed, None);
        assert_converge("scouts", &courses, laps);
    }
}

pub(crate) fn a_program_that_dies_leaves_no_scout_waiting() {
    let mut chance = Chance::new(7);
    let mut times = (0..repeated(4)).map(|run| (run, Duration::from_millis(chance.below(65_000) as u64)));
    // Two runs at the same time, because they wait most of the time.
    while let Some(first) = times.next() {
        thread::scope(|scope| {
            iter::once(first).chain(times.next()).for_each(|(run, time)| drop(scope.spawn(move || killed(run, time))));
        });
    }
}

/// Asserts that two Scouts continue or end their plans after the program of the third Scout was killed at this time.
fn killed(run: u64, time: Duration) {
    let folder = prepared(&format!("scouts_killed_{}", run % 2), 2, "2min", None, 0);
    let victim = run as usize % 3;
    let courses = on_scouts(&folder, &begin, Pace::Lockstep(PERIOD), run, Some((victim, time)));
    let Course { status, report, .. } = &courses[victim];
    assert!(status.is_none() || report.contains("plan over: bumper"), "it was killed: {report}");
    println!("{} killed after {} s", ROBOTS[victim].0, time.as_secs_f64());
    for (number, Course { status, report, .. }) in courses.iter().enumerate() {
        let (name, ..) = ROBOTS[number];
        let last = report.lines().rfind(|line| line.contains(" s  ")).unwrap_or_default();
        if number == victim {
            continue;
        }
        println!("    {name}: {last}");
        assert_eq!(*status, Some(0), "{name}: {report}");
        let words = ["plan over: wait 2min", "plan over: bumper", "plan over: completed"];
        assert!(words.iter().any(|words| last.contains(words)), "{name}: {report}");
    }
}
