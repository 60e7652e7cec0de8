//! The expectations of a test, resolved against its plan.

use std::ops::Range;
use std::time::Duration;

use mdle_host::Quantity;
use mdle_runtime::Nanos;
use mdle_runtime::trace::Seconds;
use mdle_sim::Goal;

use super::causes::{NamedCause, cause, ending};
use super::file::{At, ExpectText, TestFileError, TransitionText};
use super::subject::{Subject, TestCondition};

/// Maximum time in a test.
const LONGEST: Duration = Duration::from_secs(1_000_000_000);
/// Maximum distance in a test, in metres.
const FURTHEST: f64 = 1000.0;

/// Byte range of an expectation in the test file.
pub(super) type ByteRange = Range<usize>;

/// The expectations of a test.
pub(super) struct Expected {
    pub(super) atoms: Option<(ByteRange, Vec<AtomsNamed>)>,
    pub(super) order: Option<(ByteRange, Vec<AtomsNamed>)>,
    pub(super) transitions: Vec<(ByteRange, ExpectedTransition)>,
    pub(super) never: Vec<(ByteRange, ForbiddenState)>,
    pub(super) end: Option<(ByteRange, ExpectedEnd)>,
    pub(super) pose: Option<(ByteRange, String, Goal)>,
    pub(super) most_turns: Option<(ByteRange, u64)>,
    pub(super) most_transitions: Option<(ByteRange, u64)>,
    pub(super) most_time: Option<(ByteRange, Nanos)>,
}

/// Atoms that a text names.
#[derive(Clone)]
pub(super) struct AtomsNamed {
    pub(super) place: ByteRange,
    pub(super) text: String,
    /// For each atom, `true` if it is named.
    atoms: Vec<bool>,
}

/// An expected transition.
#[derive(Clone)]
pub(super) struct ExpectedTransition {
    pub(super) from: Option<AtomsNamed>,
    /// The atoms of which one must be entered. `Some(None)` means the end of the plan; `None` means any atom or the end
    /// of the plan.
    pub(super) to: Option<Option<AtomsNamed>>,
    pub(super) by: Option<(String, NamedCause)>,
    pub(super) after: Option<Nanos>,
    pub(super) within: Option<Nanos>,
}

/// A state that must not occur.
pub(super) enum ForbiddenState {
    /// The robot is closer to an obstacle than this distance, in metres.
    Closer(f64),
    /// One of `atoms` runs while `condition` is true. Without `atoms`, any atom counts; without `condition`, the state
    /// is forbidden whenever one of `atoms` runs.
    While { words: String, atoms: Option<AtomsNamed>, condition: Option<Box<TestCondition>> },
}

/// The expected end of a run.
pub(super) enum ExpectedEnd {
    /// The plan is over by this cause.
    By(String, NamedCause),
    /// The plan is still running when the run ends.
    Running,
    /// A fault ends the run.
    Failed,
}

impl ExpectedTransition {
    /// Returns the transition in words.
    pub(super) fn words(&self) -> String {
        let mut words = String::from("a transition");
        if let Some(from) = &self.from {
            words += &format!(" from `{}`", from.text);
        }
        match &self.to {
            Some(Some(to)) => words += &format!(" to `{}`", to.text),
            Some(None) => words += " to the end of the plan",
            None => {}
        }
        if let Some((by, _)) = &self.by {
            words += &format!(" by `{by}`");
        }
        if let Some(after) = self.after {
            words += &format!(" not before {} s", Seconds(after));
        }
        if let Some(within) = self.within {
            words += &format!(" within {} s", Seconds(within));
        }
        words
    }
}

impl AtomsNamed {
    /// Returns `true` if an atom is named.
    pub(super) fn holds(&self, atom: u32) -> bool {
        self.atoms.get(atom as usize).copied().unwrap_or(false)
    }
}

impl Expected {
    /// Reads the expectations of a test of the plan `subject`; `is_script` is `true` for a test without a simulated
    /// robot.
    ///
    /// # Errors
    /// Fails with a message and a place if no run can meet an expectation.
    pub(super) fn read(text: &ExpectText, subject: &Subject, is_script: bool) -> Result<Self, TestFileError> {
        let list = |list: &Option<At<Vec<At<String>>>>| {
            let list = list.as_ref().map(|list| {
                let named = list.get_ref().iter().map(|text| named(text, subject));
                Ok((list.span(), named.collect::<Result<Vec<_>, _>>()?))
            });
            list.transpose()
        };
        let number = |most: &Option<At<u64>>| most.as_ref().map(|most| (most.span(), *most.get_ref()));
        let transitions = text.transitions.iter().map(|at| Ok((at.span(), transition(at, subject)?)));
        let never = text.never.iter().map(|text| Ok((text.span(), never(text, subject, is_script)?)));
        let pose = text.pose.as_ref().map(|pose| {
            if is_script {
                let message = "`pose` needs a robot, which a script does not have";
                return Err(
                    TestFileError::at(pose.span(), message).help("leave `script` out for a run in the simulator")
                );
            }
            let goal = Goal::read(pose.get_ref());
            let goal = goal.map_err(|sentence| TestFileError::at(pose.span(), sentence.replace("`world`, or ", "")))?;
            Ok((pose.span(), pose.get_ref().clone(), goal))
        });
        let (atoms, order) = (list(&text.atoms)?, list(&text.order)?);
        if let Some(most) = text.most_turns.as_ref().filter(|most| *most.get_ref() == 0) {
            let error = TestFileError::at(most.span(), "every run has a turn");
            return Err(error.help("`most-turns` is 1 or more"));
        }
        Ok(Self {
            atoms,
            order,
            transitions: transitions.collect::<Result<_, _>>()?,
            never: never.collect::<Result<_, _>>()?,
            end: text.end.as_ref().map(|text| Ok((text.span(), end(text, subject)?))).transpose()?,
            pose: pose.transpose()?,
            most_turns: number(&text.most_turns),
            most_transitions: number(&text.most_transitions),
            most_time: text.most_time.as_ref().map(|text| Ok((text.span(), time(text)?))).transpose()?,
        })
    }
}

/// Reads a time.
pub(super) fn time(text: &At<String>) -> Result<Nanos, TestFileError> {
    let read = Quantity::duration(text.get_ref(), "s", Duration::ZERO, LONGEST);
    let read = read.map_err(|sentence| TestFileError::at(text.span(), sentence))?;
    Ok(Nanos(u64::try_from(read.as_nanos()).unwrap_or(u64::MAX)))
}

fn named(text: &At<String>, subject: &Subject) -> Result<AtomsNamed, TestFileError> {
    let atoms = subject.atoms(text.get_ref());
    let atoms = atoms.map_err(|(sentence, help)| TestFileError::at(text.span(), sentence).help(help))?;
    Ok(AtomsNamed { place: text.span(), text: text.get_ref().trim().to_owned(), atoms })
}

fn transition(at: &At<TransitionText>, subject: &Subject) -> Result<ExpectedTransition, TestFileError> {
    let text = at.get_ref();
    let TransitionText { from, to, by, after, within } = text;
    if [from, to, by, after, within].iter().all(|key| key.is_none()) {
        let error = TestFileError::at(at.span(), "a transition needs `from`, `to`, `by` or a time");
        return Err(error.help("as in `{ to = \"end\", within = \"10s\" }`"));
    }
    let from = text.from.as_ref().map(|from| named(from, subject)).transpose()?;
    let to = text.to.as_ref().map(|to| match to.get_ref().as_str() {
        "end" => Ok(None),
        _ => named(to, subject).map(Some),
    });
    let by = text.by.as_ref().map(|by| Ok((by.get_ref().clone(), cause(by, subject)?))).transpose()?;
    let (after, within) = (text.after.as_ref().map(time).transpose()?, text.within.as_ref().map(time).transpose()?);
    if let (Some(text), Some(after), Some(within)) = (&text.within, after, within)
        && within < after
    {
        let message = "nothing is both after the one time and within the other";
        return Err(TestFileError::at(text.span(), message).help("`within` has to be later than `after`"));
    }
    Ok(ExpectedTransition { from, to: to.transpose()?, by, after, within })
}

fn end(text: &At<String>, subject: &Subject) -> Result<ExpectedEnd, TestFileError> {
    Ok(match text.get_ref().trim() {
        "running" => ExpectedEnd::Running,
        "failed" => ExpectedEnd::Failed,
        words => ExpectedEnd::By(words.to_owned(), ending(text, cause(text, subject)?, subject)?),
    })
}

fn never(text: &At<String>, subject: &Subject, is_script: bool) -> Result<ForbiddenState, TestFileError> {
    let words = text.get_ref().trim();
    if let Some(distance) = words.strip_prefix("closer than ") {
        return closer(text, distance, is_script);
    }
    let condition = |words: &str| {
        let condition = subject.condition(words);
        condition.map(Box::new).map_err(|sentence| TestFileError::at(text.span(), format!("`{words}`: {sentence}")))
    };
    let atoms = |words: &str| {
        let atoms = subject.atoms(words);
        atoms.map(|atoms| AtomsNamed { place: text.span(), text: words.trim().to_owned(), atoms })
    };
    let refused = |(sentence, help): (String, String)| TestFileError::at(text.span(), sentence).help(help);
    if let Some((running, during)) = words.split_once(" while ") {
        let atoms = Some(atoms(running).map_err(refused)?);
        return Ok(ForbiddenState::While { words: words.to_owned(), atoms, condition: Some(condition(during)?) });
    }
    match atoms(words) {
        Ok(atoms) => Ok(ForbiddenState::While { words: words.to_owned(), atoms: Some(atoms), condition: None }),
        Err(no_atom) => match condition(words) {
            Ok(condition) => {
                Ok(ForbiddenState::While { words: words.to_owned(), atoms: None, condition: Some(condition) })
            }
            Err(TestFileError { message, .. }) => {
                let help = "expected an atom, a condition, `ATOM while CONDITION`, or `closer than DISTANCE`";
                Err(TestFileError::at(text.span(), format!("{}; {message}", no_atom.0)).help(help))
            }
        },
    }
}

fn closer(text: &At<String>, distance: &str, is_script: bool) -> Result<ForbiddenState, TestFileError> {
    let refused = |message: String| TestFileError::at(text.span(), message);
    if is_script {
        let error = refused("a script has no obstacles".to_owned());
        return Err(error.help("leave `script` out for a run in the simulator"));
    }
    let compact: String = distance.split_whitespace().collect();
    let gap = Quantity::Length.read(&compact, "m").map_err(refused)?;
    if gap > 0.0 && gap <= FURTHEST {
        return Ok(ForbiddenState::Closer(gap));
    }
    Err(refused(format!("`{distance}` has to be above 0 and at most {FURTHEST} m")))
}
