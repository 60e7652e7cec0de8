//! The command line of `mdle test`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

/// Maximum number of runs of a test.
pub(crate) const MOST_SEEDS: u64 = 1_000_000;

/// The arguments of `mdle test`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Test {
    /// Paths of the test files, plans or folders to test.
    pub(crate) files: Vec<PathBuf>,
    /// Name of the only test to run.
    pub(crate) only: Option<String>,
    /// Number of runs of each test with a seed.
    pub(crate) seeds: Option<u64>,
    /// First seed.
    pub(crate) seed: Option<u64>,
    /// Number of parallel runs.
    pub(crate) jobs: Option<u64>,
    /// `true` if the coverage is printed.
    pub(crate) coverage: bool,
    /// Folder for pictures of the plans, which show how many times each atom began.
    pub(crate) pictures: Option<PathBuf>,
    /// Path of the file for the results in JUnit's XML format.
    pub(crate) junit: Option<PathBuf>,
    /// `true` if the results are printed as JSON.
    pub(crate) json: bool,
    /// `true` if test files are updated with the results of the runs.
    pub(crate) update: bool,
    /// `true` if the tests run again whenever a file changes.
    pub(crate) watch: bool,
}

/// Returns the definition of the command `mdle test` and its arguments.
pub(crate) fn command() -> Command {
    let flag = |name: &'static str| Arg::new(name).long(name).action(ArgAction::SetTrue);
    let option = |name: &'static str, value: &'static str| Arg::new(name).long(name).value_name(value);
    Command::new("test")
        .about("Run the tests of plans")
        .long_about(
            "Run the tests of plans\n\nThe tests of `dock.mdle` are in `dock.test.toml` beside it. A test is a script \
             of interrupts, or a run in the simulator, and what is expected of it. The page \"Testing a plan\" of the \
             book has the format.",
        )
        .arg(
            Arg::new("files")
                .value_name("FILE")
                .help("Test files, their plans, or folders with test files [default: the current folder]")
                .num_args(0..)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(option("test", "NAME").help("Run only the test of this name"))
        .arg(
            option("seeds", "N")
                .help("Number of runs of each test with a seed, with consecutive seeds [default: that of the test]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(i64).range(1..=MOST_SEEDS.cast_signed())),
        )
        .arg(
            option("seed", "N")
                .help("First seed of each test with a seed [default: that of the test]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64)),
        )
        .arg(
            option("jobs", "N")
                .help("Number of parallel runs; results do not depend on it [default: number of processors]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(i64).range(1..=1024)),
        )
        .arg(flag("coverage").help("Print which atoms, ends and operands of the plans the tests have reached"))
        .arg(
            option("pictures", "FOLDER")
                .help("Folder for a picture of each plan with the number of times that each atom began")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("junit", "FILE")
                .help("File for the results in the XML of JUnit")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(flag("json").help("Print the results and the coverage as JSON"))
        .arg(flag("update").help("Write the atoms, the end and the pose of runs into the test files, to be reviewed"))
        .arg(flag("watch").help("Run the tests again whenever a file beside them changes").conflicts_with("update"))
        .after_help(
            "Exit status: 0 if all tests pass; 1 if a test fails or a plan has errors; 2 for wrong usage, or a test \
             file that cannot be read or has errors",
        )
}

/// Reads the arguments from the parsed command line.
pub(crate) fn read(matches: &ArgMatches) -> Test {
    // A signed type, so that the message about a negative number contains the valid range.
    let count = |name: &str| matches.get_one::<i64>(name).map(|count| count.unsigned_abs());
    Test {
        files: matches.get_many("files").into_iter().flatten().cloned().collect(),
        only: matches.get_one("test").cloned(),
        seeds: count("seeds"),
        seed: matches.get_one("seed").copied(),
        jobs: count("jobs"),
        coverage: matches.get_flag("coverage"),
        pictures: matches.get_one("pictures").cloned(),
        junit: matches.get_one("junit").cloned(),
        json: matches.get_flag("json"),
        update: matches.get_flag("update"),
        watch: matches.get_flag("watch"),
    }
}
