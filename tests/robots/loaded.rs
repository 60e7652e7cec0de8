//! `mdle run` beside the executable of the same plan: the same bytes in report, messages, log and trail, and the same
//! exit status.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod random;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::chance::Chance;
use mdle_tests::executable::{folder, mdle, run_mdlec};
use mdle_tests::repository::root;

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);

/// The files that a run writes.
const FILES: [&str; 2] = ["run.jsonl", "trail.csv"];

/// All that a run leaves: report, messages, exit status, and the files that it writes.
#[derive(Debug, PartialEq, Eq)]
struct RunOutput {
    out: String,
    err: String,
    status: Option<i32>,
    files: Vec<Option<String>>,
}

/// Takes what a run in `folder` left; `called` are the words of its command before the options, for messages.
fn left(folder: &Path, called: &str, output: Output) -> RunOutput {
    let files = FILES.map(|file| {
        let text = fs::read_to_string(folder.join(file)).ok();
        let _ = fs::remove_file(folder.join(file));
        text
    });
    let text = |bytes| String::from_utf8(bytes).unwrap().replace(called, "PROGRAM");
    let [out, err] = [output.stdout, output.stderr].map(text);
    RunOutput { out, err, status: output.status.code(), files: files.into() }
}

/// Runs the plan of a file both ways with the same options, and compares what the runs leave. Warnings about the plan,
/// which `mdlec` prints when it builds, come before the run.
fn compare(folder: &Path, file: &str, target: &str, options: &[&str]) -> RunOutput {
    let run = |command| simulated_run(folder, command, options);
    let mut executable = run(Command::new(folder.join("executable")));
    executable.err.insert_str(0, &warnings(folder, file, target));
    let loaded = run(loaded(file, target));
    assert_eq!(loaded, executable, "{file} {target} {options:?}");
    loaded
}

/// Runs a command with these options in the simulator.
fn simulated_run(folder: &Path, mut command: Command, options: &[&str]) -> RunOutput {
    let called = called(&command);
    left(folder, &called, command.args(options).current_dir(folder).output().unwrap())
}

/// The warnings about a plan.
fn warnings(folder: &Path, file: &str, target: &str) -> String {
    String::from_utf8(run_mdlec(folder, &["check", file, "--target", target]).stderr).unwrap()
}

/// Returns the program and the arguments of a command, as a shell takes them.
fn called(command: &Command) -> String {
    let words = [command.get_program()].into_iter().chain(command.get_args());
    words.map(|word| word.to_str().unwrap()).collect::<Vec<_>>().join(" ")
}

/// `mdle run FILE --target TARGET`.
fn loaded(file: &str, target: &str) -> Command {
    let mut command = Command::new(mdle());
    command.args(["run", file, "--target", target]);
    command
}

/// Builds the executable of the plan in this file.
fn build(folder: &Path, file: &str, target: &str) {
    let built = run_mdlec(folder, &[file, "--target", target, "-o", "executable"]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
}

/// The plans of the repository.
fn plans() -> Vec<PathBuf> {
    let folders = ["plans", "plans/paper"].map(|folder| root().join(folder));
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap()).map(|entry| entry.unwrap().path());
    let mut plans: Vec<_> = files.filter(|file| file.extension().is_some_and(|ending| ending == "mdle")).collect();
    plans.sort();
    plans
}

/// The options of a run in the simulator with this body.
fn in_simulator<'a>(body: &'a str, seed: &'a str) -> Vec<&'a str> {
    let [log, trail] = FILES;
    let mut options = vec!["--body", body, "--speed", "max", "--timeout", "200", "--log", log, "--trail", trail];
    options.extend(["--seed", seed]);
    options
}

#[test]
fn every_plan_runs_as_its_executable_does() {
    let folder = folder("plans");
    let (mut linked, mut in_an_engine) = (0, 0);
    for plan in plans() {
        let file = plan.to_str().unwrap();
        let checked = run_mdlec(&folder, &["check", file, "--target", "sim"]);
        assert!(checked.status.success(), "{file}: {}", String::from_utf8_lossy(&checked.stderr));
        if fs::read_to_string(&plan).unwrap().contains("sync robot") {
            let built = String::from_utf8(run_mdlec(&folder, &[file, "--target", "sim"]).stderr).unwrap();
            assert!(built.contains("error[E0403]: `sync` needs the state link, and an executable has none"), "{built}");
            let loaded = loaded(file, "sim").current_dir(&folder).output().unwrap();
            let refused = String::from_utf8(loaded.stderr).unwrap();
            assert!(loaded.status.code() == Some(2) && refused.contains("there is no link to it"), "{refused}");
            linked += 1;
            continue;
        }
        if fs::read_to_string(&plan).unwrap().contains("heading module") {
            let built = run_mdlec(&folder, &[file, "--target", "sim"]);
            assert!(String::from_utf8(built.stderr).unwrap().starts_with("error[E0403]"), "{file}");
            let mut command = loaded(file, "sim");
            command.args(["--speed", "max", "--timeout", "20", "--point", "3,0"]).args(["--log", FILES[0]]);
            let run = left(&folder, &called(&command), command.current_dir(&folder).output().unwrap());
            assert_eq!(run.status, Some(4), "{file}: {}", run.err);
            assert!(run.files[0].as_ref().is_some_and(|log| log.contains("goAvoid heading module")), "{file}: {run:?}");
            in_an_engine += 1;
            continue;
        }
        build(&folder, file, "sim");
        for body in ["ideal", "scout", "atrv"] {
            let RunOutput { status, files, out, .. } = compare(&folder, file, "sim", &in_simulator(body, "7"));
            assert!([Some(0), Some(4)].contains(&status), "{file} {body}: {out}");
            assert!(files.iter().all(|file| file.as_ref().is_some_and(|text| text.len() > 1000)), "{file} {body}");
        }
    }
    assert_eq!((linked, in_an_engine), (2, 1), "plans of the paper for several robots, and for an engine");
}

#[test]
fn several_runs_are_those_of_the_executable() {
    let folder = folder("batch");
    let plan = root().join("plans/dock.mdle");
    build(&folder, plan.to_str().unwrap(), "sim");
    let options = ["--runs", "4", "--start-noise", "0.2,5", "--timeout", "30", "--json"];
    compare(&folder, plan.to_str().unwrap(), "sim", &options);
}

#[test]
fn a_run_on_an_emulated_robot_is_that_of_the_executable() {
    let file = root().join("plans/lab_tour.mdle");
    let file = file.to_str().unwrap();
    for target in ["scout", "atrv"] {
        let folder = folder(target);
        build(&folder, file, target);
        let run = |command| emulated_run(&folder, target, command, "200");
        let executable = run(Command::new(folder.join("executable")));
        assert_eq!(run(loaded(file, target)), executable, "{target}");
        assert_eq!(executable.status, Some(0), "{executable:?}");
    }
}

/// A robot in the office, at the start of the tour.
pub(crate) fn simulated(body: Body, step: Duration) -> Simulated {
    let world = World::office().unwrap();
    let make = Make { body, without: Vec::new(), seed: None };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Runs a command on the emulated robot of a target in lockstep, for at most this many seconds.
fn emulated_run(folder: &Path, target: &str, command: Command, timeout: &str) -> RunOutput {
    if target == "scout" {
        return emulated(folder, Scout::new(simulated(Body::Scout, PERIOD)).unwrap(), command, timeout);
    }
    let step = step(IN_LOCKSTEP);
    emulated(folder, Atrv::new(simulated(Body::Atrv, step), step, false).unwrap(), command, timeout)
}

fn emulated<R: Emulated + Send>(folder: &Path, mut robot: R, mut command: Command, timeout: &str) -> RunOutput {
    let called = called(&command);
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, IN_LOCKSTEP, &|| !over.load(Ordering::Relaxed)));
        let options = ["--lockstep", "--timeout", timeout, "--log", FILES[0]];
        let output = command.arg("--device").arg(port.path()).args(options).current_dir(folder).output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    });
    left(folder, &called, output)
}

/// A plan of the simulated robot: behaviors in behaviors, loops, frames, memories, and laws that drive it about.
pub(crate) fn random_plan(chance: &mut Chance) -> String {
    let mut text = String::from("{ Main (wait 90)\n");
    let mut labels = 0;
    strings(chance, &mut text, 3, &mut labels);
    text + "}\n"
}

/// Some elements of a behavior that is `depth` levels above the deepest.
fn strings(chance: &mut Chance, text: &mut String, depth: usize, labels: &mut usize) {
    for _ in 0..1 + chance.below(4) {
        let frame = chance.pick(&["", "", "FRAME 45 ", "FRAME here "]);
        let times = chance.pick(&["", "", "^2", "^3"]);
        if depth > 0 && chance.percent(45) {
            *labels += 1;
            let (name, condition) = (*labels, condition(chance, 2));
            let _ = writeln!(text, "{{ Part{name} ({condition}) ");
            strings(chance, text, depth - 1, labels);
            let _ = writeln!(text, "}}");
        } else {
            let law = chance.pick(&[
                "go 20 0",
                "go 30cm/s 10deg/s",
                "go 0 -1",
                "rotate 90",
                "rotate -45",
                "goAvoid 90 40 20",
                "goAvoid 0 30 30",
                "stop",
                "align 3 5",
            ]);
            let condition = condition(chance, 2);
            let _ = writeln!(text, "{frame}(Atom ({condition} OR wait {}) {law}){times}", 1 + chance.below(6));
        }
    }
}

/// A condition with operators in operators.
fn condition(chance: &mut Chance, depth: usize) -> String {
    if depth > 0 && chance.percent(40) {
        let (one, other) = (condition(chance, depth - 1), condition(chance, depth - 1));
        return match chance.below(4) {
            0 => format!("({one}) AND ({other})"),
            1 => format!("({one}) OR ({other})"),
            2 => format!("NOT ({one})"),
            _ => format!("RISING ({one})"),
        };
    }
    let simple = ["bumper", "r0 < 60cm", "r3 < r5", "r12 > 1.5m", "x > 3m", "theta > 30deg", "atIsection 0100"];
    match chance.below(3) {
        0 => format!("wait {}", 1 + chance.below(9)),
        1 => format!("way > {}cm", 10 + chance.below(200)),
        _ => chance.pick(&simple).to_owned(),
    }
}
