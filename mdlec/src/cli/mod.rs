//! The command line: what `mdlec` takes and which room does it; exit statuses as the interfaces say.

mod analyze;
mod bind;
mod build;
mod check;
mod decompile;
mod draw;
mod embed;
mod everywhere;
mod explain;
mod fmt;
mod input;
mod matrices;
mod new_target;
mod report;
mod trace;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};
pub(crate) use embed::embed;

use crate::theorem::STEPS;

/// Compiles plans in MDLe, the Motion Description Language, for robots.
#[derive(Debug, Parser)]
#[command(name = "mdlec", version, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(
    after_help = "Exit status: 0 done, 1 the plan has errors or a machine has no plan, 2 wrong usage, a target that does not compile, or a \
                        file that cannot be read or written, 101 a bug in mdlec, 128 and its number more when a signal \
                        ended it. With --run, that of the executable."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    build: Build,
    /// How messages are written: for people, or as JSON, one object a line
    #[arg(long, value_enum, global = true, default_value_t = MessageFormat::Human, value_name = "FORMAT")]
    message_format: MessageFormat,
}

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MessageFormat {
    /// For people
    Human,
    /// One JSON object a line: code, severity, message, spans, help
    Json,
    /// As cargo takes it from a build script: warnings for cargo to show, errors for people
    #[value(skip)]
    BuildScript,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Says what is wrong with plans, and builds nothing
    Check(Check),
    /// Puts plans into the one canonical layout; comments stay
    Fmt(Fmt),
    /// Runs a plan against a script of interrupts, no robot needed
    Trace(Trace),
    /// Says what is so of every run of a plan: which atoms run, what can end them, how long it takes, how large it is
    Analyze(Analyze),
    /// Draws a plan as a picture (SVG): scopes as boxes, atoms in rows, exits as arcs
    Draw(Draw),
    /// Finds the plan of a finite state machine, or says why there is none (Theorem 1)
    Decompile(Decompile),
    /// Explains the code of a message, with a wrong and a right example
    Explain(Explain),
    /// Lists the robots that plans can be compiled for
    Targets,
    /// Lists the laws and interrupts that a plan can use
    Quarks(Quarks),
    /// Writes a target's `src/alphabet.rs`, which holds its crate to its alphabet
    Bind(Bind),
    /// Writes the folder of a robot of your own: a target that runs, with one place for your driver
    NewTarget(NewTarget),
}

/// Builds the executable of a plan.
#[derive(Debug, Args)]
struct Build {
    /// The plan; `-` reads standard input
    #[arg(required = true)]
    plan: Option<PathBuf>,
    /// The robot: one of `mdlec targets`, or the folder of a target of your own
    #[arg(long, value_name = "NAME|FOLDER")]
    target: Option<String>,
    /// The executable to write [default: the plan's file name without its ending, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Which plan of the file [default: the one that no other refers to]
    #[arg(long = "plan", value_name = "NAME")]
    name: Option<String>,
    /// Print a stage instead of building, to standard output or to a file; matrices also into a folder
    #[arg(long, value_name = "KIND[=FILE]", value_parser = Emit::parse)]
    emit: Option<Emit>,
    /// With `--emit matrices`: one matrix for all places of an interrupt
    #[arg(long)]
    combine: bool,
    /// Treat warnings as errors
    #[arg(long)]
    deny_warnings: bool,
    /// Run the executable when it is built, with the arguments behind `--`
    #[arg(long)]
    run: bool,
    /// Arguments for the executable, with `--run`
    #[arg(last = true, requires = "run")]
    args: Vec<String>,
}

/// A stage to print, and where to.
#[derive(Debug, Clone)]
struct Emit {
    kind: EmitKind,
    file: Option<PathBuf>,
}

/// What `--emit` makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EmitKind {
    /// The tree of the text, as it is written
    Tree,
    /// The plan with every name resolved
    Plan,
    /// The plan without repeated interrupts
    Nondegenerate,
    /// The plan with its finite loops written out and its atoms numbered
    Expanded,
    /// The finite state machine, as JSON
    Fsm,
    /// The transition matrices: in the paper's notation, or as MatrixMarket files into a folder
    Matrices,
    /// A picture for Graphviz
    Dot,
    /// A picture for mermaid, a `stateDiagram-v2`
    Mermaid,
    /// A machine in W3C SCXML that does what the plan does, a state for each atom of the expanded plan
    Scxml,
    /// The plan in the paper's formal notation
    Formal,
    /// The Rust that is compiled
    Rust,
    /// The executable
    Exe,
}

impl Emit {
    fn parse(text: &str) -> Result<Self, String> {
        let (kind, file) = match text.split_once('=') {
            Some((_, "")) => return Err("name a file behind `=`, or leave it out".into()),
            Some((kind, "-")) => (kind, None),
            Some((kind, file)) => (kind, Some(PathBuf::from(file))),
            None => (text, None),
        };
        let kinds: Vec<_> = EmitKind::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
        let names: Vec<_> = kinds.iter().map(|kind| kind.get_name().to_owned()).collect();
        let kind = EmitKind::from_str(kind, false).map_err(|_| format!("the kinds are {}", names.join(", ")))?;
        Ok(Self { kind, file })
    }
}

#[derive(Debug, Args)]
struct Check {
    /// The plans
    #[arg(required = true)]
    plans: Vec<PathBuf>,
    /// The robot, or `all` for a table of which robots can run which plan [default: one that has everything]
    #[arg(long, value_name = "NAME|FOLDER|all")]
    target: Option<String>,
    /// Treat warnings as errors
    #[arg(long)]
    deny_warnings: bool,
}

#[derive(Debug, Args)]
struct Fmt {
    /// The plans; `-` reads standard input and prints to standard output
    #[arg(required = true)]
    plans: Vec<PathBuf>,
    /// Write nothing and list the plans that are laid out differently; exit status 1 if there are any
    #[arg(long)]
    check: bool,
}

#[derive(Debug, Args)]
struct Trace {
    /// The plan
    plan: PathBuf,
    /// The script: JSON lines, one object a turn; `-` reads standard input
    #[arg(long, value_name = "FILE")]
    script: PathBuf,
    /// Which of the equivalent machines runs the plan
    #[arg(long, value_enum, default_value_t = Machine::Counted)]
    machine: Machine,
    /// Which plan of the file [default: the one that no other refers to]
    #[arg(long = "plan", value_name = "NAME")]
    name: Option<String>,
    /// The robot [default: one that has everything]
    #[arg(long, value_name = "NAME|FOLDER")]
    target: Option<String>,
}

#[derive(Debug, Args)]
struct Draw {
    /// The plan; `-` reads standard input
    plan: PathBuf,
    /// The picture to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Which plan of the file [default: the one that no other refers to]
    #[arg(long = "plan", value_name = "NAME")]
    name: Option<String>,
    /// The robot [default: one that has everything]
    #[arg(long, value_name = "NAME|FOLDER")]
    target: Option<String>,
}

/// The machines of `mdlec trace`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Machine {
    /// A direct walk over the plan as it is written
    Tree,
    /// The finite state machine, loops written out, as a table
    Table,
    /// The product of the finite state machine's transition matrices
    Matrix,
    /// The machine that robots run: brackets and counters
    Counted,
}

#[derive(Debug, Args)]
struct Analyze {
    /// The plan; `-` reads standard input
    plan: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Which plan of the file [default: the one that no other refers to]
    #[arg(long = "plan", value_name = "NAME")]
    name: Option<String>,
    /// The robot [default: one that has everything]
    #[arg(long, value_name = "NAME|FOLDER")]
    target: Option<String>,
    /// Treat warnings as errors
    #[arg(long)]
    deny_warnings: bool,
}

#[derive(Debug, Args)]
struct Decompile {
    /// The machine: an FSM file, as `--emit fsm` writes it; `-` reads standard input
    #[arg(value_name = "FSM.json")]
    machine: PathBuf,
    /// Makes a plan of any machine, with `after`: one loop over all states
    #[arg(long, conflicts_with = "as_printed")]
    augment: bool,
    /// Judges by R1 to R4 as the paper prints them, and says where they differ from the exact conditions
    #[arg(long)]
    as_printed: bool,
    /// Stops the search for an order of the states, which a machine with loops needs, after this many steps
    #[arg(long, value_name = "N", default_value_t = STEPS)]
    steps: u64,
}

#[derive(Debug, Args)]
struct Explain {
    /// The code, such as `E0201` [default: all codes are listed]
    code: Option<String>,
}

#[derive(Debug, Args)]
struct Quarks {
    /// The robot [default: one that has everything]
    #[arg(long, value_name = "NAME|FOLDER")]
    target: Option<String>,
}

#[derive(Debug, Args)]
struct Bind {
    /// The target's `alphabet.mdle`; `src/alphabet.rs` is beside it
    alphabet: PathBuf,
    /// Write nothing; exit status 1 if the file is not up to date
    #[arg(long)]
    check: bool,
}

#[derive(Debug, Args)]
struct NewTarget {
    /// The robot's name, and the folder's, which is made here
    name: String,
}

/// Why a command ends without having done what it was asked: what to say, and the exit status.
#[derive(Debug)]
struct Failure {
    status: u8,
    /// Nothing where it was said already.
    message: Option<String>,
}

impl Failure {
    /// Wrong usage, or a file that cannot be read or written: exit status 2.
    fn usage(message: impl Into<String>) -> Self {
        Self { status: 2, message: Some(message.into()) }
    }

    /// The plan has errors, and they were printed: exit status 1.
    const PLAN: Self = Self { status: 1, message: None };

    /// Says what there is to say; the exit status.
    fn told(&self) -> u8 {
        if let Some(message) = &self.message {
            report::error(message);
        }
        self.status
    }
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    let done = match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(answer) => report::answer(&answer),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(failure.told()),
    }
}

/// Does what the command line asks for.
fn run(cli: Cli) -> Result<(), Failure> {
    report::choose(cli.message_format);
    match cli.command {
        None => build::build(&cli.build),
        Some(Command::Check(check)) => check::check(&check),
        Some(Command::Fmt(fmt)) => fmt::fmt(&fmt),
        Some(Command::Trace(trace)) => trace::trace(&trace),
        Some(Command::Analyze(analyze)) => analyze::analyze(&analyze),
        Some(Command::Draw(draw)) => draw::draw(&draw),
        Some(Command::Decompile(decompile)) => decompile::decompile(&decompile),
        Some(Command::Explain(explain)) => explain::explain(explain.code.as_deref()),
        Some(Command::Targets) => input::print_targets(),
        Some(Command::Bind(bind)) => bind::bind(&bind),
        Some(Command::NewTarget(new_target)) => new_target::new_target(&new_target),
        Some(Command::Quarks(quarks)) => input::print_quarks(quarks.target.as_deref()),
    }
}
