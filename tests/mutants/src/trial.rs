//! A mutant before the tests: they run one after another, and the first that fails ends the trial.

use std::ffi::OsString;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::checkout::Checkout;
use crate::mutant::Mutant;

/// Packages that are built together, as what cargo builds of one depends on which others it is asked for.
pub(crate) type Packages = &'static [&'static str];
pub(crate) const RUNTIME: Packages = &["--package", "mdle-runtime"];
const COMPILER: Packages = &["--package", "mdle-compiler", "--package", "mdle-tests"];

/// The tests, as `cargo test` takes them: those first that catch much and are fast.
pub(crate) const TESTS: &[(Packages, &[&str])] = &[
    (RUNTIME, &["--lib"]),
    (COMPILER, &["--test", "machine", "--test", "emitted", "--", "golden::", "fsm_files::", "names::", "text::"]),
    (COMPILER, RULES),
    (COMPILER, &["--lib", "--", "fsm::", "plan::", "rust::"]),
    (COMPILER, &["--test", "machine", "--", "differential::"]),
    (COMPILER, &["--test", "compiled", "--", "machines::"]),
];

/// The tests of the rules of plans, each by its smallest plan.
const RULES: &[&str] = &[
    "--test",
    "language",
    "--",
    "turns::",
    "degeneracy::",
    "loops::",
    "memory::",
    "motion::",
    "notation::",
    "parameters::",
    "signals::",
];

/// Number of tests that take seconds. The others take minutes, and the last one has rustc compile a runtime.
pub(crate) const FAST: usize = 4;

/// The command line of a test.
pub(crate) fn name(test: usize) -> String {
    let (packages, targets) = TESTS[test];
    format!("cargo test {}", [packages, targets].concat().join(" "))
}

/// A test that takes longer than this and three times what it takes without a fault hangs.
const PATIENCE: Duration = Duration::from_secs(30);
/// A build that takes longer hangs.
const BUILD: Duration = Duration::from_secs(600);
/// Maximum memory of a process, in KiB: a fault may fill all there is.
const MEMORY: &str = "8388608";

/// Result of a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The mutant is not a valid program, so no test has to find it.
    DoesNotCompile,
    /// The test of this index failed.
    Caught(usize),
    /// The test of this index did not end.
    Hangs(usize),
    /// No test failed.
    Survived,
}

/// Runner of the trials.
#[derive(Debug)]
pub(crate) struct Trials {
    checkout: Checkout,
    /// Maximum duration of each test.
    limits: Vec<Duration>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ended {
    Well,
    Badly,
    NotAtAll,
}

impl Trials {
    /// Builds everything and runs every test without a fault.
    pub(crate) fn prepare(checkout: Checkout) -> Self {
        let mut trials = Self { checkout, limits: Vec::new() };
        for (number, (packages, targets)) in TESTS.iter().enumerate() {
            trials.cargo(&[&["test", "--no-run"], packages, targets], BUILD);
            let start = Instant::now();
            let ended = trials.cargo(&[&["test"], packages, targets], BUILD);
            let folder = trials.checkout.sources();
            assert_eq!(ended, Ended::Well, "without a fault, in {}: {}", folder.display(), name(number));
            trials.limits.push(PATIENCE + 3 * start.elapsed());
        }
        trials
    }

    /// Tries a mutant of the file with this text.
    pub(crate) fn run(&self, mutant: &Mutant, text: &str) -> Outcome {
        let changed = if mutant.file.starts_with("runtime/") { RUNTIME } else { COMPILER };
        self.checkout.write(&mutant.file, &mutant.apply(text));
        let is_built = self.cargo(&[&["build", "--lib"], changed], BUILD) == Ended::Well;
        let outcome = if is_built { self.tested(changed) } else { Outcome::DoesNotCompile };
        self.checkout.write(&mutant.file, text);
        outcome
    }

    /// Returns the result of the tests on the copy as it is, with a fault in one of these packages.
    fn tested(&self, changed: Packages) -> Outcome {
        for (number, ((packages, targets), limit)) in TESTS.iter().zip(&self.limits).enumerate() {
            if *packages == RUNTIME && changed != RUNTIME {
                continue;
            }
            // A test that cannot be built any more has noticed as well.
            let built = self.cargo(&[&["test", "--no-run"], packages, targets], BUILD);
            let ended = if built == Ended::Well { self.cargo(&[&["test"], packages, targets], *limit) } else { built };
            match ended {
                Ended::Well => {}
                Ended::Badly => return Outcome::Caught(number),
                Ended::NotAtAll => return Outcome::Hangs(number),
            }
        }
        Outcome::Survived
    }

    /// Runs cargo in the copy. What it starts dies with it when its time is up.
    fn cargo(&self, arguments: &[&[&str]], limit: Duration) -> Ended {
        let mut command = Command::new("sh");
        environment(&mut command, &self.checkout);
        let status = command
            .args(["-c", "ulimit -v $0 && exec timeout --signal=KILL \"$@\"", MEMORY])
            .arg(limit.as_secs().to_string())
            .arg(cargo())
            .args(arguments.concat())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .expect("a shell");
        match status.code() {
            Some(0) => Ended::Well,
            // 128 and the number of the signal: `timeout` dies of what it sends.
            Some(137) | None => Ended::NotAtAll,
            Some(_) => Ended::Badly,
        }
    }
}

/// The cargo that runs this.
pub(crate) fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Sets the folder and environment variables of a command in the copy.
pub(crate) fn environment(command: &mut Command, checkout: &Checkout) {
    command
        .current_dir(checkout.sources())
        .env("CARGO_TARGET_DIR", checkout.target())
        .env("CARGO_INCREMENTAL", "1")
        // Nobody debugs what is built here, and without its tables that is faster.
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
        // Nobody reads where a test panicked, and to find that out takes longer than most tests.
        .env("RUST_BACKTRACE", "0")
        .env("INSTA_UPDATE", "no")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true")
        .env("PROPTEST_RNG_SEED", "0");
}
