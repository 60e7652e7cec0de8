//! The options of a scenario, which follow its file on the command line.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Arg, ArgMatches, Command, value_parser};
use mdle_host::{Program, Quantity, determining, is_record, output_format, quoted};

use crate::arguments::RunArguments;
use crate::failure::Failure;

/// Name of the command if no executable contains the scenario.
const MDLE: &str = "mdle run SCENARIO.toml";

/// The options of a scenario.
#[derive(Debug, Default)]
pub(super) struct ScenarioOptions {
    pub(super) seed: Option<u64>,
    pub(super) timeout: Option<Duration>,
    /// Path of the log file. If the log is a record, the paths of the robots' records are derived from this path.
    pub(super) log: Option<PathBuf>,
    /// Command that repeats the run without writing its files.
    pub(super) command: String,
    /// Path of the file with the table of poses.
    pub(super) trail: Option<PathBuf>,
    /// Path of the picture.
    pub(super) plot: Option<PathBuf>,
    /// Path of a picture of the paths that were driven under `path` and `Follow`.
    pub(super) trips: Option<PathBuf>,
    /// Folder for the paths that robots record.
    pub(super) recorded_paths: Option<PathBuf>,
    /// Number of threads for a crowd; `None` means one thread per processor.
    pub(super) threads: Option<usize>,
}

impl ScenarioOptions {
    /// Reads the options of a scenario. `program` is the executable that contains the scenario; `None` if `mdle` reads
    /// it from a file.
    ///
    /// # Errors
    /// Fails if an option is unknown, has a wrong value, or applies only to a single plan, or if the options request
    /// help.
    pub(super) fn read(run: &RunArguments, program: Option<Program<'_>>) -> Result<Self, Failure> {
        let of_a_plan = [
            (run.target.is_some(), "--target"),
            (run.plan.is_some(), "--plan"),
            (run.deny_warnings, "--deny-warnings"),
            (run.safety.is_some(), "--safety"),
            (run.link.is_some(), "--link"),
            (run.records.is_some(), "--records"),
            (run.session.is_some(), "shell"),
            (!run.modules.is_empty(), "--module"),
            (run.point.is_some(), "--point"),
            (run.ears.is_some(), "--ears"),
            (run.map.is_some(), "--map"),
        ];
        if let Some((_, name)) = of_a_plan.into_iter().find(|(is_given, _)| *is_given) {
            let sentence = "is for one robot, and a scenario names the plan of each";
            return Err(Failure::Usage(format!("{name} {sentence}\nhelp: leave it out")));
        }
        let is_speed = |option: &std::ffi::OsString| option.to_string_lossy().split('=').next() == Some("--speed");
        if run.options.iter().any(is_speed) {
            let sentence = "--speed is for one robot, and a scenario always runs as fast as possible";
            return Err(Failure::Usage(format!("{sentence}\nhelp: leave it out")));
        }
        let words = [std::ffi::OsString::from(MDLE)].into_iter().chain(run.options.clone());
        let command = match program {
            None => command(MDLE).override_usage("mdle run <SCENARIO.toml> [OPTIONS]"),
            Some(Program { plan, version }) => {
                command(plan).override_usage(format!("{plan} [OPTIONS]")).version(version.to_owned())
            }
        };
        let matches = command.try_get_matches_from(words).map_err(Failure::unparsed)?;
        let repeated = run.words.iter().cloned().chain(determining(&run.options));
        let repeated: Vec<_> = repeated.map(|word| quoted(&word.to_string_lossy())).collect();
        Ok(Self { command: repeated.join(" "), ..Self::of(&matches) })
    }

    fn of(matches: &ArgMatches) -> Self {
        let file = |name: &str| matches.get_one::<PathBuf>(name).cloned();
        Self {
            seed: matches.get_one("seed").copied(),
            timeout: matches.get_one("timeout").copied(),
            log: file("log"),
            command: String::new(),
            trail: file("trail"),
            plot: file("plot"),
            trips: file("trips"),
            recorded_paths: file("recorded-paths"),
            threads: matches.get_one::<u64>("threads").map(|count| *count as usize),
        }
    }

    /// Checks that all given options apply to a crowd.
    ///
    /// # Errors
    /// Fails if an option does not apply to a crowd.
    pub(super) fn check_crowd(&self) -> Result<(), Failure> {
        let of_robots = [
            (self.log.as_deref().is_some_and(|log| !is_record(log)), "--log FILE.jsonl"),
            (self.plot.is_some(), "--plot"),
            (self.trips.is_some(), "--trips"),
            (self.recorded_paths.is_some(), "--recorded-paths"),
        ];
        let Some((_, name)) = of_robots.into_iter().find(|(is_given, _)| *is_given) else { return Ok(()) };
        let help = "leave it out; `--trail FILE.csv` has the poses of a crowd";
        Err(Failure::Usage(format!("{name} is for robots with names, and this is a crowd\nhelp: {help}")))
    }

    /// Checks that no given option applies only to a crowd.
    ///
    /// # Errors
    /// Fails if an option applies only to a crowd.
    pub(super) fn check_robots(&self) -> Result<(), Failure> {
        if self.threads.is_none() {
            return Ok(());
        }
        let sentence = "--threads is for a crowd, and robots with names have one thread";
        Err(Failure::Usage(format!("{sentence}\nhelp: leave it out")))
    }
}

fn command(name: &str) -> Command {
    let option = |name: &'static str, value: &'static str, help: &'static str| {
        Arg::new(name).long(name).value_name(value).help(help)
    };
    Command::new(name.to_owned())
        .about("Run the robots of a scenario in one world, as fast as possible")
        .arg(
            option("seed", "SEED", "Random seed for the errors of all robots and of the link [default: that of the file]")
                .value_parser(value_parser!(u64)),
        )
        .arg(
            option("timeout", "TIME", "Time after which the run ends, in seconds or with a unit [default: that of the file]")
                .value_parser(timeout),
        )
        .arg(
            option("log", "FILE", "File for a line of JSON for each turn of each robot; `FILE.mcap` is a record of each robot to replay, as `FILE.ROBOT.mcap`")
                .value_parser(log),
        )
        .arg(option("trail", "FILE.csv", "File for the poses of all robots: time, robot, x, y, heading").value_parser(output_format("CSV", "csv")))
        .arg(option("plot", "FILE.svg", "File for a picture of the floor with the ways of all robots").value_parser(output_format("SVG", "svg")))
        .arg(
            option("trips", "FILE.svg", "File for a picture of the ways that `path` and `Follow` drove, a floor for each robot")
                .value_parser(output_format("SVG", "svg")),
        )
        .arg(
            option("recorded-paths", "FOLDER", "Folder for the paths that robots record, each in a folder of the robot's name")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("threads", "N", "Number of threads of a crowd; results do not depend on it [default: number of processors]")
                .value_parser(value_parser!(u64).range(1..=1024)),
        )
        .after_help(
            "Exit status: 0 if all plans are over; 1 if a plan has errors; 2 for wrong usage or a file that cannot be read; 3 \
             if a fault stopped a robot, or a file could not be written; 4 if a plan still ran at the end",
        )
}

/// Reads the name of a log file. The extension `.mcap` means records; `.jsonl` or no extension means JSON lines.
fn log(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_known = is_record(&path) || path.extension().is_none_or(|ending| ending.eq_ignore_ascii_case("jsonl"));
    let other = || {
        let [lines, record] = ["jsonl", "mcap"].map(|ending| path.with_extension(ending));
        format!("name the file `{}` for JSON lines, or `{}` for records", lines.display(), record.display())
    };
    if is_known { Ok(path.clone()) } else { Err(other()) }
}

fn timeout(text: &str) -> Result<Duration, String> {
    Quantity::duration(text, "s", Duration::ZERO, Duration::from_secs(1_000_000_000))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_options_are_sound() {
        super::command(super::MDLE).debug_assert();
    }
}
