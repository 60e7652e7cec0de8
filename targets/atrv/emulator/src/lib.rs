//! Robot emulator of an ATRV-mini. It speaks the robot's protocol on a pseudo-terminal, and moves the body in a
//! simulated world.
#![forbid(unsafe_code)]

pub mod atrv;
pub mod wire;

use std::process::ExitCode;

use mdle_emulator::{EmulatorOptions, program};
use mdle_host::clap::{Arg, ArgAction, Command};
use mdle_simulator::Body;

use atrv::{Atrv, step};

/// Runs the robot emulator with the arguments of this process until a signal arrives; returns the exit status.
pub fn main() -> ExitCode {
    let about = "Emulate an iRobot ATRV-mini on a pseudo-terminal, in a simulated world";
    let marks = Arg::new("marks").long("marks").action(ArgAction::SetTrue);
    let marks = marks.help("Accept escaped 1B bytes in commands; without this option such a command is lost");
    let matches = EmulatorOptions::arguments(Command::new("atrv-emulator").about(about)).arg(marks).get_matches();
    let marks = matches.get_flag("marks");
    program("the ATRV", Body::Atrv, &EmulatorOptions::of(&matches), step, |body, step| Atrv::new(body, step, marks))
}
