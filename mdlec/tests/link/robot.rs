//! A third-party robot for tests of `link`, and the builds for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use mdlec::link::{BuildStep, Built, Cache, Entry, LinkError, Package, TargetCrate, build};

pub(crate) const PLAN: &str = include_str!("plan.rs");

pub(crate) const ROVER: &str = include_str!("rover.rs");

pub(crate) const MANIFEST: &str = concat!(
    r#"# Not of the workspace around the folder that tests write to.
[workspace]

[package]
name = "mdle-rover"
version = "0.1.0"
edition = "2024"

[dependencies]
mdle-runtime = ""#,
    env!("CARGO_PKG_VERSION"),
    r#""
mdle-host = ""#,
    env!("CARGO_PKG_VERSION"),
    r#""
"#
);

/// Returns the folder of cargo's build results in a cache.
pub(crate) fn target(cache: &Cache) -> PathBuf {
    cache.folder().join("target")
}

/// A third-party target crate in a folder of its own.
pub(crate) struct Robot {
    pub(crate) folder: PathBuf,
    /// The cache, which is kept between runs of the tests, so that only the first run compiles the runtime.
    pub(crate) cache: Cache,
    /// Lock on the cache, so that only one test at a time uses and damages it.
    _turn: MutexGuard<'static, ()>,
}

impl Robot {
    pub(crate) fn new(name: &str, manifest: &str, rust: &str) -> Self {
        let tests = Path::new(env!("CARGO_TARGET_TMPDIR")).join("link");
        let folder = tests.join(name);
        fs::create_dir_all(folder.join("rover/src")).unwrap();
        fs::write(folder.join("rover/Cargo.toml"), manifest).unwrap();
        fs::write(folder.join("rover/src/lib.rs"), rust).unwrap();
        static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
        // A failed test must not make the next test fail.
        let turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        let cache = Cache::at(&tests.join("cache")).unwrap();
        // The first build has to compile all libraries anyway, so it also tests the repair of a damaged cache.
        if !target(&cache).exists() {
            fs::write(target(&cache), "garbage").unwrap();
        }
        Self { folder, cache, _turn: turn }
    }

    /// Builds `rust` as if it had been emitted from `plan`. The executable is beside the plan.
    pub(crate) fn build(&self, plan: &str, rust: &str) -> Result<(Built, PathBuf), LinkError> {
        self.build_with(plan, rust, &mut |_| {})
    }

    /// Builds like [`Robot::build`], and reports the progress.
    pub(crate) fn build_with(
        &self,
        plan: &str,
        rust: &str,
        progress: &mut dyn FnMut(BuildStep),
    ) -> Result<(Built, PathBuf), LinkError> {
        let plan_file = self.folder.join(plan);
        fs::create_dir_all(plan_file.parent().unwrap()).unwrap();
        fs::write(&plan_file, "{ Nap (bumper) (Atom (null) stop) }").unwrap();
        let target = TargetCrate::Path { folder: &self.folder.join("rover"), crate_name: "mdle_rover" };
        let inputs = [plan_file.clone()];
        let package = Package {
            plan_name: "Nap",
            version: "",
            plan_file: &plan_file,
            entry: Entry::Plan("Nap"),
            inputs: &inputs,
            rust,
            target: &target,
            machine: None,
        };
        let output = plan_file.with_extension("");
        let built = build(&self.cache, &package, &output, progress)?;
        Ok((built, output))
    }
}
