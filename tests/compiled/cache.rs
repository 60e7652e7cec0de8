//! Tests `mdlec` and its cache folder, through the real binary: several processes at once, a cache that is damaged or
//! cannot be used, and builds without a network.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use mdle_tests::executable::{cache, command, folder, run_mdlec, without_waiting};

const BUILD: [&str; 3] = ["plan.mdle", "--target", "sim"];

/// An address without a server.
const NOWHERE: &str = "http://127.0.0.1:1";

/// Returns a plan that is over after `seconds` seconds.
fn plan(seconds: usize) -> String {
    format!("{{ Rest (Atom (wait {seconds}) stop) }}\n")
}

fn with_plan(test: &str, seconds: usize) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), plan(seconds)).unwrap();
    folder
}

fn assert_built(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Runs the executable in `folder`, and asserts that its plan rests for `seconds` seconds.
fn assert_rests(folder: &Path, seconds: usize) {
    let run = Command::new(folder.join("plan")).args(["--speed", "max"]).output().unwrap();
    assert_eq!(
        String::from_utf8(run.stdout).unwrap(),
        format!("{seconds}.0 s  plan over: wait {seconds} (plan.mdle:1)\n")
    );
}

/// Returns the message of a build that must fail.
fn refused(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(!message.contains("panicked"), "{message}");
    without_waiting(&message)
}

#[test]
fn plans_of_one_name_at_once_each_get_their_own_executable() {
    let left = with_plan("at_once/left", 0);
    let right = with_plan("at_once/right", 0);
    for round in 1..4 {
        for (folder, seconds) in [(&left, round), (&right, 10 + round)] {
            fs::write(folder.join("plan.mdle"), plan(seconds)).unwrap();
        }
        let folders = [&left, &right, &left, &right, &left];
        let start = |folder: &&PathBuf| command(folder, &BUILD).stderr(Stdio::piped()).spawn().unwrap();
        let children: Vec<_> = folders.iter().map(start).collect();
        children.into_iter().for_each(|child| assert_built(&child.wait_with_output().unwrap()));
        assert_rests(&left, round);
        assert_rests(&right, 10 + round);
    }
    for folder in [left, right] {
        assert_eq!(fs::read_dir(folder).unwrap().count(), 2, "the plan and its executable");
    }
}

#[test]
fn clean_removes_a_cache_and_nothing_else() {
    let folder = folder("clean");
    let cache = folder.join("cache");
    fs::create_dir_all(cache.join("target/release")).unwrap();
    fs::write(cache.join("target/release/plan"), [1; 1_000_000]).unwrap();
    fs::write(cache.join("lock"), "").unwrap();
    let clean = || command(&folder, &["clean"]).env("MDLEC_CACHE", "cache").output().unwrap();
    fs::write(cache.join("notes.txt"), "mine").unwrap();
    let refused = clean();
    let message = "error: `cache` is not a cache of mdlec: it contains `notes.txt`, which mdlec did not write; nothing was removed\n";
    assert_eq!((refused.status.code(), String::from_utf8(refused.stderr).unwrap().as_str()), (Some(2), message));
    assert!(cache.join("target/release/plan").exists());
    fs::remove_file(cache.join("notes.txt")).unwrap();
    for message in ["cache: 1.0 MB freed\n", "cache: 0.0 MB freed\n"] {
        let output = clean();
        assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), message));
    }
    assert_eq!(fs::read_dir(cache).unwrap().count(), 1, "the lock");
}

#[test]
fn damage_is_mended_before_it_is_handed_out() {
    let folder = with_plan("damaged", 3);
    assert_built(&run_mdlec(&folder, &BUILD));
    {
        // The lock is held as by a running mdlec, so that other tests do not see the damage.
        let lock = File::options().append(true).open(cache().join("lock")).unwrap();
        lock.lock().unwrap();
        let (executables, sources) = (stored(&cache(), "plan-plan-"), stored(&cache(), "alphabet.rs"));
        assert!(!executables.is_empty() && !sources.is_empty());
        for executable in executables {
            fs::write(executable, "garbage").unwrap();
        }
        for source in sources {
            let length = fs::metadata(&source).unwrap().len();
            fs::write(source, "?".repeat(length.try_into().unwrap())).unwrap();
        }
        fs::write(cache().join("lock"), "4711").unwrap();
    }
    assert_built(&run_mdlec(&folder, &BUILD));
    assert_rests(&folder, 3);
}

/// Returns the files below `folder`, executables and sources, whose names begin with `start`.
fn stored(folder: &Path, start: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            if !["plans", ".fingerprint", "incremental", "build"].contains(&name) {
                found.extend(stored(&path, start));
            }
        } else if name.starts_with(start) && !name.ends_with(".d") {
            found.push(path);
        }
    }
    found
}

#[test]
fn an_unusable_cache_folder_is_an_error() {
    let folder = with_plan("no_cache", 1);
    // A superuser is not bound by permissions; these places cannot be used by anybody.
    for place in ["plan.mdle", "plan.mdle/cache", "/proc/mdlec"] {
        let message = refused(command(&folder, &BUILD).env("MDLEC_CACHE", place));
        assert!(message.starts_with(&format!("error: the cache cannot be used at `{place}` (")), "{message}");
        let advice = "): make it writable or delete it, or name another folder with the variable MDLEC_CACHE\n";
        assert!(message.ends_with(advice), "{message}");
    }
    fs::create_dir_all(folder.join("cache/lock")).unwrap();
    let message = refused(command(&folder, &BUILD).env("MDLEC_CACHE", "cache"));
    assert!(message.contains("/cache/lock` (") && message.contains("delete it"), "{message}");
}

#[test]
fn a_cache_that_others_can_change_is_refused() {
    let folder = with_plan("open_cache", 1);
    let open = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    open(&folder, 0o777);
    let message = refused(command(&folder, &BUILD).env("MDLEC_CACHE", "cache"));
    let place = folder.display();
    let start =
        format!("error: the cache is not safe: others can write to `{place}`, and could put code into executables");
    assert!(
        message.starts_with(&start) && message.ends_with("or name another folder with the variable MDLEC_CACHE\n"),
        "{message}"
    );
    open(&folder, 0o755);
    // mdlec makes the cache folder private, and removes what other users may have put there.
    for folder in [folder.join("cache/target"), folder.join("cache/plans")] {
        fs::create_dir_all(folder.join("strange")).unwrap();
    }
    open(&folder.join("cache"), 0o777);
    let nowhere = folder.join("no_tools");
    refused(command(&folder, &BUILD).env("MDLEC_CACHE", "cache").env("PATH", nowhere));
    let mode = |path: PathBuf| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(folder.join("cache")), mode(folder.join("cache/lock"))), (0o700, 0o600));
    assert!(!folder.join("cache/target").exists() && !folder.join("cache/plans").exists());
}

#[test]
fn a_waiting_build_names_the_other() {
    let folder = with_plan("waits", 5);
    // The message may be about the build of another test, which itself waits for this lock: in this case, releases the
    // lock and tries again.
    let heard = |lock: &Path, sentence: &str| loop {
        let file = File::options().create(true).append(true).open(lock).unwrap();
        file.lock().unwrap();
        let mut child = command(&folder, &BUILD).stderr(Stdio::piped()).spawn().unwrap();
        let mut message = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        let line = message.find(|line| line.starts_with("waiting for another ")).expect(sentence);
        drop(file);
        message.for_each(drop);
        assert_eq!(child.wait().unwrap().code(), Some(0));
        if line.starts_with(sentence) {
            break;
        }
    };
    assert_built(&run_mdlec(&folder, &BUILD));
    heard(&cache().join("lock"), "waiting for another mdlec to finish its build (process ");
    let locks = stored(&cache(), ".cargo-lock");
    let of_builds = locks.iter().find(|lock| lock.ends_with("target/release/.cargo-lock")).unwrap();
    heard(of_builds, "waiting for another cargo to finish, which uses the same libraries");
}

#[test]
fn without_rust_it_says_what_to_install() {
    let folder = with_plan("no_rust", 1);
    let message = refused(command(&folder, &BUILD).env("PATH", &folder));
    let advice = "install Rust from rustup.rs\n";
    assert_eq!(
        message,
        format!("error: mdlec needs `rustc` to build an executable, and it is not installed: {advice}")
    );
}

#[test]
fn without_a_c_compiler_it_says_what_to_install() {
    let folder = with_plan("no_linker", 1);
    let tools = folder.join("tools");
    fs::create_dir(&tools).unwrap();
    let path = std::env::var_os("PATH").unwrap();
    for tool in ["cargo", "rustc", "rustup", "sh"] {
        let mut places = std::env::split_paths(&path).map(|place| place.join(tool));
        if let Some(place) = places.find(|place| place.exists()) {
            symlink(place, tools.join(tool)).unwrap();
        }
    }
    // The second build uses the libraries that the first build compiled before it failed.
    for _ in 0..2 {
        let message = refused(command(&folder, &BUILD).env("MDLEC_CACHE", "cache").env("PATH", &tools));
        assert!(
            message.contains("error: the linker cannot make a static executable: install the C compiler"),
            "{message}"
        );
        assert!(!message.contains("damaged"), "{message}");
    }
}

#[test]
fn no_network_is_needed_when_all_was_fetched() {
    let folder = with_plan("no_network", 4);
    let output = command(&folder, &BUILD).env("CARGO_HTTP_PROXY", NOWHERE).output().unwrap();
    assert_built(&output);
    assert!(!String::from_utf8(output.stderr).unwrap().contains("fetching"));
    assert_rests(&folder, 4);
}

#[test]
fn missing_libraries_are_an_error() {
    let folder = with_plan("not_fetched", 1);
    let nothing = |name: &str, value: &str| {
        let mut command = command(&folder, &BUILD);
        command.env("MDLEC_CACHE", "cache").env("CARGO_HOME", folder.join("cargo"));
        // Without this setting, cargo would retry and wait.
        refused(command.env("CARGO_NET_RETRY", "1").env(name, value))
    };
    let missing = "error: the libraries that executables are built on are not on this machine yet, and ";
    let message = nothing("CARGO_HTTP_PROXY", NOWHERE);
    assert!(message.contains(&format!("{missing}they cannot be fetched: connect it to the network once")), "{message}");
    let message = nothing("CARGO_NET_OFFLINE", "true");
    assert!(
        message.contains(&format!("{missing}cargo is configured not to fetch them: unset CARGO_NET_OFFLINE")),
        "{message}"
    );
}
