//! Tests `mdlec` when it is stopped by a signal, a closed pipe or a full disk, through the real binary. No partial file
//! is left, and the next build works.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::{self, JoinHandle};

use mdle_tests::executable::{cache, command, folder, mdlec, run_mdlec, without_waiting};

const PLAN: &str = "plan.mdle";

/// A script in place of cargo, which reports that it is at work, starts a child process, and never ends by itself.
const CARGO: &str = "#!/bin/sh\nexec 3> \"$AT_WORK\"\necho at work >&3\nsleep 900 &\nwait\necho survived >&3\n";

fn with_plan(test: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join(PLAN), "{ Rest (Atom (wait 1ms) stop) }\n").unwrap();
    folder
}

fn listing(folder: &Path) -> Vec<OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    names
}

/// Returns the exit status and standard error, without the messages that name builds of other tests.
fn report(output: &Output) -> (Option<i32>, String) {
    let message = String::from_utf8(output.stderr.clone()).expect("UTF-8");
    assert!(!message.contains("panicked"), "{message}");
    (output.status.code(), without_waiting(&message))
}

fn assert_builds(folder: &Path) {
    let output = run_mdlec(folder, &[PLAN, "--target", "sim", "-o", "afterwards"]);
    assert_eq!(output.status.code(), Some(0), "{}", report(&output).1);
    let run = Command::new(folder.join("afterwards")).args(["--speed", "max"]).output().unwrap();
    assert_eq!(run.stdout, b"0.1 s  plan over: wait 1ms (plan.mdle:1)\n");
}

/// Starts `mdlec` in `folder`, and waits until [`CARGO`] is at work. Returns the process, the pipe to which `CARGO`
/// reports, and a thread that returns standard error of `mdlec` after its end.
fn with_cargo_at_work(folder: &Path) -> (Child, BufReader<File>, JoinHandle<String>) {
    let tools = folder.join("tools");
    fs::create_dir(&tools).unwrap();
    fs::write(tools.join("cargo"), CARGO).unwrap();
    fs::set_permissions(tools.join("cargo"), fs::Permissions::from_mode(0o755)).unwrap();
    let at_work = folder.join("at_work");
    assert!(Command::new("mkfifo").arg(&at_work).status().unwrap().success());

    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths(std::iter::once(tools).chain(std::env::split_paths(&path))).unwrap();
    let mut command = command(folder, &[PLAN, "--target", "sim"]);
    command.env("PATH", path).env("AT_WORK", &at_work).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let stderr = child.stderr.take().unwrap();
    let pipe = at_work.clone();
    let message = thread::spawn(move || {
        let message = io::read_to_string(stderr).unwrap();
        // If mdlec ended before its cargo started, this ends the test's wait for cargo.
        File::options().read(true).write(true).open(pipe).unwrap();
        message
    });
    let mut heard = BufReader::new(File::open(at_work).unwrap());
    let mut line = String::new();
    heard.read_line(&mut line).unwrap();
    assert_eq!(line, "at work\n");
    (child, heard, message)
}

fn assert_signal_ends_all(signal: &str, status: i32) {
    let folder = with_plan(&format!("signal_{signal}"));
    let (mut child, heard, message) = with_cargo_at_work(&folder);
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let ended = child.wait().unwrap();
    assert_eq!((ended.code(), without_waiting(&message.join().unwrap())), (Some(status), String::new()), "{signal}");
    // The pipe ends when no process can write to it any more: neither cargo nor its child is left.
    assert_eq!(io::read_to_string(heard).unwrap(), "", "{signal}");
    assert_eq!(listing(&folder), ["at_work", PLAN, "tools"], "{signal}");
    assert_builds(&folder);
}

#[test]
fn a_killed_mdlec_takes_its_cargo_with_it() {
    let folder = with_plan("killed");
    let (mut child, heard, message) = with_cargo_at_work(&folder);
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().signal(), Some(9));
    // The pipe ends when no process can write to it any more: neither cargo nor its child is left.
    assert_eq!(io::read_to_string(heard).unwrap(), "");
    assert_eq!(without_waiting(&message.join().unwrap()), "");
    assert_builds(&folder);
}

#[test]
fn a_signal_ends_mdlec_and_its_cargo() {
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        assert_signal_ends_all(signal, status);
    }
}

/// Runs `mdlec` with a limit on the size of files, in blocks. Returns the exit status and standard error.
fn limited(folder: &Path, blocks: usize, arguments: &[&str], cache: &Path) -> (Option<i32>, String) {
    let script = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script]).arg(mdlec()).args(arguments).current_dir(folder).env("MDLEC_CACHE", cache);
    report(&command.output().unwrap())
}

fn no_room(path: &str) -> (Option<i32>, String) {
    let why = "(a full disk, a quota, or `ulimit -f`): make room, then try again";
    (Some(2), format!("error: there is no room left at `{path}` {why}\n"))
}

#[test]
fn a_full_cache_fails_and_the_next_build_works() {
    let folder = with_plan("no_room_in_cache");
    assert_builds(&folder);
    // There is space for the sources of another plan and for the list of compiled files, but not for the compiled
    // files.
    fs::write(folder.join(PLAN), "{ Rest (Atom (wait 1ms) (go 1 0)) }\n").unwrap();
    let before = listing(&folder);
    let shared = cache().canonicalize().unwrap();
    assert_eq!(limited(&folder, 400, &[PLAN, "--target", "sim"], &shared), no_room(shared.to_str().unwrap()));
    assert_eq!(listing(&folder), before);
    let built = run_mdlec(&folder, &[PLAN, "--target", "sim", "-o", "afterwards"]);
    assert_eq!(built.status.code(), Some(0), "{}", report(&built).1);

    let (status, message) = limited(&folder, 0, &[PLAN, "--target", "sim"], &folder.join("cache"));
    assert_eq!(status, Some(2), "{message}");
    assert!(message.starts_with("error: there is no room left at `") && message.contains("/cache/src-"), "{message}");
}

#[test]
fn no_room_for_the_output_leaves_what_was_there() {
    let folder = with_plan("no_room_for_output");
    assert_builds(&folder);
    fs::write(folder.join("old"), "old").unwrap();
    let before = listing(&folder);
    for arguments in [&["--target", "sim", "-o", "old"][..], &["--target", "sim", "--emit", "rust=old"]] {
        let limit = if arguments.contains(&"-o") { 1000 } else { 0 };
        let arguments = [&[PLAN][..], arguments].concat();
        assert_eq!(limited(&folder, limit, &arguments, &cache()), no_room("old"), "{arguments:?}");
        assert_eq!((fs::read(folder.join("old")).unwrap().as_slice(), listing(&folder)), (&b"old"[..], before.clone()));
    }
}

#[test]
fn a_full_device_is_reported() {
    let folder = with_plan("full_device");
    fs::write(folder.join("script"), "{\"t\": 0}\n").unwrap();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    for arguments in
        [&["targets"][..], &["quarks"], &["--help"], &[PLAN, "--emit", "plan"], &["trace", PLAN, "--script", "script"]]
    {
        let output = command(&folder, arguments).stdout(full()).output().unwrap();
        let (status, message) = report(&output);
        assert_eq!(status, Some(2), "{arguments:?}: {message}");
        assert!(
            message.starts_with("error: standard output cannot be written (No space left"),
            "{arguments:?}: {message}"
        );
    }
    assert_eq!(report(&run_mdlec(&folder, &[PLAN, "--emit", "tree=/dev/full"])), no_room("/dev/full"));
    // The message cannot be printed, but the exit status is set.
    let output = command(&folder, &["check", "missing.mdle"]).stderr(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_reader_that_went_away_is_no_error() {
    let folder = with_plan("no_reader");
    fs::write(folder.join("script"), "{\"t\": 0}\n").unwrap();
    fs::write(folder.join("wrong.mdle"), "{ P (bumpr) (Atom (wait 1) stop) }\n").unwrap();
    for (status, arguments) in [
        (0, &["--help"][..]),
        (0, &["targets"]),
        (0, &["quarks"]),
        (0, &[PLAN, "--emit", "fsm"]),
        (0, &["trace", PLAN, "--script", "script"]),
        (1, &["check", "wrong.mdle"]),
        (2, &["--nonsense"]),
        (0, &[PLAN, "--target", "sim"]),
    ] {
        // The reading ends of these pipes are closed from the start.
        let gone = || std::io::pipe().unwrap().1;
        let ended = command(&folder, arguments).stdout(gone()).stderr(gone()).status().unwrap();
        assert_eq!(ended.code(), Some(status), "{arguments:?}");
    }
}
