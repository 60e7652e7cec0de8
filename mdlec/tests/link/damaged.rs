//! Tests that mdlec repairs a damaged cache, and then builds the executable of the current plan.
//!
//! Compiling all libraries again takes long. If the variable `MDLE_LONG` is set to anything but 1, the tests damage all
//! libraries and compile them again. Otherwise a test damages only a few libraries, or it ends when the build reports
//! that it compiles everything again.

use std::fs::{self, File};
use std::os::unix::fs::MetadataExt;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime};

use mdlec::link::{BuildStep, LinkError};

use crate::robot::{MANIFEST, PLAN, ROVER, Robot, target};

/// Returns the robot whose cache is damaged. The cache contains libraries from earlier test runs, but no plans.
fn robot() -> Robot {
    let robot = Robot::new("damaged", MANIFEST, ROVER);
    for plan in files(robot.cache.folder(), &|name| name.starts_with("plan-nap-")) {
        fs::remove_file(plan).unwrap();
    }
    let packages = robot.cache.folder().join("plans");
    if packages.exists() {
        fs::remove_dir_all(packages).unwrap();
    }
    robot
}

/// Returns `true` if the tests may compile all libraries several times.
fn is_long() -> bool {
    std::env::var("MDLE_LONG").is_ok_and(|factor| factor != "1")
}

/// Builds the plan that ends with the cause `cause`, runs it, and checks its output.
fn assert_builds(robot: &Robot, cause: &str) {
    let (_, output) = robot.build("nap.mdle", &PLAN.replace("morning", cause)).unwrap();
    let message = Command::new(output).output().unwrap();
    assert!(String::from_utf8(message.stdout).unwrap().contains(&format!("plan over: {cause}")));
}

/// Asserts that a build finds that everything must be compiled again. If [`is_long`] is `true`, the build compiles
/// everything, and the plan that ends with the cause `cause` runs. Otherwise the build is stopped, and `restore` undoes
/// the damage.
fn assert_mends(robot: &Robot, cause: &str, restore: impl FnOnce()) {
    if is_long() {
        return assert_builds(robot, cause);
    }
    let mut leave = |progress| {
        if progress == BuildStep::Mending {
            // `resume_unwind` prints no message, because this is not a failure.
            panic::resume_unwind(Box::new(progress));
        }
    };
    let rust = PLAN.replace("morning", cause);
    // The build discards the list of compiled files, so the test restores it.
    let list = robot.cache.folder().join("compiled");
    let listed = fs::read(&list).unwrap();
    let ended = panic::catch_unwind(AssertUnwindSafe(|| robot.build_with("nap.mdle", &rust, &mut leave)));
    restore();
    fs::write(list, listed).unwrap();
    assert_eq!(ended.unwrap_err().downcast_ref(), Some(&BuildStep::Mending));
}

/// Returns the files below `folder` whose names `wanted` accepts.
fn files(folder: &Path, wanted: &dyn Fn(&str) -> bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, wanted));
        } else if wanted(path.file_name().unwrap().to_str().unwrap()) {
            found.push(path);
        }
    }
    found
}

/// Truncates each file to this percentage of its length; hard links to the file change as well.
fn cut(files: &[PathBuf], hundredths: u64) {
    assert!(!files.is_empty());
    for path in files {
        let file = File::options().write(true).open(path).unwrap();
        file.set_len(file.metadata().unwrap().len() * hundredths / 100).unwrap();
    }
}

#[test]
fn a_stored_executable_that_is_damaged_is_built_anew() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let libraries = fs::metadata(target(&robot.cache)).unwrap().ino();
    let stored = || {
        let stored = files(robot.cache.folder(), &|name| name.starts_with("plan-nap-") && !name.contains('.'));
        assert_eq!(stored.len(), 1);
        stored
    };
    cut(&stored(), 0);
    assert_builds(&robot, "morning");
    let mut bytes = fs::read(&stored()[0]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&stored()[0], bytes).unwrap();
    assert_builds(&robot, "morning");
    fs::remove_file(&stored()[0]).unwrap();
    assert_builds(&robot, "morning");
    assert_eq!(fs::metadata(target(&robot.cache)).unwrap().ino(), libraries, "the rest stays");
}

#[test]
fn libraries_that_are_damaged_are_built_anew() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let libraries = |own: &[&str], ending: &str| {
        let is_chosen = |name: &str| is_long() || own.iter().any(|own| name.starts_with(own));
        files(&target(&robot.cache), &|name| name.ends_with(ending) && is_chosen(name))
    };
    cut(&libraries(&["libmdle_rover"], ".rlib"), 50);
    assert_builds(&robot, "noon");
    cut(&libraries(&["libmdle_rover"], ".rmeta"), 0);
    assert_builds(&robot, "night");

    // A third-party library without its fingerprint is compiled again, beside other libraries that are empty.
    let compiled = files(&target(&robot.cache), &|name| name.starts_with("lib-thread_priority"));
    cut(&libraries(&["libmdle_", "libthread_priority"], ".rmeta"), 0);
    compiled.iter().for_each(|fingerprint| fs::remove_file(fingerprint).unwrap());
    assert!(!compiled.is_empty());
    assert_builds(&robot, "noon");
}

#[test]
fn a_file_in_place_of_all_libraries_is_removed() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let (libraries, aside) = (target(&robot.cache), robot.folder.join("aside"));
    let _ = fs::remove_dir_all(&aside);
    fs::rename(&libraries, &aside).unwrap();
    fs::write(&libraries, "garbage").unwrap();
    assert_mends(&robot, "noon", || {
        fs::remove_file(&libraries).unwrap();
        fs::rename(&aside, &libraries).unwrap();
    });
    assert_builds(&robot, "noon");
}

#[test]
fn a_library_that_another_was_put_in_place_of_is_not_used() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let host = files(&target(&robot.cache), &|name| name.starts_with("libmdle_host-") && name.ends_with(".rlib"));
    let [host] = host.as_slice() else { panic!("{host:?}") };
    let mut bytes = fs::read(host).unwrap();
    let times = fs::metadata(host).unwrap().modified().unwrap();
    // Replaces the text of its report. Cargo and rustc do not notice this, because the time and the size stay the same.
    let words = b"plan over";
    let places: Vec<_> = (0..bytes.len() - words.len()).filter(|at| bytes[*at..].starts_with(words)).collect();
    assert!(!places.is_empty());
    places.iter().for_each(|at| bytes[*at..*at + words.len()].copy_from_slice(b"plan ruin"));
    fs::write(host, bytes).unwrap();
    File::options().append(true).open(host).unwrap().set_modified(times).unwrap();
    assert_builds(&robot, "noon");
}

#[test]
fn damage_that_makes_cargo_panic_is_mended() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let outputs = files(&target(&robot.cache), &|name| name == "root-output");
    assert!(!outputs.is_empty());
    let texts: Vec<_> = outputs.iter().map(|output| fs::read(output).unwrap()).collect();
    outputs.iter().for_each(|output| fs::write(output, b"\xFF").unwrap());
    assert_mends(&robot, "noon", || {
        outputs.iter().zip(texts).for_each(|(output, text)| fs::write(output, text).unwrap());
    });
    assert_builds(&robot, "noon");
}

#[test]
fn a_fault_of_the_target_is_not_taken_for_damage() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let libraries = fs::metadata(target(&robot.cache)).unwrap().ino();
    fs::write(robot.folder.join("rover/src/lib.rs"), ROVER.replace("Ok(Self)", "Ok(Rower)")).unwrap();
    assert!(matches!(robot.build("nap.mdle", PLAN), Err(LinkError::TargetBroken { .. })));
    fs::write(robot.folder.join("rover/src/lib.rs"), format!("extern crate forgotten;\n{ROVER}")).unwrap();
    assert!(matches!(robot.build("nap.mdle", PLAN), Err(LinkError::TargetBroken { .. })));
    fs::write(robot.folder.join("rover/src/lib.rs"), ROVER).unwrap();
    assert!(matches!(robot.build("nap.mdle", "nonsense"), Err(LinkError::TargetMisfit { .. })));
    assert_eq!(fs::metadata(target(&robot.cache)).unwrap().ino(), libraries);
    assert_builds(&robot, "morning");
}

#[test]
fn files_of_the_package_that_are_damaged_are_written_anew() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let package = fs::read_dir(robot.cache.folder().join("plans")).unwrap().next().unwrap().unwrap().path();
    for name in ["Cargo.toml", "Cargo.lock", "seed.lock", "src/main.rs", "src/plan.rs", "built"] {
        let text = fs::read(package.join(name)).unwrap();
        for damage in [b"garbage\xFF", &text[..text.len() / 2]] {
            fs::write(package.join(name), damage).unwrap();
            assert_builds(&robot, "morning");
        }
    }
    fs::remove_dir_all(package.join("src")).unwrap();
    fs::write(package.join("src"), "garbage").unwrap();
    assert_builds(&robot, "morning");
    // A lock file that no process has locked does not block a build, regardless of its contents.
    fs::write(robot.cache.folder().join("lock"), "4711 garbage").unwrap();
    assert_builds(&robot, "morning");
}

#[test]
fn a_clock_that_was_set_back_does_not_bring_an_old_plan_back() {
    let robot = robot();
    assert_builds(&robot, "morning");
    let tomorrow = SystemTime::now() + Duration::from_secs(24 * 60 * 60);
    for file in files(&target(&robot.cache), &|name| name.contains("plan")) {
        File::options().append(true).open(file).unwrap().set_modified(tomorrow).unwrap();
    }
    assert_builds(&robot, "noon");
}
