//! Tests that emitted Rust is built into a static executable, or that an error message explains why it cannot be built.

use std::fs;
use std::process::Command;

use mdlec::link::{Built, LinkError};

use crate::robot::{MANIFEST, PLAN, ROVER, Robot};

#[test]
fn the_executable_is_static_and_holds_no_path_of_this_machine() {
    let robot = Robot::new("static", MANIFEST, ROVER);
    let (built, output) = robot.build("nap.mdle", PLAN).unwrap();
    let bytes = fs::read(&output).unwrap();
    assert_eq!(built.size, bytes.len() as u64);
    assert!(!has_interpreter(&bytes));
    let user = std::env::home_dir().unwrap();
    for place in [robot.cache.folder(), user.as_path()] {
        let place = place.as_os_str().as_encoded_bytes();
        assert!(!bytes.windows(place.len()).any(|window| window == place), "{}", String::from_utf8_lossy(place));
    }
    let message = Command::new(&output).output().unwrap();
    assert_eq!(message.status.code(), Some(0), "{message:?}");
    assert!(String::from_utf8(message.stdout).unwrap().contains("plan over: morning"));
}

#[test]
fn the_same_text_again_is_fresh() {
    let robot = Robot::new("again", MANIFEST, ROVER);
    let (first, output) = robot.build("nap.mdle", PLAN).unwrap();
    let before = fs::read(&output).unwrap();
    let (second, _) = robot.build("nap.mdle", PLAN).unwrap();
    assert_eq!(second, Built { size: first.size, fresh: true });
    assert_eq!(before, fs::read(&output).unwrap());
}

#[test]
fn plans_of_one_name_do_not_meet() {
    let robot = Robot::new("names", MANIFEST, ROVER);
    let (_, left) = robot.build("left/nap.mdle", &PLAN.replace("morning", "noon")).unwrap();
    let (_, right) = robot.build("right/nap.mdle", &PLAN.replace("morning", "night")).unwrap();
    for (output, cause) in [(left, "noon"), (right, "night")] {
        let message = Command::new(output).output().unwrap();
        assert!(String::from_utf8(message.stdout).unwrap().contains(cause));
    }
}

#[test]
fn a_target_that_does_not_compile_is_quoted_whole() {
    let robot = Robot::new("broken", MANIFEST, &ROVER.replace("Ok(Self)", "Ok(Rower)"));
    let error = robot.build("nap.mdle", PLAN).unwrap_err();
    let text = error.to_string();
    let (sentence, quoted) = text.split_once('\n').unwrap();
    assert_eq!(sentence, "the target crate `mdle_rover` does not compile; this is not a fault of your plan:");
    assert!(quoted.starts_with("error[E0425]"), "{quoted}");
    assert!(quoted.contains("Rower") && !quoted.contains("Compiling"), "{quoted}");
    assert_eq!(error.exit_status(), 2);
}

#[test]
fn a_plan_that_does_not_fit_the_target_is_not_quoted() {
    let robot = Robot::new("misfit", MANIFEST, ROVER);
    let error = robot.build("nap.mdle", &PLAN.replace("Sensed", "Felt")).unwrap_err();
    let LinkError::TargetMisfit { log, .. } = &error else { panic!("{error:?}") };
    assert!(fs::read_to_string(log).unwrap().contains("Felt"));
    assert!(!error.to_string().contains("Felt"));
    assert_eq!(error.exit_status(), 2);
}

#[test]
fn a_target_must_be_what_its_alphabet_says() {
    let refused = |name: &str, manifest: &str| Robot::new(name, manifest, ROVER).build("nap.mdle", PLAN).unwrap_err();
    let error = refused("other", &MANIFEST.replace("mdle-rover", "mdle-scout"));
    assert!(matches!(&error, LinkError::OtherCrate { found, .. } if found == "`mdle_scout`"), "{error:?}");
    let error = refused("without", &MANIFEST.replace("mdle-host", "mdle-home"));
    assert!(matches!(error, LinkError::TargetLacks { missing: "mdle-host", .. }), "{error:?}");
    let error = refused("garbled", "[package");
    assert!(matches!(error, LinkError::TargetRefused { .. }), "{error:?}");

    let robot = Robot::new("none", MANIFEST, ROVER);
    fs::remove_file(robot.folder.join("rover/Cargo.toml")).unwrap();
    let error = robot.build("nap.mdle", PLAN).unwrap_err();
    assert!(matches!(error, LinkError::NotACrate(_)), "{error:?}");
}

/// Returns `true` if a 64-bit ELF file requests a dynamic loader, with a program header of type 3.
fn has_interpreter(elf: &[u8]) -> bool {
    assert_eq!(elf[..5], *b"\x7fELF\x02");
    let number = |at: usize, bytes: usize| elf[at..at + bytes].iter().rev().fold(0, |n, byte| n << 8 | *byte as usize);
    let (headers, size, count) = (number(0x20, 8), number(0x36, 2), number(0x38, 2));
    (0..count).any(|header| number(headers + header * size, 4) == 3)
}
