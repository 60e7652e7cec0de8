//! Tests that special files and endless files are refused at once wherever a command or an executable reads a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use mdle_tests::executable::{self, command, folder, run_mdlec};

/// Time after which a command counts as hanging; a refusal takes far less.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs a command, and panics if it hangs.
fn ended(mut command: Command) -> Output {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{command:?} hangs");
        }
        thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

/// Returns a folder with files of every refused kind in its folder `strange`, and with a valid plan, script and
/// machine.
fn prepared(test: &str) -> PathBuf {
    let folder = folder(test);
    let strange = folder.join("strange");
    // The files are used as settings and as plans. A TOML file in place of a plan is a scenario.
    for ending in ["toml", "mdle"] {
        let named = |name: &str| strange.join(name).with_extension(ending);
        fs::create_dir_all(named("folder")).unwrap();
        symlink("/dev/zero", named("zero")).unwrap();
        symlink("/proc/kmsg", named("kmsg")).unwrap();
        assert!(Command::new("mkfifo").arg(named("pipe")).status().unwrap().success());
        File::create(named("sparse")).unwrap().set_len(1 << 40).unwrap();
    }
    fs::write(folder.join("plan.mdle"), "{ P (Atom (wait 1) stop) }\n").unwrap();
    fs::write(folder.join("uses.mdle"), "use \"STRANGE\"\n{ P (Atom (wait 1) stop) }\n").unwrap();
    folder
}

const KINDS: [&str; 5] = ["folder.toml", "zero.toml", "pipe.toml", "kmsg.toml", "sparse.toml"];

/// Asserts that a file of this kind was refused with a message that names the kind and the file.
fn assert_refused(output: &Output, kind: &str) {
    let error = String::from_utf8(output.stderr.clone()).unwrap();
    let expected = match kind.split('.').next().unwrap() {
        "folder" => "is a folder",
        "zero" => "is a device",
        "pipe" => "is a pipe",
        // Some users may not open this file, so the message differs.
        "kmsg" => "",
        _ => "is larger than",
    };
    assert!(error.contains(expected) && error.contains(kind), "{kind}: {error}");
    assert!(matches!(output.status.code(), Some(1 | 2)), "{kind}: {:?} {error}", output.status);
}

#[test]
fn mdlec_reads_regular_files_only() {
    let folder = prepared("strange_mdlec");
    for kind in KINDS {
        let file = format!("strange/{kind}");
        let file = file.as_str();
        for arguments in [
            &["check", file][..],
            &["fmt", "--check", file],
            &["analyze", file],
            &["draw", file],
            &["decompile", file],
            &["bind", file],
            &["trace", "plan.mdle", "--script", file],
            &["trace", file, "--script", "plan.mdle"],
        ] {
            assert_refused(&ended(command(&folder, arguments)), kind);
        }
        let plan = format!("strange/{}", kind.replace("toml", "mdle"));
        for arguments in [&["check", &plan][..], &["trace", &plan, "--script", "plan.mdle"], &[&plan, "--emit", "plan"]]
        {
            assert_refused(&ended(command(&folder, arguments)), &kind.replace("toml", "mdle"));
        }
        let text = fs::read_to_string(folder.join("uses.mdle")).unwrap().replace("STRANGE", file);
        fs::write(folder.join("used.mdle"), text).unwrap();
        let used = ended(command(&folder, &["check", "used.mdle"]));
        assert_refused(&used, kind);
        assert!(String::from_utf8_lossy(&used.stderr).contains("E0205"), "{used:?}");
        let target = folder.join("robot");
        fs::create_dir_all(&target).unwrap();
        let _ = fs::remove_file(target.join("alphabet.mdle"));
        symlink(folder.join(file), target.join("alphabet.mdle")).unwrap();
        let output = ended(command(&folder, &["quarks", "--target", "robot"]));
        assert_eq!(output.status.code(), Some(2), "{output:?}");
    }
}

#[test]
fn standard_input_is_read_up_to_a_size() {
    let folder = prepared("strange_input");
    let mut endless = command(&folder, &["check", "-"]);
    endless.stdin(File::open("/dev/zero").unwrap());
    let output = ended(endless);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(error, "error: `standard input` is larger than 64 MB, which is the most\n");
    let mut pipe = command(&folder, &["check", "-"]);
    pipe.stdin(File::open(folder.join("plan.mdle")).unwrap());
    assert!(ended(pipe).status.success());
}

#[test]
fn a_pipe_in_the_place_of_a_plan_is_answered_with_what_to_type() {
    let folder = prepared("strange_pipe");
    let error = run_mdlec(&folder, &["check", "strange/pipe.mdle"]).stderr;
    let expected = "error: `strange/pipe.mdle` is a pipe, not a file\nhelp: `-` in its place reads standard input\n";
    assert_eq!(String::from_utf8(error).unwrap(), expected);
}

/// Builds the executable of a plan in the folder of a test, and returns its path.
fn built(folder: &Path, target: &str) -> PathBuf {
    let output = run_mdlec(folder, &["plan.mdle", "--target", target, "-o", target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(target)
}

#[test]
fn executables_read_regular_files_and_configurations_from_pipes() {
    let folder = prepared("strange_executable");
    let (sim, scout) = (built(&folder, "sim"), built(&folder, "scout"));
    fs::write(folder.join("map.yaml"), "image: strange/pipe.toml\nresolution: 0.1\norigin: [0, 0, 0]\n").unwrap();
    for kind in KINDS {
        for (program, option) in [(&sim, "--world"), (&scout, "--config")] {
            let mut command = Command::new(program);
            command.args([option, &format!("strange/{kind}")]).current_dir(&folder);
            let output = ended(command);
            if (option, kind) == ("--config", "pipe.toml") {
                // A configuration may come from a pipe, but no process writes to this one.
                let error = String::from_utf8_lossy(&output.stderr);
                assert_eq!(error, "error: strange/pipe.toml: nothing has been written to this pipe\n");
                assert_eq!(output.status.code(), Some(2));
            } else {
                assert_refused(&output, kind);
            }
        }
    }
    let mut map = Command::new(&sim);
    map.args(["--world", "map.yaml"]).current_dir(&folder);
    let output = ended(map);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("is a pipe") && output.status.code() == Some(2), "{error}");
}

#[test]
fn alphabets_that_no_crate_can_have_are_refused_by_every_command() {
    let folder = executable::folder("strange_alphabets");
    fs::create_dir_all(folder.join("robot/src")).unwrap();
    fs::write(folder.join("plan.mdle"), "{ P (Atom (wait 1) stop) }\n").unwrap();
    for name in ["x/y", "größe", "fn", "_", "self", "gen"] {
        fs::write(folder.join("robot/alphabet.mdle"), format!("target t : crate {name};\nuse atoms;\n")).unwrap();
        for arguments in [
            &["plan.mdle", "--target", "robot"][..],
            &["plan.mdle", "--target", "robot", "--emit", "rust"],
            &["check", "--target", "robot", "plan.mdle"],
            &["quarks", "--target", "robot"],
            &["bind", "robot/alphabet.mdle"],
            &["bind", "--check", "robot/alphabet.mdle"],
        ] {
            let output = run_mdlec(&folder, arguments);
            let error = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name} {arguments:?}: {error}");
            assert!(error.contains("E0601") && error.contains(&format!("`{name}` cannot be")), "{error}");
        }
    }
    assert!(!folder.join("robot/src/alphabet.rs").exists());
}

#[test]
fn a_signature_of_any_width_is_listed() {
    let folder = executable::folder("strange_signature");
    fs::create_dir_all(folder.join("robot")).unwrap();
    let name = "f".repeat(100_000);
    let text = format!("target t : crate t;\n/// Long.\ncontrol {name};\n/// Short.\ncontrol g;\n");
    fs::write(folder.join("robot/alphabet.mdle"), text).unwrap();
    let output = run_mdlec(&folder, &["quarks", "--target", "robot"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("  g  Short.\n") && text.contains("f  Long.\n"));
}
