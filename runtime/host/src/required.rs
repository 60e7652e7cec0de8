//! The option `--require`, which names the causes by which a plan must end.

use clap::{Arg, ArgAction, ArgMatches, Command};
use mdle_runtime::Fsm;
use mdle_runtime::fsm::Kind;
use mdle_runtime::trace::COMPLETED;

use crate::operand_text::{is_condition, is_operand};
use crate::passes::outwards;
use crate::position::Texts;
use crate::report::Over;

/// Minimum similarity, from 0 to 1, of a name that a message proposes.
const SIMILAR: f64 = 0.75;

/// Causes that the options `--require` name; empty if the plan may end by any cause.
#[derive(Debug, Default)]
pub(crate) struct Required {
    /// Required causes as typed on the command line.
    texts: Vec<String>,
    causes: Vec<RequiredCause>,
}

/// A cause of a plan's end.
#[derive(Debug, PartialEq, Eq)]
enum RequiredCause {
    /// The law of the last atom completed.
    Completed,
    /// The interrupt of this bracket fired.
    Scope(u32),
    /// An operand of a bracket's interrupt fired. Contains the number of the bracket and the number of the operand.
    Operand(u32, u32),
}

/// Adds the option `--require` to `command`.
pub(crate) fn argument(command: Command) -> Command {
    command.arg(
        Arg::new("require")
            .long("require")
            .value_name("CAUSE")
            .action(ArgAction::Append)
            .help("Cause by which the plan must end, such as `bumper`; exit status 5 otherwise")
            .long_help(
                "Cause by which the plan must end; exit status 5 if it ends otherwise. A part of an interrupt that AND and OR \
                 join, such as `bumper` or `r0 < 60cm`; the name of a scope, whose interrupt must fire; or `completed`. \
                 With several of these options, one of the causes is enough",
            ),
    )
}

impl Required {
    /// Reads the required causes, and checks that `plan` can end by each of them.
    ///
    /// # Errors
    /// Returns a message with a text to type instead if the plan cannot end by a cause.
    pub(crate) fn of(matches: &ArgMatches, plan: &dyn Texts) -> Result<Self, String> {
        let texts: Vec<String> = matches.get_many("require").into_iter().flatten().cloned().collect();
        let mut causes = Vec::new();
        for text in &texts {
            let of_text: Vec<RequiredCause> =
                endings(plan, text.trim(), |scope| ends_plan(plan.fsm(), scope)).collect();
            if of_text.is_empty() {
                return Err(refused(plan, text));
            }
            causes.extend(of_text);
        }
        Ok(Self { texts, causes })
    }

    /// Returns `true` if the end `over` of a plan has a required cause.
    pub(crate) fn allows(&self, over: &Over) -> bool {
        let is_cause = |cause: &RequiredCause| match cause {
            RequiredCause::Completed => over.by == COMPLETED,
            RequiredCause::Scope(scope) => over.by != COMPLETED && over.bracket == *scope,
            RequiredCause::Operand(scope, number) => {
                over.by != COMPLETED && over.bracket == *scope && over.numbers.contains(number)
            }
        };
        self.causes.is_empty() || self.causes.iter().any(is_cause)
    }

    /// Returns the causes as typed, such as `bumper` or `completed`.
    pub(crate) fn words(&self) -> String {
        self.texts.iter().map(|text| format!("`{text}`")).collect::<Vec<_>>().join(" or ")
    }
}

/// Returns the causes that have the name or the condition `text`. Only scopes for which `may` returns `true` are taken
/// into account.
fn endings(plan: &dyn Texts, text: &str, may: impl Fn(u32) -> bool) -> impl Iterator<Item = RequiredCause> {
    let completed = (text == COMPLETED).then_some(RequiredCause::Completed);
    let scopes = scopes(plan.fsm()).filter(|scope| may(*scope)).flat_map(|scope| {
        let named = (!text.is_empty() && plan.name(scope) == text).then_some(RequiredCause::Scope(scope));
        let operands: Vec<_> = plan.source().operands_of(scope).collect();
        // A plan that was written in Rust has conditions but no operands.
        let whole =
            (operands.is_empty() && is_condition(text, plan.condition(scope))).then_some(RequiredCause::Scope(scope));
        let parts = (0..).zip(operands).filter(|(_, operand)| is_operand(text, operand));
        let parts: Vec<RequiredCause> = parts.map(|(number, _)| RequiredCause::Operand(scope, number)).collect();
        named.into_iter().chain(whole).chain(parts)
    });
    completed.into_iter().chain(scopes).collect::<Vec<_>>().into_iter()
}

/// Returns the brackets of scopes, in order.
pub(crate) fn scopes(fsm: Fsm<'_>) -> impl Iterator<Item = u32> {
    let is_scope = |kind| match kind {
        Kind::Scope { .. } => true,
        Kind::Loop { .. } => false,
    };
    (0..).zip(fsm.brackets).filter(move |(_, bracket)| is_scope(bracket.kind)).map(|(number, _)| number)
}

/// Returns `true` if nothing follows when a scope ends, at least in the last pass of its enclosing loops.
fn ends_plan(fsm: Fsm<'_>, scope: u32) -> bool {
    let last = fsm.brackets.first().map(|plan| plan.last);
    outwards(fsm, scope).all(|(_, around)| {
        let is_endless = match around.kind {
            Kind::Loop { times, .. } => times == 0,
            Kind::Scope { .. } => false,
        };
        Some(around.last) == last && !is_endless
    })
}

/// Returns the error message for `--require text` if the plan cannot end by the cause `text`. The message lists the
/// causes by which the plan can end.
fn refused(plan: &dyn Texts, text: &str) -> String {
    let source = plan.source();
    let mut known: Vec<String> = Vec::new();
    for scope in scopes(plan.fsm()).filter(|scope| ends_plan(plan.fsm(), *scope)) {
        let operands: Vec<_> = source.operands_of(scope).collect();
        let whole = operands.is_empty().then(|| plan.condition(scope));
        let parts = operands.iter().map(|operand| operand.written);
        for word in parts.chain(whole).chain([plan.name(scope)]) {
            if !word.is_empty() && word != "null" && !known.iter().any(|known| known == word) {
                known.push(word.to_owned());
            }
        }
    }
    known.push(COMPLETED.to_owned());
    let why = if endings(plan, text.trim(), |_| true).next().is_some() {
        "that ends a part of the plan, and more follows"
    } else {
        "the plan has no such cause"
    };
    let likeness = |known: &String| strsim::jaro_winkler(&known.to_lowercase(), &text.to_lowercase());
    let nearest = known.iter().max_by(|one, other| likeness(one).total_cmp(&likeness(other)));
    let meant = nearest.filter(|known| likeness(known) > SIMILAR).map(|known| format!("; did you mean `{known}`?"));
    let all: Vec<String> = known.iter().map(|known| format!("`{known}`")).collect();
    format!("--require '{text}': {why}; it can end by {}{}", all.join(", "), meant.unwrap_or_default())
}
