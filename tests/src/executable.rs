//! The real `mdlec`, built from this checkout, and the executables that it builds.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use crate::repository::root;

/// The binary `mdlec`, as it is now: a test may be run before anything has built it.
#[must_use]
pub fn mdlec() -> &'static Path {
    static MDLEC: OnceLock<PathBuf> = OnceLock::new();
    MDLEC.get_or_init(|| {
        // target/PROFILE/deps/this-test: the folder of the build that this test belongs to.
        let this = std::env::current_exe().expect("a test has a path");
        let target = this.ancestors().nth(3).expect("a target folder");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let built = Command::new(cargo)
            .args(["build", "--quiet", "--package", "mdlec", "--bin", "mdlec", "--target-dir"])
            .arg(target)
            .current_dir(root())
            .status()
            .expect("cargo runs");
        assert!(built.success(), "mdlec does not build");
        target.join("debug/mdlec")
    })
}

/// A folder of its own for a test, empty.
#[must_use]
pub fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/tmp/end_to_end").join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.canonicalize().expect("a folder")
}

/// `mdlec` with these arguments in `folder`; its cache outlives the tests, so that only the first compiles the runtime.
#[must_use]
pub fn run_mdlec(folder: &Path, arguments: &[&str]) -> Output {
    let cache = root().join("target/tmp/mdlec-cache");
    let mut command = Command::new(mdlec());
    command.args(arguments).current_dir(folder).env("MDLEC_CACHE", cache);
    command.output().expect("mdlec runs")
}
