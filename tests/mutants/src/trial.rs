//! Tries a mutant with the tests, one after another, until a test fails.

use std::ffi::OsString;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::checkout::Checkout;
use crate::mutant::Mutant;

/// Packages that are built together, because cargo's build of a package depends on the other packages of the command.
pub(crate) type Packages = &'static [&'static str];
pub(crate) const RUNTIME: Packages = &["--package", "mdle-runtime"];
const COMPILER: Packages = &["--package", "mdle-compiler", "--package", "mdle-tests"];

/// Arguments of `cargo test` for each test. Tests that are fast and catch many mutants come first.
pub(crate) const TESTS: &[(Packages, &[&str])] = &[
    (RUNTIME, &["--lib"]),
    (COMPILER, &["--test", "machine", "--test", "emitted", "--", "golden::", "fsm_files::", "names::", "text::"]),
    (COMPILER, RULES),
    (COMPILER, &["--lib", "--", "fsm::", "plan::", "rust::"]),
    (COMPILER, &["--test", "machine", "--", "differential::"]),
    (COMPILER, &["--test", "compiled", "--", "machines::"]),
];

/// Arguments for the tests of single rules of plans.
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

/// Number of tests that take seconds. The other tests take minutes; in the last one, rustc compiles a runtime.
pub(crate) const FAST: usize = 4;

/// Returns the command line of a test.
pub(crate) fn name(test: usize) -> String {
    let (packages, targets) = TESTS[test];
    format!("cargo test {}", [packages, targets].concat().join(" "))
}

/// Time that a test may take beyond three times its duration without a fault; a test that takes longer counts as
/// hanging.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time after which a build counts as hanging.
const BUILD: Duration = Duration::from_secs(600);
/// Maximum memory of a process, in KiB. Without a limit, a fault could use all memory.
const MEMORY: &str = "8388608";

/// Result of trying a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The mutant is not a valid program, so no test has to find it.
    DoesNotCompile,
    /// The test with this index failed.
    Caught(usize),
    /// The test with this index did not end.
    Hangs(usize),
    /// No test failed.
    Survived,
}

/// Runner that tries mutants one by one.
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

    /// Tries a mutant of the file whose original text is `text`.
    pub(crate) fn run(&self, mutant: &Mutant, text: &str) -> Outcome {
        let changed = if mutant.file.starts_with("runtime/") { RUNTIME } else { COMPILER };
        self.checkout.write(&mutant.file, &mutant.apply(text));
        let is_built = self.cargo(&[&["build", "--lib"], changed], BUILD) == Ended::Well;
        let outcome = if is_built { self.tested(changed) } else { Outcome::DoesNotCompile };
        self.checkout.write(&mutant.file, text);
        outcome
    }

    /// Runs the tests on the current state of the copy, which has a fault in one of the packages `changed`, and returns
    /// the result.
    fn tested(&self, changed: Packages) -> Outcome {
        for (number, ((packages, targets), limit)) in TESTS.iter().zip(&self.limits).enumerate() {
            if *packages == RUNTIME && changed != RUNTIME {
                continue;
            }
            // A test that cannot be built any more has caught the fault as well.
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

    /// Runs cargo in the copy, and kills it after the time `limit`.
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
            // 128 + 9: `timeout` killed cargo, or died of the signal that it sends.
            Some(137) | None => Ended::NotAtAll,
            Some(_) => Ended::Badly,
        }
    }
}

/// Returns the path of the cargo that runs this program.
pub(crate) fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// Sets the folder and environment variables of a command in the copy.
pub(crate) fn environment(command: &mut Command, checkout: &Checkout) {
    command
        .current_dir(checkout.sources())
        .env("CARGO_TARGET_DIR", checkout.target())
        .env("CARGO_INCREMENTAL", "1")
        // Debug information is not needed, and builds are faster without it.
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
        // Backtraces are not needed, and producing one takes longer than most tests.
        .env("RUST_BACKTRACE", "0")
        // A mutant that few random plans find is caught all the same.
        .env("MDLE_LONG", "1")
        .env("INSTA_UPDATE", "no")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true")
        .env("PROPTEST_RNG_SEED", "0");
}
