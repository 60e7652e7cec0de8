//! Tests a target that is not part of `mdlec`, through the real binary: it works like any other target, and compile
//! errors in its crate are quoted in full, after a sentence that names the crate.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdle_tests::book::{fences, name, pages};
use mdle_tests::chance::sized;
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::outside;
use mdle_tests::repository::{files, root};

/// Returns the sentence before rustc's errors in the rover's crate, and the start of the first error.
fn sentence() -> String {
    let name = crate_name();
    format!("error: the target crate `{name}` does not compile; this is not a fault of your plan:\nerror[E0425]: ")
}

/// Returns the name of the rover's crate.
fn crate_name() -> &'static str {
    sized("rover_target", "mdle_sim")
}

/// Returns the folder of a plan, with a user's robot in `rover`: the template, built on the libraries of the cache. In
/// the long form of the test it is a copy of the simulator, in its own workspace, built on the libraries of the
/// repository.
fn with_rover(test: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), "{ Rest (Atom (wait 1ms) stop) }\n").unwrap();
    if sized(true, false) {
        assert_eq!(run_mdlec(&folder, &["new-target", "rover"]).status.code(), Some(0));
        return folder;
    }
    for file in files(&[".rs", ".toml", ".mdle", ".js"]) {
        let Some(name) = file.path.strip_prefix("targets/sim/") else { continue };
        let path = folder.join("rover").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, file.text).unwrap();
    }
    // The crate takes its versions from this workspace; the packages of the runtime stay in the repository.
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let (before, behind) = workspace.split_once("members = [").unwrap();
    let (_, behind) = behind.split_once("]\ndefault-members = [\"mdlec\"]\n").unwrap();
    let elsewhere = format!("path = \"{}/", root().to_str().unwrap());
    let workspace = format!("{before}members = [\"rover\"]\n{}", behind.replace("path = \"", &elsewhere));
    fs::write(folder.join("Cargo.toml"), workspace).unwrap();
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    folder
}

/// Returns the message of a build for the rover that must fail.
fn refused(folder: &Path) -> String {
    let output = run_mdlec(folder, &["plan.mdle", "--target", "rover"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &b""[..]), "{message}");
    assert!(!folder.join("plan").exists());
    // These lines are left out, because they depend on other builds.
    message
        .lines()
        .filter(|line| !line.starts_with("compiling libraries") && !line.starts_with("waiting for"))
        .fold(String::new(), |text, line| text + line + "\n")
}

#[test]
fn a_crate_that_does_not_compile_is_quoted_whole_and_serves_when_mended() {
    let folder = with_rover("own_target");
    let library = folder.join("rover/src/lib.rs");
    let good = fs::read_to_string(&library).unwrap();
    let bad = "\npub(crate) fn first() {\n    whistle();\n}\n\npub(crate) const SECOND: u8 = \"bell\";\n";
    fs::write(&library, format!("{good}{bad}")).unwrap();
    let message = refused(&folder);
    assert!(message.starts_with(&sentence()), "{message}");
    for quoted in ["    whistle();\n", "error[E0308]: mismatched types", "pub(crate) const SECOND: u8 = \"bell\";\n"] {
        assert!(message.contains(quoted), "{quoted:?} is missing in:\n{message}");
    }
    for other in ["Compiling", "could not compile", "internal error", "rustc --crate-name"] {
        assert!(!message.contains(other), "{other:?} is in:\n{message}");
    }

    fs::write(&library, good).unwrap();
    let output = run_mdlec(&folder, &["plan.mdle", "--target", "rover"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let run = Command::new(folder.join("plan")).args(["--speed", "max"]).output().unwrap();
    assert_eq!(run.stdout, b"0.1 s  plan over: wait 1ms (plan.mdle:1)\n");
}

#[test]
fn a_new_target_drives_and_feels_contact_once_it_can() {
    let folder = folder("new_target");
    let plan = "{ Touch (bumper)\n  (Atom (wait 3s) (go 20 0))\n  (Atom (null) go 10 0.5)\n}\n";
    fs::write(folder.join("plan.mdle"), plan).unwrap();
    let done = |arguments: &[&str]| {
        let output = run_mdlec(&folder, arguments);
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(done(&["new-target", "rover"]).0, Some(0));
    assert_eq!(done(&["bind", "--check", "rover/alphabet.mdle"]).0, Some(0));
    let (status, message) = done(&["plan.mdle", "--target", "./rover"]);
    assert!(status == Some(1) && message.contains("bumper"), "{message}");

    // As described in the book.
    let change = |file: &str, from: &str, to: &str| {
        let path = folder.join("rover").join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from) && !text.contains("template"), "{file}: {text}");
        fs::write(path, text.replace(from, to)).unwrap();
    };
    change("alphabet.mdle", "odometry;", "odometry, bumper;");
    change("src/hardware.rs", "switches: 0,", "switches: u32::from(self.pose.x.0 > 0.795),");
    assert_eq!(done(&["bind", "rover/alphabet.mdle"]).0, Some(0));
    let (status, message) = done(&["plan.mdle", "--target", "./rover"]);
    assert_eq!(status, Some(0), "{message}");
    let run = Command::new(folder.join("plan")).args(["--speed", "max", "--timeout", "60"]).output().unwrap();
    let printed = String::from_utf8(run.stdout).unwrap();
    insta::assert_snapshot!(printed, @r"
    3.0 s  go 10 0.5 (plan.mdle:3)  <- wait 3s (plan.mdle:2)
    5.7 s  plan over: bumper (plan.mdle:1)
    ");
}

/// Runs the conformance suite on the robot in this folder. Returns `true` if it passes, and cargo's output.
fn conformance(robot: &Path) -> (bool, String) {
    let output = outside::cargo(robot, &["test", "--quiet", "--test", "conformance"]).output().unwrap();
    let message = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.success(), message.concat())
}

#[test]
fn a_new_target_conforms_until_a_sign_is_wrong() {
    let folder = folder("new_target_conforms");
    assert_eq!(run_mdlec(&folder, &["new-target", "rover"]).status.code(), Some(0));
    let robot = folder.join("rover");
    // As described in the book for builds by cargo.
    outside::patch(&robot);
    let (passed, message) = conformance(&robot);
    assert!(passed, "{message}");

    let hardware = robot.join("src/hardware.rs");
    let text = fs::read_to_string(&hardware).unwrap();
    let wrong = text.replace("Radians(speeds.omega.0 * seconds)", "Radians(-speeds.omega.0 * seconds)");
    assert_ne!(wrong, text);
    fs::write(&hardware, wrong).unwrap();
    let (passed, message) = conformance(&robot);
    let sentence = "the body turned counter-clockwise by -0.800 rad instead of 0.800 rad: a sign in the input";
    assert!(!passed && message.contains(sentence), "{message}");
}

#[test]
fn the_robot_of_the_book_conforms() {
    let folder = folder("robot_of_the_book");
    assert_eq!(run_mdlec(&folder, &["new-target", "wheels"]).status.code(), Some(0));
    let page = pages().into_iter().find(|page| name(page) == "own_robot.md").unwrap();
    let fences = fences(&page);
    let written: Vec<_> = fences.iter().filter(|fence| fence.words[0] == "rust").collect();
    assert!(!written.is_empty(), "the driver and its test are gone");
    for fence in written {
        fs::write(folder.join(fence.file().unwrap()), &fence.text).unwrap();
    }
    outside::patch(&folder.join("wheels"));
    let command = fences.iter().find(|fence| fence.words == ["sh"]).unwrap();
    let words: Vec<_> = command.text.split_whitespace().skip(1).collect();
    let output = outside::cargo(&folder, &words).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success() && out.contains("test the_robot_conforms ... ok"), "{out}{err}");
}

#[test]
fn a_new_target_holds_every_file_of_the_template() {
    let folder = folder("new_target_files");
    assert_eq!(run_mdlec(&folder, &["new-target", "template"]).status.code(), Some(0));
    for file in
        files(&[".rs", ".toml", ".mdle", ".js"]).iter().filter(|file| file.path.starts_with("targets/template/"))
    {
        let written = fs::read_to_string(folder.join(file.path.trim_start_matches("targets/"))).expect(&file.path);
        assert!(written == file.text || file.path.ends_with("Cargo.toml"), "{}", file.path);
    }
}

#[test]
fn a_build_script_that_fails_is_quoted() {
    let folder = with_rover("own_build_script");
    fs::write(folder.join("rover/build.rs"), "fn main() {\n    panic!(\"no library of the whistle\");\n}\n").unwrap();
    let message = refused(&folder);
    let (first, quoted) = message.split_once('\n').unwrap();
    assert!(sentence().starts_with(first), "{message}");
    assert!(quoted.contains("no library of the whistle"), "{message}");
}

#[test]
fn a_manifest_that_cargo_refuses_is_no_fault_of_the_plan() {
    let folder = with_rover("own_manifest");
    let manifest = folder.join("rover/Cargo.toml");
    let good = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, format!("{good}\n[dependencies.whistle]\npath = \"../whistle\"\n")).unwrap();
    let message = refused(&folder);
    let name = crate_name();
    let sentence = format!("error: cargo cannot use the target crate `{name}`; this is not a fault of your plan:\n");
    assert!(message.starts_with(&sentence) && message.contains("whistle"), "{message}");
}
