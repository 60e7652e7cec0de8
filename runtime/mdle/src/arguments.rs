//! The command line of `mdle`.
//!
//! Arguments after the plan are options of the run. They depend on the target, and the host parses them.

mod ears;
mod locate;
mod log;
mod manual;
mod map;
mod map_option;
mod module_options;
mod navigate;
mod new_module;
mod plan;
mod plot;
mod replay;
mod why;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use clap_complete::Shell;

use mdle_engine::tree::Role;

use crate::Failure;
use crate::new_module::NewModule;
use crate::test::arguments::{self as test, Test};
pub(crate) use ears::{EarsOption, head};
pub(crate) use locate::Locate;
pub(crate) use log::Log;
pub(crate) use map::MakeMap;
pub(crate) use map_option::MapOption;
pub(crate) use navigate::Navigate;
use plan::with_plan;
pub(crate) use plot::Plot;
pub(crate) use replay::Replay;
pub(crate) use why::{Question, Why};

/// The parsed command line: a command and its arguments.
#[derive(Debug, PartialEq)]
pub(crate) enum ParsedCommand {
    /// `mdle run` or `mdle shell`.
    Run(Box<RunArguments>),
    /// `mdle navigate`.
    Navigate(Navigate),
    /// `mdle new-module`.
    NewModule(NewModule),
    /// `mdle replay`.
    Replay(Replay),
    /// `mdle why`.
    Why(Why),
    /// `mdle log`.
    Log(Log),
    /// `mdle plot`.
    Plot(Plot),
    /// `mdle locate`.
    Locate(Locate),
    /// `mdle map`.
    Map(MakeMap),
    /// `mdle test`.
    Test(Test),
    /// `mdle completions`.
    Completions(Shell),
    /// `mdle man`, with the words of the command to describe; empty for `mdle` itself.
    Man(Vec<String>),
}

/// The arguments of `mdle run`.
#[derive(Debug, PartialEq)]
pub(crate) struct RunArguments {
    /// Path of the plan's file; `-` means standard input.
    pub(crate) file: PathBuf,
    /// Name or folder of the target; `None` for the target that the `mdle.toml` beside the plan names.
    pub(crate) target: Option<String>,
    /// Name of the plan to run, for a file with several plans.
    pub(crate) plan: Option<String>,
    /// Path of the safety file.
    pub(crate) safety: Option<PathBuf>,
    /// Path of the link file, which names the other robots.
    pub(crate) link: Option<PathBuf>,
    /// Name of the path that the run replaces with the way back after each `path` and `Follow`; `None` if no path is
    /// recorded.
    pub(crate) records: Option<String>,
    /// Name and command line of each child process to load as a module.
    pub(crate) modules: Vec<(String, String)>,
    /// Point for the module `heading`, in metres; `None` if the option does not request the module.
    pub(crate) point: Option<(f64, f64)>,
    /// Source of the audio samples for the module `heading`, as `--ears` names it; `None` without `--ears`.
    pub(crate) ears: Option<EarsOption>,
    /// Radius of the head with the ears, in metres.
    pub(crate) head: f64,
    /// The map to create; `None` if no map is requested.
    pub(crate) map: Option<MapOption>,
    /// `true` if warnings are treated as errors.
    pub(crate) deny_warnings: bool,
    /// Program name and arguments of this call, without the options of the run.
    pub(crate) words: Vec<OsString>,
    /// The options of the run.
    pub(crate) options: Vec<OsString>,
    /// The session of `mdle shell`; `None` for `mdle run`.
    pub(crate) session: Option<SessionOptions>,
}

impl RunArguments {
    /// Returns `true` if the options of the run request help or the version instead of a run.
    pub(crate) fn asks(&self) -> bool {
        self.options.iter().any(|option| HELP.iter().chain(&VERSION).any(|asked| option == asked))
    }
}

/// The options of a session.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct SessionOptions {
    /// Path of the command file; `None` to read commands from the terminal or from a pipe.
    pub(crate) commands: Option<PathBuf>,
    /// `true` if the first error ends the session.
    pub(crate) stops_at_errors: bool,
    /// `true` if each command is printed before its answer.
    pub(crate) echoes: bool,
    /// Role of the user.
    pub(crate) role: Role,
    /// `true` if stepped time is paused at the beginning of the run.
    pub(crate) is_paused: bool,
}

/// Options that `mdle` itself parses and that have a value.
const WITH_VALUE: [&str; 15] = [
    "--landmarks",
    "--target",
    "--plan",
    "--safety",
    "--link",
    "--records",
    "--module",
    "--point",
    "--ears",
    "--head",
    map_option::OPTIONS[0],
    map_option::OPTIONS[1],
    "-c",
    "--commands",
    "--role",
];
/// Options that `mdle navigate` itself parses.
const OF_ROUTES: [&str; 2] = ["--landmarks", "--target"];
/// Arguments that an executable with the engine does not take, because it contains their values.
const NOT_IN_EXECUTABLES: [&str; 4] = ["file", "target", "plan", "deny-warnings"];
/// Options that request help.
const HELP: [&str; 2] = ["-h", "--help"];
/// Options that request the version of an executable.
const VERSION: [&str; 2] = ["-V", "--version"];
/// Options that `mdle` itself parses and that have no value.
const FLAGS: [&str; 4] = ["--deny-warnings", "-e", "-x", "--paused"];

/// Returns the long options, with their dashes, that `mdle run` or `mdle shell` parses itself, or an executable that
/// contains the engine.
pub(crate) fn own_options(in_session: bool, in_executable: bool) -> Vec<String> {
    let command = if in_session { shell() } else { run() };
    let options = command.get_arguments().filter_map(|option| option.get_long());
    options
        .filter(|name| !(in_executable && NOT_IN_EXECUTABLES.contains(name)))
        .map(|name| format!("--{name}"))
        .collect()
}

/// Parses the arguments of the process, which begin with the program's own name.
///
/// # Errors
/// Fails if the arguments are invalid, or request help.
pub(crate) fn parse(arguments: Vec<OsString>) -> Result<ParsedCommand, Failure> {
    let words = match arguments.get(1).and_then(|command| command.to_str()) {
        Some("run" | "shell") => 1,
        Some("navigate") => 3,
        Some(_) | None => 0,
    };
    let (own, options) = if words > 0 { apart(arguments, words)? } else { (arguments, Vec::new()) };
    let matches = command().try_get_matches_from(&own).map_err(Failure::unparsed)?;
    match matches.subcommand() {
        Some(("run", run)) => Ok(of(run, own, options, None)),
        Some(("shell", shell)) => Ok(of(shell, own, options, Some(session(shell)))),
        Some(("navigate", matches)) => Ok(ParsedCommand::Navigate(Navigate::of(matches, own, options))),
        Some(("new-module", new)) => {
            let name = new.get_one("name").cloned().unwrap_or_default();
            Ok(ParsedCommand::NewModule(NewModule { name, checkout: new.get_one("checkout").cloned() }))
        }
        Some(("replay", matches)) => Ok(ParsedCommand::Replay(Replay::of(matches))),
        Some(("why", matches)) => Ok(ParsedCommand::Why(Why::of(matches))),
        Some(("log", matches)) => Ok(ParsedCommand::Log(Log::of(matches))),
        Some(("locate", matches)) => Ok(ParsedCommand::Locate(Locate::of(matches))),
        Some(("map", matches)) => Ok(ParsedCommand::Map(MakeMap::of(matches))),
        Some(("plot", matches)) => Ok(ParsedCommand::Plot(Plot::of(matches))),
        Some(("test", matches)) => Ok(ParsedCommand::Test(test::read(matches))),
        Some(("completions", matches)) => Ok(ParsedCommand::Completions(manual::shell(matches))),
        Some(("man", matches)) => Ok(ParsedCommand::Man(manual::words(matches))),
        Some(_) | None => Err(Failure::Usage("no command was given\nhelp: `mdle run PLAN` runs a plan".to_owned())),
    }
}

fn session(shell: &ArgMatches) -> SessionOptions {
    let role = shell.get_one::<String>("role").and_then(|name| Role::ALL.into_iter().find(|role| role.name() == name));
    SessionOptions {
        commands: shell.get_one("commands").cloned(),
        stops_at_errors: shell.get_flag("errors"),
        echoes: shell.get_flag("echo"),
        role: role.unwrap_or(Role::Admin),
        is_paused: shell.get_flag("paused"),
    }
}

fn of(
    run: &ArgMatches,
    words: Vec<OsString>,
    options: Vec<OsString>,
    session: Option<SessionOptions>,
) -> ParsedCommand {
    let (ears, head) = ears::ears(run);
    ParsedCommand::Run(Box::new(RunArguments {
        file: run.get_one("file").cloned().unwrap_or_default(),
        target: run.get_one("target").cloned(),
        plan: run.get_one("plan").cloned(),
        safety: run.get_one("safety").cloned(),
        link: run.get_one("link").cloned(),
        records: run.get_one("records").cloned(),
        modules: run.get_many("module").into_iter().flatten().cloned().collect(),
        point: run.get_one("point").copied(),
        ears,
        head,
        map: MapOption::of(run),
        deny_warnings: run.get_flag("deny-warnings"),
        words: map_option::without_map(words),
        options,
        session,
    }))
}

/// Separates the options of the run from the arguments that `mdle` parses itself. The options of the run come after the
/// first `missing` words that follow the command; these words are the plan, or the graph and the landmarks of a route.
///
/// # Errors
/// Fails if an option of the run comes before these words, or if an option does not apply to a route.
fn apart(arguments: Vec<OsString>, mut missing: usize) -> Result<(Vec<OsString>, Vec<OsString>), Failure> {
    let (mut own, mut options) = (Vec::new(), Vec::new());
    // The names of the program and of the command.
    let (head, mut rest) = arguments.split_at_checked(2).unwrap_or((&arguments, &[]));
    own.extend_from_slice(head);
    while let Some((first, others)) = rest.split_first() {
        rest = others;
        let text = first.to_str().unwrap_or_default();
        let name = text.split_once('=').map_or(text, |(name, _)| name);
        let navigates = own.get(1).is_some_and(|command| command == "navigate");
        if navigates && (WITH_VALUE.contains(&name) || FLAGS.contains(&text)) && !OF_ROUTES.contains(&name) {
            let sentence = "is for one plan, and a route has several";
            return Err(Failure::Usage(format!("`{name}` {sentence}\nhelp: leave it out")));
        }
        if WITH_VALUE.contains(&name) || FLAGS.contains(&text) {
            own.push(first.clone());
            if name == text && !FLAGS.contains(&text) {
                let (value, others) = rest.split_at(rest.len().min(1));
                own.extend_from_slice(value);
                rest = others;
            }
        } else if missing == 0 {
            options.push(first.clone());
        } else {
            let is_word = !text.starts_with('-') || text == "-";
            if !is_word && !HELP.contains(&text) {
                let (before, after, form) = match (navigates, missing) {
                    (true, 1) => {
                        ("the landmark to which the robot is to go", "the landmarks", "navigate GRAPH FROM TO")
                    }
                    (true, _) => ("the landmarks", "the landmarks", "navigate GRAPH FROM TO"),
                    (false, _) => ("the plan", "the plan", "run PLAN"),
                };
                return Err(Failure::Usage(format!(
                    "`{text}` comes before {before}\nhelp: the options of a run follow {after}, as in `mdle {form} {text} …`"
                )));
            }
            missing -= usize::from(is_word);
            own.push(first.clone());
        }
    }
    Ok((own, options))
}

/// Returns the help text about the options of the engine, for an executable that contains a plan and the engine; `None`
/// if the options of the run do not request help.
pub(crate) fn help_of_executables(options: &[OsString]) -> Option<String> {
    if !options.iter().any(|option| HELP.iter().any(|help| option == help)) {
        return None;
    }
    let command =
        NOT_IN_EXECUTABLES.into_iter().fold(run(), |command, name| command.mut_arg(name, |arg| arg.hide(true)));
    let mut command = command.disable_help_flag(true).help_template("Options of the engine:\n{options}\n\n");
    Some(command.render_help().to_string())
}

/// Returns the definition of the command-line interface of `mdle`.
pub(crate) fn command() -> Command {
    Command::new("mdle")
        .about("Run MDLe plans on robots without building them")
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(run())
        .subcommand(shell())
        .subcommand(navigate::navigate())
        .subcommand(new_module::new_module())
        .subcommand(replay::replay())
        .subcommand(why::why())
        .subcommand(log::log())
        .subcommand(plot::plot())
        .subcommand(map::map())
        .subcommand(locate::locate())
        .subcommand(test::command())
        .subcommand(manual::completions())
        .subcommand(manual::man())
}

fn shell() -> Command {
    let command = Command::new("shell")
        .about("Run a plan in a session: read and change what a tree of names holds while it runs")
        .long_about(
            "Run a plan in a session: read and change what a tree of names holds while it runs\n\nCommands come from the \
             terminal, from a pipe, or from a file; `help` lists them. The report of the run goes to standard error. At the \
             end of the commands the robot is stopped. The options of the run follow the plan, as for `mdle run`.",
        )
        .override_usage("mdle shell [OPTIONS] <PLAN> [OPTIONS OF THE RUN]");
    let flag = |name: &'static str| Arg::new(name).action(ArgAction::SetTrue);
    map_option::with_map(ears::with_ears(with_plan(command)))
        .arg(
            Arg::new("commands")
                .short('c')
                .long("commands")
                .value_name("FILE")
                .help("File of commands [default: standard input]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(flag("errors").short('e').help("End the session at the first error of a command"))
        .arg(flag("echo").short('x').help("Print each command before its answer"))
        .arg(flag("paused").long("paused").help("Begin with the clock stopped, where time is simulated"))
        .arg(
            Arg::new("role")
                .long("role")
                .value_name("ROLE")
                .help("Role of who types: what may be changed [default: admin]")
                .value_parser(Role::ALL.map(Role::name)),
        )
        .after_help(
            "Exit status: that of the run, 0 if the session ended it; 1 if the plan has errors or a command was refused, 2 for \
             wrong usage or a file that cannot be read",
        )
}

/// Help text about the exit statuses of `mdle run`.
const AFTER: &str = "Exit status: that of the executable; 1 if the plan has errors, 2 for wrong usage or a file that cannot \
                     be read, 6 if a safety rule ended the plan";

fn run() -> Command {
    map_option::with_map(ears::with_ears(with_plan(run_alone())))
}

fn run_alone() -> Command {
    Command::new("run")
        .about("Compile a plan and run it")
        .long_about(
            "Compile a plan and run it\n\nThe options of the run follow the plan. They are those of the executable \
             that mdlec builds: `mdle run PLAN --target sim --help` lists them.",
        )
        .override_usage("mdle run [OPTIONS] <PLAN> [OPTIONS OF THE RUN]")
        .after_help(AFTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> RunArguments {
        match parse(line.split(' ').map(OsString::from).collect()).unwrap() {
            ParsedCommand::Run(run) => *run,
            ParsedCommand::Navigate(navigate) => panic!("{navigate:?}"),
            ParsedCommand::NewModule(new) => panic!("{new:?}"),
            ParsedCommand::Replay(replay) => panic!("{replay:?}"),
            ParsedCommand::Why(why) => panic!("{why:?}"),
            ParsedCommand::Log(log) => panic!("{log:?}"),
            ParsedCommand::Locate(locate) => panic!("{locate:?}"),
            ParsedCommand::Map(map) => panic!("{map:?}"),
            ParsedCommand::Plot(plot) => panic!("{plot:?}"),
            ParsedCommand::Test(test) => panic!("{test:?}"),
            ParsedCommand::Completions(shell) => panic!("{shell:?}"),
            ParsedCommand::Man(words) => panic!("{words:?}"),
        }
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
    fn modules_have_a_name_and_a_command() {
        let run = parsed("mdle run a.mdle --module ears=./ears --point=-1,50cm --module=nose=./nose --seed 3");
        let named = |name: &str, command: &str| (name.to_owned(), command.to_owned());
        assert_eq!(run.modules, [named("ears", "./ears"), named("nose", "./nose")]);
        assert_eq!((run.point, run.options.len()), (Some((-1.0, 0.5)), 2));
        let refused =
            ["--module ears", "--module =ears", "--module ears=", "--point 3", "--point 3s,1", "--point NaN,1"];
        for option in refused {
            let words = ["mdle", "run", "a.mdle"].into_iter().chain(option.split(' '));
            assert!(parse(words.map(OsString::from).collect()).is_err(), "{option}");
        }
    }

    #[test]
    fn the_command_line_is_sound() {
        command().debug_assert();
    }
}
