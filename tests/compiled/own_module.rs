//! Tests `mdle new-module`: the crate builds and its test passes, but the test fails if the module publishes another
//! value.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;

use mdle_tests::executable::{folder, mdle, target};
use mdle_tests::repository::{files, root};

/// Creates a module in this folder that depends on the packages of this checkout.
fn create(folder: &Path, name: &str) {
    let mut command = Command::new(mdle());
    command.args(["new-module", name, "--checkout"]).arg(root()).current_dir(folder);
    let output = command.output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && text.starts_with(&format!("`{name}` is a program with all of `mdle`")),
        "{text}"
    );
}

/// Runs the tests of the module in this folder. Returns `true` if they pass, and cargo's output.
fn tested(module: &Path) -> (bool, String) {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["test", "--offline", "--quiet", "--target-dir"]).arg(target()).current_dir(module);
    let output = command.output().unwrap();
    let message = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.success(), message.concat())
}

#[test]
fn a_plan_waits_for_a_new_module() {
    let folder = folder("new_module");
    create(&folder, "ears");
    let module = folder.join("ears");
    // With this lock file, no network is needed.
    fs::copy(root().join("Cargo.lock"), module.join("Cargo.lock")).unwrap();
    let (passed, message) = tested(&module);
    assert!(passed, "{message}");

    let library = module.join("src/lib.rs");
    let text = fs::read_to_string(&library).unwrap();
    fs::write(&library, text.replace("Meters(libm::hypot(x, y))", "Meters(0.0)")).unwrap();
    let (passed, message) = tested(&module);
    assert!(!passed && message.contains("plan over: bumper"), "{message}");
}

#[test]
fn a_new_module_needs_a_checkout() {
    let folder = folder("new_module_alone");
    let output = Command::new(mdle()).args(["new-module", "ears"]).current_dir(&folder).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    let expected =
        "error: there is no checkout of mdle in `../mdle` of the new folder\nhelp: `--checkout FOLDER` names one\n";
    assert_eq!((message.as_str(), output.status.code()), (expected, Some(2)));
    assert!(!folder.join("ears").exists());
}

#[test]
fn a_new_module_holds_every_file_of_the_template() {
    let folder = folder("new_module_files");
    create(&folder, "template");
    let files = files(&[".rs", ".toml", ".mdle"]);
    let files: Vec<_> = files.iter().filter_map(|file| file.path.strip_prefix("runtime/template/")).collect();
    assert_eq!(files.len(), 5);
    files.iter().for_each(|file| assert!(folder.join("template").join(file).exists(), "{file}"));
}
