//! Tests the answers of `mdle why` about records that a test writes, and the operands that the answers name.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod absences;
mod keys;
mod other_plans;
mod questions;
mod random;
mod scripted;
mod several_plans;

use std::path::Path;
use std::process::Command;

use mdle_tests::executable::mdle;

/// Runs `mdle` with these arguments. Returns its output, its messages and its exit status as one text.
fn asked(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    let status = output.status.code().unwrap();
    format!("$ mdle {}\n{out}{err}[{status}]\n", arguments.join(" "))
}
