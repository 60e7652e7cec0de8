//! Tests that `mdlec` ends by itself with a message on any bytes. This needs the real binary, because a stack overflow
//! cannot be caught.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::files;

/// Words of plans, scripts and alphabets.
const WORDS: [&str; 48] = [
    "{",
    "}",
    "(",
    ")",
    "((",
    "))",
    "{ P",
    "Atom",
    "(Atom (wait 1) stop)",
    "bumper",
    "wait",
    "stop",
    "go 20 0",
    "inf",
    "^2",
    "^",
    "^1000000",
    "ExecPlan",
    "AND",
    "OR",
    "NOT",
    "FRAME",
    "RISING",
    "after",
    "null",
    "1",
    "0.5s",
    "90deg",
    "-3",
    "1e400",
    "18446744073709551616",
    "cm/s",
    "//",
    "/*",
    "\"",
    "\\",
    "\n",
    "\0",
    "é",
    "target",
    "use atoms;",
    "control",
    "interrupt",
    ":",
    ";",
    "[16]",
    "{\"t\": 0.0}",
    "[[[[",
];

/// Number of random files of each kind.
const FILES: u64 = 14;

fn bytes(chance: &mut Chance) -> Vec<u8> {
    let length = chance.below(1500);
    (0..length).map(|_| chance.below(256) as u8).collect()
}

fn words(chance: &mut Chance) -> Vec<u8> {
    let count = 1 + chance.below(120);
    (0..count).map(|_| chance.pick(&WORDS)).collect::<Vec<_>>().join(" ").into_bytes()
}

/// Returns a valid file with a few changed bytes, whose end may be cut off or repeated.
fn spoilt(good: &[u8], chance: &mut Chance) -> Vec<u8> {
    let mut bytes = good.to_vec();
    for _ in 0..1 + chance.below(4) {
        let place = chance.below(bytes.len());
        bytes[place] = *b"(){}^ 0aA;\"\xFF".get(chance.below(12)).unwrap();
    }
    match chance.below(3) {
        0 => bytes.truncate(chance.below(bytes.len())),
        1 => bytes.extend_from_within(chance.below(bytes.len())..),
        _ => {}
    }
    bytes
}

/// Runs mdlec, and asserts that it ends with one of these exit statuses.
fn assert_ends(folder: &Path, arguments: &[&str], statuses: &[i32], seed: u64) {
    let output = run_mdlec(folder, arguments);
    let message = String::from_utf8(output.stderr).expect("UTF-8");
    let status = output.status.code().unwrap_or_else(|| panic!("{seed}: {arguments:?}: {}\n{message}", output.status));
    assert!(statuses.contains(&status), "{seed}: {arguments:?}: {status}\n{message}");
    assert!(status == 0 || message.contains("error: "), "{seed}: {arguments:?}: {status}\n{message}");
    assert!(!message.contains("panicked"), "{seed}: {arguments:?}\n{message}");
}

#[test]
fn random_bytes_are_no_plan() {
    let folder = folder("random_bytes");
    fs::write(folder.join("script"), "{\"t\": 0}\n").unwrap();
    for seed in 0..repeated(FILES) {
        let mut chance = Chance::new(seed);
        for make in [bytes, words] {
            fs::write(folder.join("plan.mdle"), make(&mut chance)).unwrap();
            for arguments in [
                &["check", "plan.mdle"][..],
                &["trace", "plan.mdle", "--script", "script"],
                &["plan.mdle", "--target", "sim"],
            ] {
                assert_ends(&folder, arguments, &[1, 2], seed);
            }
        }
    }
    assert!(!folder.join("plan").exists());
}

#[test]
fn a_spoilt_plan_is_a_plan_or_an_error() {
    let folder = folder("spoilt_plans");
    let plans = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect::<Vec<_>>();
    fs::write(folder.join("script"), "{\"t\": 0}\n{\"t\": 9}\n").unwrap();
    for seed in 0..repeated(FILES) {
        let mut chance = Chance::new(seed);
        let good = &plans[chance.below(plans.len())].text;
        fs::write(folder.join("plan.mdle"), spoilt(good.as_bytes(), &mut chance)).unwrap();
        assert_ends(&folder, &["check", "plan.mdle"], &[0, 1], seed);
        // A file with several plans is a usage error.
        assert_ends(&folder, &["trace", "plan.mdle", "--script", "script"], &[0, 1, 2], seed);
        assert_ends(&folder, &["plan.mdle", "--target", "sim", "--emit", "rust"], &[0, 1, 2], seed);
    }
}

#[test]
fn a_random_script_is_wrong_usage() {
    let folder = folder("random_scripts");
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 1) stop) }\n").unwrap();
    let good = b"{\"t\": 0.0, \"fired\": [\"bumper\"], \"completed\": []}\n{\"t\": 0.1}\n";
    for seed in 0..repeated(FILES) {
        let mut chance = Chance::new(seed);
        for script in [bytes(&mut chance), words(&mut chance), spoilt(good, &mut chance)] {
            fs::write(folder.join("script"), script).unwrap();
            // A script without lines ends at once; a script that is not text is an error with a code, as in plans.
            assert_ends(&folder, &["trace", "plan.mdle", "--script", "script"], &[0, 1, 2], seed);
        }
    }
}

#[test]
fn a_random_alphabet_is_no_target() {
    let folder = folder("random_alphabets");
    fs::create_dir(folder.join("rover")).unwrap();
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 1) stop) }\n").unwrap();
    let alphabets = files(&["alphabet.mdle"]);
    for seed in 0..repeated(FILES) {
        let mut chance = Chance::new(seed);
        let good = &alphabets[chance.below(alphabets.len())].text;
        for alphabet in [bytes(&mut chance), words(&mut chance), spoilt(good.as_bytes(), &mut chance)] {
            fs::write(folder.join("rover/alphabet.mdle"), alphabet).unwrap();
            for arguments in [&["check", "plan.mdle", "--target", "rover"][..], &["quarks", "--target", "rover"]] {
                assert_ends(&folder, arguments, &[0, 1, 2], seed);
            }
        }
    }
}
