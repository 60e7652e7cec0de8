//! Runs a plan, loaded from its text or compiled to an executable, in the simulator and on emulated robots, and
//! collects the output and the files of the run.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};

use crate::executable::{mdle, run_mdlec};

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);

/// Names of the files that a run writes.
pub const FILES: [&str; 2] = ["run.jsonl", "trail.csv"];

/// Result of a run: its report, messages, exit status and files.
#[derive(Debug, PartialEq, Eq)]
pub struct RunOutput {
    /// Report of the run.
    pub out: String,
    /// Messages of the run.
    pub err: String,
    /// Exit status; `None` if a signal ended the run.
    pub status: Option<i32>,
    /// Texts of [`FILES`]; `None` for a file that was not written.
    pub files: Vec<Option<String>>,
}

/// Returns the result of a run in `folder`, and removes its files. In the texts, replaces `called`, the words of the
/// command before the options, by `PROGRAM`.
#[must_use]
pub fn left(folder: &Path, called: &str, output: Output) -> RunOutput {
    let files = FILES.map(|file| {
        let text = fs::read_to_string(folder.join(file)).ok();
        let _ = fs::remove_file(folder.join(file));
        text
    });
    let text = |bytes| String::from_utf8(bytes).unwrap().replace(called, "PROGRAM");
    let [out, err] = [output.stdout, output.stderr].map(text);
    RunOutput { out, err, status: output.status.code(), files: files.into() }
}

/// Runs a command with these options in the simulator.
#[must_use]
pub fn simulated_run(folder: &Path, mut command: Command, options: &[&str]) -> RunOutput {
    let called = called(&command);
    left(folder, &called, command.args(options).current_dir(folder).output().unwrap())
}

/// Returns the warnings about a plan.
#[must_use]
pub fn warnings(folder: &Path, file: &str, target: &str) -> String {
    String::from_utf8(run_mdlec(folder, &["check", file, "--target", target]).stderr).unwrap()
}

/// Returns the program and the arguments of a command, separated by spaces.
#[must_use]
pub fn called(command: &Command) -> String {
    let words = [command.get_program()].into_iter().chain(command.get_args());
    words.map(|word| word.to_str().unwrap()).collect::<Vec<_>>().join(" ")
}

/// Returns the command `mdle run FILE --target TARGET`.
#[must_use]
pub fn loaded(file: &str, target: &str) -> Command {
    let mut command = Command::new(mdle());
    command.args(["run", file, "--target", target]);
    command
}

/// Returns the options of a run in the simulator with this body and seed.
#[must_use]
pub fn in_simulator<'a>(body: &'a str, seed: &'a str) -> Vec<&'a str> {
    let [log, trail] = FILES;
    let mut options = vec!["--body", body, "--speed", "max", "--timeout", "200", "--log", log, "--trail", trail];
    options.extend(["--seed", seed]);
    options
}

/// Returns a simulated robot in the office, at the start of the tour.
#[must_use]
pub fn simulated(body: Body, step: Duration) -> Simulated {
    let world = World::office().unwrap();
    let make = Make { body, without: Vec::new(), seed: None };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Runs a command on the emulated robot of a target in lockstep, with a time limit in seconds.
#[must_use]
pub fn emulated_run(folder: &Path, target: &str, command: Command, timeout: &str) -> RunOutput {
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
