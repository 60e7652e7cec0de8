//! Loads a plan at run time, without rustc. The robot's bound alphabet creates the quarks in the table rows from their
//! names.

mod entries;
mod loaded_plan;
mod moments;
mod names;
mod quarks;
mod table;

use std::error::Error;
use std::fmt;

use mdle_runtime::{Guard, LawRow, Meeting, PEERS, PUBLISHED};

use crate::alphabet;
use crate::diagnostic::Sources;
use crate::fsm::{self, Machine, PlanWords, Rows};
pub use entries::Entered;
pub use loaded_plan::LoadedPlan;
pub use moments::{PlanMoment, ScopeMoment};
pub use names::{MOST_NAMES, NameBudget};
use quarks::QuarkMaker;
pub use table::{Loaded, SharedTables};

/// Reason why a plan cannot be loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LoadError {
    /// The target with this name was built with an alphabet other than the one for which the plan was compiled.
    OtherAlphabet(String),
    /// The target does not implement the quark with this text, although its alphabet declares the quark.
    Unbound(String),
    /// With this plan, the total length of all names in plans that this process has loaded would exceed [`MOST_NAMES`]
    /// bytes.
    TooManyNames,
    /// The plan's new names need more bytes than its [`NameBudget`] has left.
    OverBudget,
    /// The plan reads more than [`PUBLISHED`] module attributes; contains their number.
    TooManyReads(usize),
    /// The plan names more than [`PEERS`] other robots; contains their number.
    TooManyRobots(usize),
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherAlphabet(name) => {
                write!(f, "the crate of target `{name}` is bound to another alphabet: run `mdlec bind`")
            }
            Self::Unbound(text) => write!(f, "the crate of the target makes no quark `{text}`: run `mdlec bind`"),
            Self::TooManyNames => write!(
                f,
                "the plans of this program have more than {} kB of names of files and modules, which is the most",
                MOST_NAMES / 1000
            ),
            Self::OverBudget => f.write_str("too many new names of modules in the plans that were sent so far"),
            Self::TooManyRobots(count) => {
                write!(f, "the plan names {count} other robots, and {PEERS} is the most")
            }
            Self::TooManyReads(count) => {
                write!(f, "the plan reads {count} attributes of modules, and {PUBLISHED} is the most")
            }
        }
    }
}

impl Error for LoadError {}

/// Loads a compiled plan for the robot type that is bound to the alphabet `A`; `alphabet` is the alphabet for which the
/// plan was compiled.
///
/// # Errors
/// Fails if `A` differs from `alphabet`; if the robot's crate lacks a quark of the plan; if the names in all plans that
/// this process has loaded would become too long; or if the plan reads too many attributes or names too many robots.
pub fn load<A: mdle_runtime::Alphabet>(
    machine: &Machine,
    sources: &Sources,
    alphabet: &alphabet::Alphabet,
) -> Result<Loaded<A>, LoadError> {
    load_within(machine, sources, alphabet, &NameBudget::new(usize::MAX))
}

/// Loads the plan of a machine as [`load`] does; the new names of the plan are charged to `budget`.
///
/// # Errors
/// Fails as [`load`] does, and if the new names exceed the budget.
pub fn load_within<A: mdle_runtime::Alphabet>(
    machine: &Machine,
    sources: &Sources,
    alphabet: &alphabet::Alphabet,
    budget: &NameBudget,
) -> Result<Loaded<A>, LoadError> {
    if alphabet.hash() != A::HASH {
        return Err(LoadError::OtherAlphabet(A::NAME.to_owned()));
    }
    assemble(fsm::rows(machine), fsm::words(machine, sources, alphabet), machine, (alphabet, budget))
}

/// Loads the plan of a machine from its rows and words, without checking that the robot's crate is bound to `alphabet`.
///
/// # Errors
/// Fails if the robot's crate lacks a quark, or if the names, attributes or robots are too many, as [`load`] does.
pub fn with_rows<A: mdle_runtime::Alphabet>(
    rows: Rows,
    words: PlanWords,
    machine: &Machine,
    alphabet: &alphabet::Alphabet,
) -> Result<Loaded<A>, LoadError> {
    assemble(rows, words, machine, (alphabet, &NameBudget::new(usize::MAX)))
}

/// Assembles a plan from its rows and words, and creates its quarks.
fn assemble<A: mdle_runtime::Alphabet>(
    rows: Rows,
    words: PlanWords,
    machine: &Machine,
    (alphabet, budget): (&alphabet::Alphabet, &NameBudget),
) -> Result<Loaded<A>, LoadError> {
    let quarks = QuarkMaker { machine, alphabet, budget };
    let interned = |name| names::interned(name, budget);
    let Rows { guards, operands, laws, marks, facts } = rows;
    let guards = guards.into_iter().map(|Guard { condition, level, around, follows }| {
        Ok(Guard { condition: quarks.condition::<A>(condition)?, level, around, follows })
    });
    let operands = operands.into_iter().map(|operand| quarks.condition::<A>(operand));
    let laws = laws
        .into_iter()
        .map(|LawRow { control, frame }| Ok(LawRow { control: quarks.by_name(control, A::control)?, frame }));
    let paths = fsm::replayed_files(machine, alphabet).into_iter().map(interned);
    let (guards, operands, laws) =
        (guards.collect::<Result<_, _>>()?, operands.collect::<Result<_, _>>()?, laws.collect::<Result<_, _>>()?);
    let reads = names::reads(fsm::module_reads(machine, alphabet), budget)?;
    let robots = fsm::other_robots(machine).into_iter().map(interned).collect::<Result<Vec<_>, _>>()?;
    if robots.len() > PEERS {
        return Err(LoadError::TooManyRobots(robots.len()));
    }
    let meetings = fsm::meetings(machine)
        .into_iter()
        .map(|fsm::Rendezvous { element, robot }| interned(robot).map(|robot| Meeting { scope: element, robot }));
    let (paths, meetings) = (paths.collect::<Result<_, _>>()?, meetings.collect::<Result<_, _>>()?);
    let owned = table::Owned { guards, operands, laws, marks, facts, words, paths, reads, robots, meetings };
    Ok(Loaded::new(machine, owned))
}
