//! The arguments of `mdlec` and its commands, with the texts of `--help`.
//!
//! The first paragraph of a doc comment is the line of `-h`, the whole comment the text of `--help`.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use super::emit::Emit;
use crate::link;
use mdle_theory::theorem::STEPS;

/// Compile plans in MDLe, the Motion Description Language, for robots
///
/// A plan is a text file that lists what a robot does: control laws, and the interrupts that end them. `mdlec PLAN
/// --target ROBOT` checks the plan and builds one executable that runs it on that robot, or in the simulator with
/// `--target sim`.
#[derive(Debug, Parser)]
#[command(name = "mdlec", version, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "Example: mdlec run plan.mdle --target sim -- --speed max --plot run.svg")]
#[command(after_long_help = "\
Examples:
  mdlec plan.mdle --target sim                  Build ./plan for the simulated robot
  mdlec run plan.mdle --target sim -- --watch   Build it, run it, and show the run in the terminal
  mdlec check plan.mdle                         Report the errors of a plan
  mdlec quarks --target sim                     List the laws and interrupts of a robot

Exit status:
  0      success
  1      the plan has errors, or the machine has no plan
  2      wrong usage, a target that does not compile, or a file that cannot be read or written
  101    a bug in mdlec
  128+N  terminated by signal N
  With `run` and --run, the exit status of the executable.")]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    #[command(flatten)]
    pub(super) bare: Bare,
    /// Format of messages [default: human]
    ///
    /// `human` is text for a terminal. `json` is one JSON object per line on standard error, with the code, severity,
    /// message, places and help of each message.
    #[arg(
        long,
        value_enum,
        global = true,
        default_value_t = MessageFormat::Human,
        value_name = "FORMAT",
        hide_default_value = true
    )]
    pub(super) message_format: MessageFormat,
    /// Colours in messages and help [default: auto]
    ///
    /// `auto` is colours on a terminal, unless the variable NO_COLOR is set.
    #[arg(
        long,
        value_enum,
        global = true,
        default_value_t = Color::Auto,
        value_name = "WHEN",
        hide_default_value = true
    )]
    pub(super) color: Color,
}

/// Argument of `--color`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Color {
    /// On a terminal
    Auto,
    /// Everywhere
    Always,
    /// Nowhere
    Never,
}

/// Format of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum MessageFormat {
    /// Text for a terminal
    Human,
    /// One JSON object per line: code, severity, message, spans, help
    Json,
}

/// The commands of `mdlec`.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Build the executable of a plan, as without a command
    ///
    /// Checks the plan and writes one static executable, or prints an intermediate form of the plan.
    Build(Build),
    /// Build the executable of a plan and run it
    ///
    /// `mdlec` becomes the executable: its exit status and its signals are those of the run. The executable stays where
    /// `mdlec build` writes it. The file `mdle.toml` beside the plan may name `target`, `world` and, in the table
    /// `options`, options of runs, such as `speed = "max"`; those of the command line win.
    Run(RunArguments),
    /// Check plans and report their errors
    ///
    /// Reports all errors and warnings of a file in one run, each with its place and, where possible, a correction to
    /// type. Builds nothing. With `--target all`, prints a table of which robots can run which plan.
    Check(CheckArguments),
    /// Format plans in the canonical layout
    ///
    /// Rewrites each file in place and keeps every comment. A file with errors is not changed.
    Fmt(Fmt),
    /// Run a plan against a script of interrupts, without a robot
    ///
    /// A script lists, turn by turn, the time and which interrupts have fired. The output is one JSON object per turn:
    /// the running atom, its law, and the transitions.
    Trace(Trace),
    /// Analyze a plan: reachability, durations, sizes
    ///
    /// Static analysis, valid for every run: which atoms run, what can end each of them, the shortest and longest
    /// duration, and the size of the state machine. Warns of conditions that can never have an effect.
    Analyze(Analyze),
    /// Draw a plan as an SVG picture
    ///
    /// Scopes are boxes, atoms are rows, and exits are arcs. The picture suits light and dark pages.
    Draw(Draw),
    /// Convert a finite state machine into a plan
    ///
    /// Finds the plan that is equivalent to the machine, by Theorem 1 of the paper, or reports which of its conditions
    /// fail.
    Decompile(Decompile),
    /// Explain the code of a message
    ///
    /// Prints what the code means, with a wrong and a corrected example. Without a code, lists all codes.
    Explain(Explain),
    /// List the robots that plans can be compiled for
    ///
    /// Prints each robot with its capabilities, such as `sonar[16]` or `bumper`.
    Targets,
    /// List the laws, interrupts and signals that a plan can use
    ///
    /// With `--target`, lists those of one robot, and which capability it lacks for the others.
    Quarks(QuarksArguments),
    /// Generate the Rust bindings of a target's alphabet
    ///
    /// Writes `src/alphabet.rs` beside `alphabet.mdle`. The target's crate compiles only if it implements the alphabet.
    Bind(Bind),
    /// Create the folder of a robot of your own
    ///
    /// The new target runs at once, with imaginary hardware; `src/hardware.rs` marks every place for your driver.
    NewTarget(NewTarget),
    /// Build the emulator of a robot and run it
    ///
    /// Opens a pseudo-terminal, speaks the protocol of the robot on it, and moves a simulated body in a world. `mdlec`
    /// becomes the emulator, which runs until a signal comes.
    Emulator(EmulatorArguments),
    /// Check and complete plans in an editor (Language Server Protocol)
    ///
    /// Speaks the Language Server Protocol on standard input and output; the editor starts and ends the process. The
    /// page "Editors" of the book has the lines for VS Code, Neovim, Helix, Zed and Emacs.
    Lsp,
    /// Debug plans in an editor (Debug Adapter Protocol)
    ///
    /// Speaks the Debug Adapter Protocol on standard input and output; the editor starts and ends the process. Runs a
    /// plan with a script of interrupts, as `mdlec trace` does, forwards and backwards.
    Dap,
    /// Remove everything that mdlec keeps in its cache
    ///
    /// Compiled libraries, unpacked sources and the packages of plans: the next build makes them again. The cache is
    /// the folder `MDLEC_CACHE`, or `mdlec` in the user's cache folder; a folder that contains anything else is
    /// refused.
    Clean,
    /// Print a script that completes the commands and options of mdlec in a shell
    ///
    /// For bash: `mdlec completions bash > ~/.local/share/bash-completion/completions/mdlec`.
    Completions(Completions),
    /// Print the manual page of mdlec or of a command
    ///
    /// The format is roff: `mdlec man > mdlec.1`, then `man ./mdlec.1`.
    Man(Man),
}

/// Arguments of `mdlec` without a command.
#[derive(Debug, Args)]
pub(super) struct Bare {
    #[command(flatten)]
    pub(super) build: Build,
    /// Run the executable after building it, with the arguments after `--`
    #[arg(long)]
    pub(super) run: bool,
    /// Arguments for the executable, with `--run`; `-- --help` lists them
    #[arg(last = true, requires = "run")]
    pub(super) args: Vec<String>,
}

/// Arguments of `mdlec run`.
#[derive(Debug, Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    pub(super) executable: ExecutableArguments,
    /// Arguments for the executable; `-- --help` lists them
    #[arg(last = true)]
    pub(super) args: Vec<String>,
}

/// Arguments of `mdlec build`.
#[derive(Debug, Args)]
pub(super) struct Build {
    #[command(flatten)]
    pub(super) executable: ExecutableArguments,
    /// Intermediate form to print instead of building
    ///
    /// One of tree, plan, nondegenerate, expanded, fsm, matrices, dot, mermaid, scxml, formal, rust and exe. Without
    /// `=FILE` it goes to standard output; `matrices=FOLDER` writes MatrixMarket files into a folder.
    #[arg(long, value_name = "KIND[=FILE]", value_parser = Emit::parse)]
    pub(super) emit: Option<Emit>,
    /// Merge the matrices of equal interrupts, with `--emit matrices`
    #[arg(long)]
    pub(super) combine: bool,
    /// Machine to build for: aarch64, armv7, x86_64, or a target triple of Rust [default: this one]
    ///
    /// The short names stand for static executables for Linux with the C library musl, which need no C compiler for
    /// it. Rust's library for the machine comes with `rustup target add TRIPLE`.
    #[arg(long, value_name = "NAME|TRIPLE")]
    pub(super) machine: Option<String>,
}

/// The plan that an executable is built of, and for which robot.
#[derive(Debug, Args)]
pub(super) struct ExecutableArguments {
    /// File of the plan, or of a scenario (FILE.toml); `-` for standard input
    #[arg(required = true)]
    pub(super) plan: Option<PathBuf>,
    /// Robot to compile for: a name from `mdlec targets`, or a folder
    ///
    /// A folder holds a target of your own: an `alphabet.mdle` and a crate. `mdlec new-target` creates one. Without the
    /// option, the `target` of an `mdle.toml` beside the plan.
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(super) target: Option<String>,
    /// Executable to write [default: the plan's file name without its extension, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Name of the plan to build [default: the only plan that no other plan uses]
    #[arg(long = "plan", value_name = "NAME")]
    pub(super) name: Option<String>,
    /// Build an executable that contains the Modular Engine, for a plan that reads modules or other robots
    ///
    /// The executable contains the text of its plan and takes the options of `mdle run`, such as `--link FILE`.
    #[arg(long)]
    pub(super) engine: bool,
    /// Treat warnings as errors
    #[arg(long)]
    pub(super) deny_warnings: bool,
}

/// Arguments of `mdlec check`.
#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// Files of the plans and scenarios
    #[arg(required = true)]
    pub(super) plans: Vec<PathBuf>,
    /// Robot to check for, or `all` for a table of all robots [default: that of mdle.toml, or one with every
    /// capability]
    #[arg(long, value_name = "NAME|FOLDER|all")]
    pub(super) target: Option<String>,
    /// Treat warnings as errors
    #[arg(long)]
    pub(super) deny_warnings: bool,
}

/// Arguments of `mdlec fmt`.
#[derive(Debug, Args)]
pub(super) struct Fmt {
    /// Files of the plans; `-` reads standard input and prints to standard output
    #[arg(required = true)]
    pub(super) plans: Vec<PathBuf>,
    /// List the files that would change, and change none; exit status 1 if there are any
    #[arg(long)]
    pub(super) check: bool,
}

/// Arguments of `mdlec trace`.
#[derive(Debug, Args)]
pub(super) struct Trace {
    /// File of the plan
    pub(super) plan: PathBuf,
    /// Script, one JSON object per turn; `-` for standard input
    ///
    /// An object holds the time `t` in seconds, and the lists `fired` and `completed`, as in
    /// `{"t": 0.1, "fired": ["bumper"]}`.
    #[arg(long, value_name = "FILE")]
    pub(super) script: PathBuf,
    /// State machine to use; all print the same trace
    #[arg(long, value_enum, default_value_t = TraceMachine::Counted)]
    pub(super) machine: TraceMachine,
    /// Name of the plan to run [default: the only plan that no other plan uses]
    #[arg(long = "plan", value_name = "NAME")]
    pub(super) name: Option<String>,
    /// Robot to check the plan for [default: that of mdle.toml, or one with every capability]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(super) target: Option<String>,
}

/// Arguments of `mdlec draw`.
#[derive(Debug, Args)]
pub(super) struct Draw {
    /// File of the plan; `-` for standard input
    pub(super) plan: PathBuf,
    /// SVG file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Name of the plan to draw [default: the only plan that no other plan uses]
    #[arg(long = "plan", value_name = "NAME")]
    pub(super) name: Option<String>,
    /// Robot to check the plan for [default: that of mdle.toml, or one with every capability]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(super) target: Option<String>,
}

/// The machines of `mdlec trace`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum TraceMachine {
    /// Walk over the tree of the plan
    Tree,
    /// State machine with unrolled loops, as a table
    Table,
    /// Product of the transition matrices
    Matrix,
    /// Machine that robots run, with loop counters
    Counted,
}

/// Arguments of `mdlec analyze`.
#[derive(Debug, Args)]
pub(super) struct Analyze {
    /// File of the plan; `-` for standard input
    pub(super) plan: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
    /// Name of the plan to analyze [default: the only plan that no other plan uses]
    #[arg(long = "plan", value_name = "NAME")]
    pub(super) name: Option<String>,
    /// Robot to check the plan for [default: that of mdle.toml, or one with every capability]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(super) target: Option<String>,
    /// Treat warnings as errors
    #[arg(long)]
    pub(super) deny_warnings: bool,
}

/// Arguments of `mdlec decompile`.
#[derive(Debug, Args)]
pub(super) struct Decompile {
    /// JSON file of the machine, as `--emit fsm` writes it; `-` for standard input
    #[arg(value_name = "FSM.json")]
    pub(super) machine: PathBuf,
    /// Accept any state machine: write it as one loop over its states, using `after`
    #[arg(long, conflicts_with = "as_printed")]
    pub(super) augment: bool,
    /// Judge by R1 to R4 as the paper prints them, and report differences
    #[arg(long)]
    pub(super) as_printed: bool,
    /// Maximum number of search steps, for a machine with loops
    #[arg(long, value_name = "N", default_value_t = STEPS)]
    pub(super) steps: u64,
}

/// Arguments of `mdlec explain`.
#[derive(Debug, Args)]
pub(super) struct Explain {
    /// Code of a message, such as `E0201` [default: list all codes]
    pub(super) code: Option<String>,
}

/// Arguments of `mdlec quarks`.
#[derive(Debug, Args)]
pub(super) struct QuarksArguments {
    /// Robot whose laws, interrupts and signals to list [default: a robot with every capability]
    #[arg(long, value_name = "NAME|FOLDER")]
    pub(super) target: Option<String>,
}

/// Arguments of `mdlec bind`.
#[derive(Debug, Args)]
pub(super) struct Bind {
    /// Alphabet of the target, `alphabet.mdle`; `src/alphabet.rs` is written beside it
    pub(super) alphabet: PathBuf,
    /// Compare instead of writing; exit status 1 if the bindings are out of date
    #[arg(long)]
    pub(super) check: bool,
}

/// Arguments of `mdlec new-target`.
#[derive(Debug, Args)]
pub(super) struct NewTarget {
    /// Name of the robot and of its folder, which is created in the current folder
    pub(super) name: String,
}

/// Arguments of `mdlec emulator`.
#[derive(Debug, Args)]
pub(super) struct EmulatorArguments {
    /// Robot to emulate
    #[arg(value_parser = PossibleValuesParser::new(link::emulators()))]
    pub(super) robot: String,
    /// Arguments for the emulator; `-- --help` lists them
    #[arg(last = true)]
    pub(super) args: Vec<String>,
}

/// Arguments of `mdlec completions`.
#[derive(Debug, Args)]
pub(super) struct Completions {
    /// Shell to write the script for
    pub(super) shell: Shell,
}

/// Arguments of `mdlec man`.
#[derive(Debug, Args)]
pub(super) struct Man {
    /// Command to describe [default: mdlec itself]
    pub(super) command: Option<String>,
}
