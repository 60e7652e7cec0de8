//! The real `mdlec`, built from this checkout, and the executables that it builds.

use std::ffi::OsStr;
use std::io::Write;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use crate::repository::root;

/// The binary `mdlec`, as it is now: a test may be run before anything has built it.
#[must_use]
pub fn mdlec() -> &'static Path {
    static MDLEC: OnceLock<PathBuf> = OnceLock::new();
    MDLEC.get_or_init(|| built("mdlec"))
}

/// The binary `mdle`, as it is now.
#[must_use]
pub fn mdle() -> &'static Path {
    static MDLE: OnceLock<PathBuf> = OnceLock::new();
    MDLE.get_or_init(|| built("mdle"))
}

/// Builds this binary.
///
/// Cargo chooses the features of all libraries for the whole workspace and its tests, as in `cargo test --workspace`,
/// because the command names the workspace and a test: what that command has compiled is not compiled again.
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

/// A test that cargo has built soon: that of `runtime/core`.
const SMALL_TEST: &str = "alphabet";

/// The target folder of the build that this test belongs to, wherever `CARGO_TARGET_DIR` put it.
#[must_use]
pub fn target() -> PathBuf {
    // TARGET/PROFILE/deps/this-test
    let this = std::env::current_exe().expect("a test has a path");
    this.ancestors().nth(3).expect("a target folder").to_owned()
}

/// Returns an empty folder for a test. Tests in the same file have to name theirs differently; those of other files may
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

/// Runs `mdlec` with these arguments in `folder`, and returns its output without the messages about builds of other
/// tests. Its cache outlives the tests, so that only the first compiles the runtime.
#[must_use]
pub fn run_mdlec(folder: &Path, arguments: &[&str]) -> Output {
    let mut output = command(folder, arguments).output().expect("mdlec runs");
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
    // Small enough for a pipe to hold, whether it is read or not. Dropped at once: that is the end of the input.
    let written = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    let output = child.wait_with_output().expect("mdlec runs");
    written.expect("mdlec reads its input");
    output
}

/// `mdlec` with these arguments in `folder`, to be run as a test likes.
#[must_use]
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(mdlec());
    command.args(arguments).current_dir(folder).env("MDLEC_CACHE", cache());
    command
}

/// Start of the messages about builds of other tests, which share the cache.
const WAITING: &str = "waiting for another ";

/// The messages, without those about builds of other tests.
#[must_use]
pub fn without_waiting(message: &str) -> String {
    message.lines().filter(|line| !line.starts_with(WAITING)).fold(String::new(), |text, line| text + line + "\n")
}

/// The cache that the tests share.
#[must_use]
pub fn cache() -> PathBuf {
    target().join("tmp/mdlec-cache")
}
