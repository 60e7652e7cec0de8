//! Builds all mutants together before the tests run, so that each trial only starts an existing executable.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use crate::checkout::Checkout;
use crate::choice::Source;
use crate::mutant::Mutant;
use crate::refusals::{Executable, Refusal, executables, refusals};
use crate::schemata::{Body, Schema, VARIABLE};
use crate::trial::{FAST, Outcome, RUNTIME, TESTS, cargo, environment};

/// Processor time that a test may take beyond three times its duration without a fault; a test that takes longer counts
/// as hanging. Processor time is limited, and not wall-clock time, because other programs may run at the same time.
const PATIENCE: Duration = Duration::from_secs(5);
/// Wall-clock time after which a test counts as hanging.
const ENDLESS: Duration = Duration::from_secs(1800);
/// Maximum memory of a process, in KiB.
const MEMORY: &str = "6291456";
const KILLED: i32 = 9;
const OUT_OF_TIME: i32 = 24;

/// All mutants, which have been built together.
#[derive(Debug)]
pub(crate) struct AtOnce<'m> {
    checkout: Checkout,
    mutants: Vec<(BuildState, &'m Mutant)>,
    tests: Vec<Test>,
}

/// State of a mutant after the common build.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BuildState {
    Built,
    DoesNotCompile,
    /// A mutant that cannot be selected at run time.
    Apart,
}

/// A test executable, with the index of its test in the list of tests and its maximum processor time.
#[derive(Debug)]
struct Test {
    number: usize,
    executable: Executable,
    /// Names, or parts of names, of the tests to run; empty to run all tests.
    filters: &'static [&'static str],
    limit: Duration,
}

impl<'m> AtOnce<'m> {
    /// Builds the mutants of these files, and runs every test without a fault.
    pub(crate) fn prepare(checkout: Checkout, sources: &[Source], mutants: &[&'m Mutant]) -> Self {
        let mutants = mutants.iter().map(|mutant| (BuildState::Built, *mutant)).collect();
        let mut this = Self { checkout, mutants, tests: Vec::new() };
        for source in sources {
            this.refuse_what_is_no_syntax(source);
        }
        while !this.is_built(sources) {}
        for (number, (packages, targets)) in TESTS.iter().enumerate().take(FAST) {
            let mut parts = targets.split(|argument| *argument == "--");
            let (targets, filters) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
            let (is_built, printed) = this.cargo(&[&["test", "--no-run", "--message-format=json"], packages, targets]);
            assert!(is_built, "{:?}", refusals(&printed));
            for executable in executables(&printed) {
                let test = Test { number, executable, filters, limit: ENDLESS };
                let start = Instant::now();
                let status = this.executed(&test, 0);
                assert!(status.success(), "without a fault, {}: {status}", test.executable.path.display());
                this.tests.push(Test { limit: PATIENCE + 3 * start.elapsed(), ..test });
            }
        }
        this
    }

    /// Returns each mutant with its index and its state, in the given order.
    pub(crate) fn mutants(&self) -> impl Iterator<Item = (usize, BuildState, &'m Mutant)> {
        self.mutants.iter().enumerate().map(|(place, (standing, mutant))| (place, *standing, *mutant))
    }

    /// Runs the tests on the mutant with this index, which must be built.
    pub(crate) fn run(&self, place: usize) -> Outcome {
        let (_, mutant) = self.mutants[place];
        let is_runtime = mutant.file.starts_with("runtime/");
        for test in self.tests.iter().filter(|test| is_runtime || TESTS[test.number].0 != RUNTIME) {
            let status = self.executed(test, number(place));
            match (status.code(), status.signal()) {
                (Some(0), _) => {}
                // A limit ended the test: `timeout` exits with 137 or dies of the SIGKILL that it sends; the limit on
                // processor time sends SIGXCPU.
                (Some(137), _) | (_, Some(KILLED | OUT_OF_TIME)) => return Outcome::Hangs(test.number),
                _ => return Outcome::Caught(test.number),
            }
        }
        Outcome::Survived
    }

    /// Restores the original files of the copy, and returns the copy.
    pub(crate) fn restored(self, sources: &[Source]) -> Checkout {
        sources.iter().for_each(|source| self.checkout.write(&source.file, &source.text));
        self.checkout
    }

    /// Marks the mutants with invalid syntax, because each of them would make the whole file invalid.
    fn refuse_what_is_no_syntax(&mut self, source: &Source) {
        for (standing, mutant) in self.mutants.iter_mut().filter(|(_, mutant)| mutant.file == source.file) {
            if syn::parse_file(&mutant.apply(&source.text)).is_err() {
                *standing = BuildState::DoesNotCompile;
            }
        }
    }

    /// Returns `true` if rustc accepts the files with all remaining mutants. If not, excludes the mutants that rustc
    /// rejects from the next build.
    fn is_built(&mut self, sources: &[Source]) -> bool {
        let schemata: BTreeMap<_, _> =
            sources.iter().map(|source| (source.file.clone(), self.schema(source))).collect();
        let left = self.mutants.iter().filter(|(standing, _)| *standing == BuildState::Built).count();
        println!("building {left} mutants");
        let packages = ["--package", "mdle-runtime", "--package", "mdle-compiler"];
        let (is_built, printed) = self.cargo(&[&["check", "--message-format=json"], &packages]);
        if is_built {
            return true;
        }
        for refusal in refusals(&printed) {
            self.refuse(&refusal, &schemata);
        }
        let now = self.mutants.iter().filter(|(standing, _)| *standing == BuildState::Built).count();
        assert!(now < left, "rustc refuses more than mutants:\n{printed}");
        false
    }

    /// Writes a file with its mutants. Mutants that cannot be selected at run time are marked as [`BuildState::Apart`].
    fn schema(&mut self, source: &Source) -> Schema {
        let built =
            self.mutants().filter(|(_, standing, mutant)| *standing == BuildState::Built && mutant.file == source.file);
        let built: Vec<_> = built.map(|(place, _, mutant)| (number(place), mutant)).collect();
        let schema = Schema::new(&source.text, &built).unwrap_or_else(|error| panic!("{}: {error}", source.file));
        for (number, _) in built {
            if !schema.holds(number) {
                self.mutants[place(number)].0 = BuildState::Apart;
            }
        }
        self.checkout.write(&source.file, &schema.text);
        schema
    }

    fn refuse(&mut self, refusal: &Refusal, schemata: &BTreeMap<String, Schema>) {
        match refusal.places.iter().find_map(|(file, byte)| schemata.get(file)?.at(*byte)) {
            Some(Body::Changed(number)) => self.mutants[place(*number)].0 = BuildState::DoesNotCompile,
            Some(Body::Original(numbers)) => {
                numbers.iter().for_each(|number| self.mutants[place(*number)].0 = BuildState::Apart);
            }
            None => println!("{}", refusal.text),
        }
    }

    /// Runs cargo in the copy; returns `true` if it succeeded, and its standard output.
    fn cargo(&self, arguments: &[&[&str]]) -> (bool, String) {
        let mut command = Command::new(cargo());
        environment(&mut command, &self.checkout);
        command.args(arguments.concat()).env("RUSTFLAGS", "--cap-lints=allow").stderr(Stdio::null());
        let output = command.output().expect("cargo runs");
        (output.status.success(), String::from_utf8(output.stdout).expect("cargo prints UTF-8"))
    }

    /// Runs a test with the mutant `number`, or without a fault if `number` is 0.
    fn executed(&self, test: &Test, number: u32) -> ExitStatus {
        let mut command = Command::new("sh");
        environment(&mut command, &self.checkout);
        command
            .args(["-c", "ulimit -v $0 && ulimit -t $1 && shift && exec timeout --signal=KILL \"$@\"", MEMORY])
            .args([test.limit, ENDLESS].map(|limit| limit.as_secs().to_string()))
            .arg(&test.executable.path)
            .args(test.filters)
            .current_dir(&test.executable.folder)
            .env("CARGO", cargo())
            .env("CARGO_MANIFEST_DIR", &test.executable.folder)
            .env("INSTA_WORKSPACE_ROOT", self.checkout.sources())
            // Tests build their own programs with the same flags as this build.
            .env("RUSTFLAGS", "--cap-lints=allow")
            // A function with all its mutants is long and has a large stack frame.
            .env("RUST_MIN_STACK", (64 << 20).to_string())
            .env(VARIABLE, number.to_string());
        command.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("a shell")
    }
}

/// Returns the number of the mutant with this index.
fn number(place: usize) -> u32 {
    u32::try_from(place).ok().and_then(|place| place.checked_add(1)).expect("mutants can be counted")
}

/// Returns the index of the mutant with this number.
fn place(number: u32) -> usize {
    number as usize - 1
}
