//! Tests that an executable in which a panic aborts does not compile, because the robot would not be stopped.
#![allow(clippy::unwrap_used, reason = "what fails here is the test")]

use std::process::Command;

/// Returns `true` if the check compiles with this panic strategy, and the messages of rustc.
fn compiled(panic: &str) -> (bool, String) {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut command = Command::new(rustc);
    command.args(["--crate-type", "lib", "--emit", "metadata", "--out-dir", env!("CARGO_TARGET_TMPDIR")]);
    let output = command.args(["-C", &format!("panic={panic}"), "src/unwinding.rs"]).output().unwrap();
    (output.status.success(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn panics_must_unwind() {
    assert_eq!(compiled("unwind"), (true, String::new()));
    let (compiles, message) = compiled("abort");
    assert!(!compiles && message.contains("set `panic = \"unwind\"` in the profile"), "{message}");
}
