//! `mdlec emulator`: builds the emulator of a robot in the cache, and runs it in place of this process.

use std::os::unix::process::CommandExt;
use std::process::Command;

use super::executable::{become_program, take_signals};
use super::progress::ProgressOutput;
use super::{CommandFailure, EmulatorArguments};
use crate::link::{self, Cache};

/// Builds a robot's emulator and replaces the current process with it.
pub(super) fn emulator(options: &EmulatorArguments) -> Result<(), CommandFailure> {
    take_signals()?;
    let robot = &options.robot;
    let mut shown = ProgressOutput::default();
    let built =
        Cache::of_user().and_then(|cache| link::emulator(&cache, robot, &mut |progress| shown.progress(&progress)));
    shown.close();
    let built = built?;
    become_program(Command::new(&built.path).arg0(format!("{robot}-emulator")).args(&options.args))
}
