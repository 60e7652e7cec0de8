//! Tests `--machine`: executables for machines other than this one. `.ci/cross` builds and runs some of them.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::executable::{folder, run_mdlec};

/// Returns the message of a build with these arguments. Asserts that it fails with exit status 2 and writes nothing.
fn refusal(test: &str, arguments: &[&str]) -> String {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 1s) (go 20 0)) }\n").unwrap();
    let output = run_mdlec(&folder, &[&["plan.mdle", "--target", "sim"], arguments].concat());
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing is written");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn machines_without_a_library_are_refused() {
    let machine = |name| refusal("machines", &["--machine", name]);
    assert_eq!(
        machine("toaster"),
        "error: `toaster` is no machine that this Rust compiles for: name aarch64, armv7, x86_64, or a line of \
         `rustc --print target-list`\n"
    );
    assert_eq!(
        machine("thumbv7m-none-eabi"),
        "error: executables run on Linux, and `thumbv7m-none-eabi` does not: for a microcontroller, print the plan as Rust \
         with `--emit rust`\n"
    );
    for system in ["x86_64-apple-darwin", "x86_64-pc-windows-msvc"] {
        assert_eq!(
            machine(system),
            format!(
                "error: executables run on Linux, and `{system}` is another system: name aarch64, armv7, x86_64 or another \
                 triple of Linux\n"
            )
        );
    }
    // rustup has no standard library for this machine.
    assert_eq!(
        machine("aarch64_be-unknown-linux-gnu"),
        "error: Rust's standard library for `aarch64_be-unknown-linux-gnu` is not installed, and rustup is not here or does \
         not have it: install it as your distribution or the makers of the machine advise\n"
    );
}

#[test]
fn other_machines_get_executables_that_are_not_run() {
    assert_eq!(
        refusal("machine_run", &["--machine", "aarch64", "--run"]),
        "error: `--run` runs the executable here, and `--machine` builds it for another machine: copy it there\n"
    );
    assert_eq!(
        refusal("machine_emit", &["--machine", "aarch64", "--emit", "fsm"]),
        "error: `--machine` is for executables, and this `--emit` makes none\n"
    );
}
