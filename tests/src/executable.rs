//! The real `mdlec`, built from this checkout, and the executables that it builds.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use crate::repository::root;

/// The binary `mdlec`, as it is now: a test may be run before anything has built it.
#[must_use]
pub fn mdlec() -> &'static Path {
    static MDLEC: OnceLock<PathBuf> = OnceLock::new();
    MDLEC.get_or_init(|| {
        let target = target();
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let built = Command::new(cargo)
            .args(["build", "--quiet", "--package", "mdlec", "--bin", "mdlec", "--target-dir"])
            .arg(&target)
            .current_dir(root())
            .status()
            .expect("cargo runs");
        assert!(built.success(), "mdlec does not build");
        target.join("debug/mdlec")
    })
}

/// The target folder of the build that this test belongs to, wherever `CARGO_TARGET_DIR` put it.
#[must_use]
pub fn target() -> PathBuf {
    // TARGET/PROFILE/deps/this-test
    let this = std::env::current_exe().expect("a test has a path");
    this.ancestors().nth(3).expect("a target folder").to_owned()
}

/// A folder of its own for a test, empty.
#[must_use]
pub fn folder(test: &str) -> PathBuf {
    let folder = target().join("tmp/end_to_end").join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.canonicalize().expect("a folder")
}

/// `mdlec` with these arguments in `folder`; its cache outlives the tests, so that only the first compiles the runtime.
#[must_use]
pub fn run_mdlec(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("mdlec runs")
}

/// As [`run_mdlec`], with this text on standard input.
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

/// The messages, without those about builds of other tests, which share the cache.
#[must_use]
pub fn without_waiting(said: &str) -> String {
    let is_waiting = |line: &&str| line.starts_with("waiting for another ");
    said.lines().filter(|line| !is_waiting(line)).fold(String::new(), |text, line| text + line + "\n")
}

/// The cache that the tests share.
#[must_use]
pub fn cache() -> PathBuf {
    target().join("tmp/mdlec-cache")
}
