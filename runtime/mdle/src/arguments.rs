//! The command line of `mdle`.
//!
//! The words after the plan are the options of the run, which depend on the target: the host parses them.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

use crate::Failure;

/// The arguments of `mdle run`.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Run {
    /// The plan's file; `-` is standard input.
    pub(crate) file: PathBuf,
    /// Name or folder of the target; `None` for that of the `mdle.toml` beside the plan.
    pub(crate) target: Option<String>,
    /// Name of the plan, for a file with several.
    pub(crate) plan: Option<String>,
    /// File of the safety rules.
    pub(crate) safety: Option<PathBuf>,
    /// `true` if warnings count as errors.
    pub(crate) deny_warnings: bool,
    /// Words that repeat the call, but for the options of the run.
    pub(crate) words: Vec<OsString>,
    /// The options of the run.
    pub(crate) options: Vec<OsString>,
}

/// Options of `mdle` itself that have a value.
const WITH_VALUE: [&str; 3] = ["--target", "--plan", "--safety"];
/// Options that ask for help.
const HELP: [&str; 2] = ["-h", "--help"];
/// Option of `mdle` itself without a value.
const DENY_WARNINGS: &str = "--deny-warnings";

/// Parses the arguments of the process, the program's own name first.
///
/// # Errors
/// The arguments are wrong, or ask for help.
pub(crate) fn parse(arguments: Vec<OsString>) -> Result<Run, Failure> {
    let (own, options) = apart(arguments)?;
    let matches = command().try_get_matches_from(&own).map_err(Failure::Unparsed)?;
    let Some(("run", run)) = matches.subcommand() else {
        return Err(Failure::Usage("no command was given\nhelp: `mdle run PLAN` runs a plan".to_owned()));
    };
    Ok(of(run, own, options))
}

fn of(run: &ArgMatches, words: Vec<OsString>, options: Vec<OsString>) -> Run {
    Run {
        file: run.get_one("file").cloned().unwrap_or_default(),
        target: run.get_one("target").cloned(),
        plan: run.get_one("plan").cloned(),
        safety: run.get_one("safety").cloned(),
        deny_warnings: run.get_flag("deny-warnings"),
        words,
        options,
    }
}

/// Takes the options of the run, which come after the plan, away from the arguments that `mdle` parses itself.
///
/// # Errors
/// An option of the run comes before the plan.
fn apart(arguments: Vec<OsString>) -> Result<(Vec<OsString>, Vec<OsString>), Failure> {
    let (mut own, mut options) = (Vec::new(), Vec::new());
    let mut has_plan = false;
    // The program's own name and that of the command.
    let (head, mut rest) = arguments.split_at_checked(2).unwrap_or((&arguments, &[]));
    own.extend_from_slice(head);
    while let Some((first, others)) = rest.split_first() {
        rest = others;
        let text = first.to_str().unwrap_or_default();
        let name = text.split_once('=').map_or(text, |(name, _)| name);
        if WITH_VALUE.contains(&name) || text == DENY_WARNINGS {
            own.push(first.clone());
            if name == text && name != DENY_WARNINGS {
                let (value, others) = rest.split_at(rest.len().min(1));
                own.extend_from_slice(value);
                rest = others;
            }
        } else if has_plan {
            options.push(first.clone());
        } else {
            has_plan = !text.starts_with('-') || text == "-";
            if !has_plan && !HELP.contains(&text) {
                return Err(Failure::Usage(format!(
                    "`{text}` comes before the plan\nhelp: the options of a run follow the plan, as in `mdle run PLAN {text} …`"
                )));
            }
            own.push(first.clone());
        }
    }
    Ok((own, options))
}

/// Returns the command line of `mdle`.
fn command() -> Command {
    Command::new("mdle")
        .about("Run MDLe plans on robots without building them")
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(run())
}

fn run() -> Command {
    Command::new("run")
        .about("Compile a plan and run it")
        .long_about(
            "Compile a plan and run it\n\nThe options of the run follow the plan. They are those of the executable \
             that mdlec builds: `mdle run PLAN --target sim --help` lists them.",
        )
        .override_usage("mdle run [OPTIONS] <PLAN> [OPTIONS OF THE RUN]")
        .arg(
            Arg::new("file")
                .value_name("PLAN")
                .help("Plan to run; `-` reads standard input")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("target")
                .long("target")
                .value_name("TARGET")
                .help("Robot to run on [default: the target of the `mdle.toml` beside the plan]"),
        )
        .arg(
            Arg::new("plan")
                .long("plan")
                .value_name("NAME")
                .help("Plan of the file to run [default: the only plan that no other plan uses]"),
        )
        .arg(
            Arg::new("safety")
                .long("safety")
                .value_name("FILE")
                .help("File of safety rules, which lie between the plan and the robot [default: none]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("deny-warnings")
                .long("deny-warnings")
                .action(ArgAction::SetTrue)
                .help("Treat warnings as errors"),
        )
        .after_help(
            "Exit status: that of the executable; 1 if the plan has errors, 2 for wrong usage or a file that cannot be read, 6 if \
             a safety rule ended the plan",
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Run {
        parse(line.split(' ').map(OsString::from).collect()).unwrap()
    }

    #[test]
    fn options_of_the_run_follow_the_plan() {
        let run = parsed("mdle run --plan Tour a.mdle --world office --target=sim --log a.jsonl --deny-warnings");
        assert_eq!((run.file.as_path(), run.target.as_deref()), ("a.mdle".as_ref(), Some("sim")));
        assert_eq!((run.plan.as_deref(), run.deny_warnings), (Some("Tour"), true));
        assert_eq!(run.options, ["--world", "office", "--log", "a.jsonl"]);
        assert_eq!(run.words.join(" ".as_ref()), "mdle run --plan Tour a.mdle --target=sim --deny-warnings");
    }

    #[test]
    fn help_after_the_plan_is_that_of_the_run() {
        assert_eq!(parsed("mdle run - --target sim --help").options, ["--help"]);
        for own in ["mdle --help", "mdle run --help", "mdle run", "mdle", "mdle run --world office a.mdle"] {
            assert!(parse(own.split(' ').map(OsString::from).collect()).is_err(), "{own}");
        }
    }

    #[test]
    fn the_command_line_is_sound() {
        command().debug_assert();
    }
}
