//! Builds the real `mdlec` from this checkout, and runs it and the executables that it builds.

use std::ffi::OsStr;
use std::io::Write;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use crate::repository::root;

/// Returns the path of the binary `mdlec`. It is built first, because a test may run before anything else has built it.
#[must_use]
pub fn mdlec() -> &'static Path {
    static MDLEC: OnceLock<PathBuf> = OnceLock::new();
    MDLEC.get_or_init(|| built("mdlec"))
}

/// Returns the path of the binary `mdle`, which is built first.
#[must_use]
pub fn mdle() -> &'static Path {
    static MDLE: OnceLock<PathBuf> = OnceLock::new();
    MDLE.get_or_init(|| built("mdle"))
}

/// Builds a binary, and returns its path.
///
/// The command names the workspace and a test, so that cargo selects the same features for all libraries as in
/// `cargo test --workspace` and compiles nothing twice. This test uses proptest: cargo compiles a library of a build
/// script with other options if no library for the target uses it too, and proptest uses `regex-syntax`, on which the
/// build script of the compiler depends.
fn built(binary: &str) -> PathBuf {
    let target = target();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--workspace", "--test", SMALL_TEST, "--bin", binary, "--target-dir"])
        .arg(&target)
        .current_dir(root())
        .status()
        .expect("cargo runs");
    assert!(built.success(), "{binary} does not build");
    target.join("debug").join(binary)
}

/// Name of a test that cargo builds quickly and that uses proptest, in the emulators.
const SMALL_TEST: &str = "any_bytes";

/// Returns the target folder of the build to which this test belongs, even if `CARGO_TARGET_DIR` is set.
#[must_use]
pub fn target() -> PathBuf {
    // TARGET/PROFILE/deps/this-test
    let this = std::env::current_exe().expect("a test has a path");
    this.ancestors().nth(3).expect("a target folder").to_owned()
}

/// Returns an empty folder for a test. Tests in the same file must use different names; tests in different files may
/// use the same name.
#[must_use]
#[track_caller]
pub fn folder(test: &str) -> PathBuf {
    // tests/PROGRAM/FILE.rs
    let source = Path::new(Location::caller().file()).with_extension("");
    let mut names: Vec<_> = source.iter().rev().take(2).filter_map(OsStr::to_str).collect();
    names.reverse();
    let folder = target().join("tmp/end_to_end").join(names.join("-")).join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.canonicalize().expect("a folder")
}

/// Runs `mdlec` with these arguments in `folder`. Returns its output without the messages that name builds of other
/// tests. The cache is kept between test runs, so that only the first build compiles the runtime.
#[must_use]
pub fn run_mdlec(folder: &Path, arguments: &[&str]) -> Output {
    run(command(folder, arguments))
}

/// Runs `mdlec` as [`run_mdlec`] does, with the lowest priority, for tests in which robots are driven by the clock
/// while others are built: a driver that gets no processor for some tenths of a second reports a fault.
#[must_use]
pub fn run_mdlec_aside(folder: &Path, arguments: &[&str]) -> Output {
    let plain = command(folder, arguments);
    let mut command = Command::new("nice");
    command.args(["-n", "19"]).arg(plain.get_program()).args(plain.get_args()).current_dir(folder);
    command.envs(plain.get_envs().filter_map(|(name, value)| Some((name, value?))));
    run(command)
}

fn run(mut command: Command) -> Output {
    let mut output = command.output().expect("mdlec runs");
    let lines = output.stderr.split_inclusive(|byte| *byte == b'\n');
    output.stderr = lines.filter(|line| !line.starts_with(WAITING.as_bytes())).collect::<Vec<_>>().concat();
    output
}

/// Runs mdlec like [`run_mdlec`], with this text on standard input.
#[must_use]
pub fn run_mdlec_reading(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut command = command(folder, arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("mdlec runs");
    // The input fits into the pipe's buffer, so that writing never blocks. Dropping the pipe at once ends the input.
    let written = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    let output = child.wait_with_output().expect("mdlec runs");
    written.expect("mdlec reads its input");
    output
}

/// Returns a command that runs `mdlec` with these arguments in `folder`.
#[must_use]
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(mdlec());
    command.args(arguments).current_dir(folder).env("MDLEC_CACHE", cache());
    command
}

/// Start of the message that is printed while another test, which shares the cache, builds.
const WAITING: &str = "waiting for another ";

/// Returns the messages without those that name builds of other tests.
#[must_use]
pub fn without_waiting(message: &str) -> String {
    message.lines().filter(|line| !line.starts_with(WAITING)).fold(String::new(), |text, line| text + line + "\n")
}

/// Returns the folder of the cache that the tests share.
#[must_use]
pub fn cache() -> PathBuf {
    target().join("tmp/mdlec-cache")
}
