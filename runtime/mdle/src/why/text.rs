//! Writes explanations as text for people.

use std::fmt::Write as _;

use mdle_host::{Clocked, rounded};
use mdle_runtime::{Nanos, Twist};

use super::explanation::{AppliedAtom, AtomWords, Ended, Explanation, Replaced};
use super::operands::MeasuredOperand;
use super::scopes::{ScopeRole, ScopeState};
use super::{NextEvents, TurnAnswer};

/// Returns the text of an answer.
pub(super) fn text(answer: &TurnAnswer) -> String {
    let TurnAnswer { explanation, asked, next, safety } = answer;
    let Explanation { turn, t, replaced, ended, runs, cut, output_age, .. } = explanation;
    let mut text = format!("turn {turn} at {}", Clocked(*t));
    if asked != t {
        let _ = write!(text, ", the last one before {}", Clocked(*asked));
    }
    text += "\n";
    if *output_age > Nanos::ZERO {
        let _ = writeln!(text, "the robot's output was {} old", Clocked(*output_age));
    }
    if let Some(Replaced { atom, since, cause }) = replaced {
        let _ =
            writeln!(text, "\n{} ran for {} until another plan took over  <- {cause}", named(atom), Clocked(*since));
    }
    ended.iter().for_each(|ended| end(&mut text, ended));
    match runs {
        Some(runs) => run(&mut text, runs, *t),
        None => match cut {
            Some(why) => _ = writeln!(text, "\nno law was applied: {why}"),
            None => text += "\nthe plan is over\n",
        },
    }
    if runs.is_some() || cut.is_some() {
        sent(&mut text, explanation, safety.as_deref());
        text += "\n";
        following(&mut text, next, *t);
    }
    text
}

/// Writes a transition, and the conditions of the scopes that enclosed the atom that was left.
fn end(text: &mut String, ended: &Ended) {
    let Ended { atom, is_skipped, cause, was_done, scopes, to } = ended;
    let since = scopes.last().map_or(Nanos::ZERO, |own| own.since);
    let what = if *is_skipped { "was skipped".to_owned() } else { format!("ended after {}", Clocked(since)) };
    let _ = writeln!(text, "\n{} {what}  <- {cause}", named(atom));
    scopes.iter().for_each(|around| scope(text, around));
    if *was_done {
        *text += "    its law was done as well\n";
    }
    let next = to.as_ref().map_or_else(|| "the plan was over".to_owned(), |to| format!("{} followed", named(to)));
    let _ = writeln!(text, "  {next}");
}

/// Writes the atom that ran, and the conditions of the scopes that enclose it.
fn run(text: &mut String, runs: &AppliedAtom, t: Nanos) {
    let AppliedAtom { atom, since, paused, began, completes, scopes } = runs;
    let _ = write!(text, "\n{} ran", named(atom));
    let began = if began.is_empty() { "the start of the plan" } else { began };
    let entered = Clocked(t.since(*since).since(*paused));
    let _ = if *since == Nanos::ZERO {
        writeln!(text, " from this turn on  <- {began}")
    } else {
        let but = match *paused {
            Nanos::ZERO => String::new(),
            paused => format!(" but for {} in which another plan drove", Clocked(paused)),
        };
        writeln!(text, " for {}, since {entered}{but}  <- {began}", Clocked(*since))
    };
    scopes.iter().for_each(|around| scope(text, around));
    let _ = writeln!(text, "    law {}: {}", atom.law, if *completes { "not done yet" } else { "never done" });
}

/// Writes a scope and the operands of its condition.
pub(super) fn scope(text: &mut String, scope: &ScopeState) {
    let ScopeState { name, is_atom, line, condition, since, part, examination, .. } = scope;
    let name = name.as_deref().unwrap_or(if *is_atom { "atom" } else { "scope" });
    let _ = write!(text, "  {name} ({line}), for {}", Clocked(*since));
    let operands = &examination.operands;
    if operands.len() > 1 {
        let _ = write!(text, ": {condition}");
    }
    let _ = match part {
        ScopeRole::Ended => writeln!(text, "  -> ended"),
        ScopeRole::Completed => writeln!(text, "  -> ended: its law was done"),
        ScopeRole::Shadowed => writeln!(text, "  -> had fired as well, but an enclosing scope ended first"),
        ScopeRole::Waits => writeln!(text),
        ScopeRole::NoInterrupt => writeln!(text, ": no interrupt"),
        ScopeRole::Removed => {
            writeln!(text, ": {condition}, removed, because an enclosing scope has the same interrupt")
        }
    };
    if *part == ScopeRole::Removed {
        return;
    }
    let fired = operands.iter().filter(|operand| operand.fired).count();
    let is_any = operands.iter().all(|operand| operand.suffices);
    let marks = operands.len() > 1 && (examination.fired || !is_any);
    operands.iter().for_each(|shown| operand(text, shown, 4, marks));
    if *part == ScopeRole::Ended && fired > 1 && !operands.iter().any(|operand| operand.decided) {
        *text += "    none of them decided alone\n";
    }
    if !examination.missing.is_empty() && !is_any {
        let _ = writeln!(text, "    missing: {}", examination.missing);
    }
}

/// Writes an operand; marks the deciding operand if `marks` is `true`.
fn operand(text: &mut String, operand: &MeasuredOperand, indent: usize, marks: bool) {
    let MeasuredOperand { words, fired, decided, suffices, lack, stale, inside, .. } = operand;
    let _ = write!(text, "{:indent$}{}  {words}", "", if *fired { "yes" } else { "no " });
    if !lack.is_empty() {
        let _ = write!(text, ": {lack}");
    }
    stale.iter().for_each(|remark| *text += &format!(" [{remark}]"));
    if marks && *decided {
        *text += "  <- decided alone";
    } else if marks && *suffices {
        *text += "  <- alone missing";
    }
    *text += "\n";
    inside.iter().for_each(|part| self::operand(text, part, indent + 5, false));
}

/// Writes the input that was sent, if it differs from the input that the plan requested.
fn sent(text: &mut String, explanation: &Explanation, safety: Option<&str>) {
    let Explanation { sent, computed, .. } = explanation;
    if let Some(asked) = computed.filter(|asked| asked != sent) {
        let why = safety.map_or_else(String::new, |safety| format!("  <- safety {safety}"));
        let _ = writeln!(text, "  the plan asked for {}, and {} was sent{why}", input(asked), input(*sent));
    } else {
        let _ = writeln!(text, "  sent {}", input(*sent));
    }
}

fn input(input: Twist) -> String {
    let number = |value: f64| {
        let text = format!("{value:.3}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        (if text == "-0" { "0" } else { text }).to_owned()
    };
    format!("{} m/s, {} rad/s", number(input.v.0), number(input.omega.0))
}

/// Writes the events after the turn.
fn following(text: &mut String, next: &NextEvents, now: Nanos) {
    match next {
        NextEvents::Turn { turn, t, steps } => {
            let _ = writeln!(text, "next: turn {turn} at {}, {} s later", Clocked(*t), rounded(t.since(now).0));
            for (cause, to) in steps {
                let to = to.as_ref().map_or_else(|| "plan over".to_owned(), named);
                let _ = writeln!(text, "  {to}  <- {cause}");
            }
        }
        NextEvents::End { t, why } => {
            let _ = writeln!(text, "next: no transition up to the end of the record at {}{why}", Clocked(*t));
        }
    }
}

/// Returns an atom as text, with its position in the plan.
pub(super) fn named(atom: &AtomWords) -> String {
    if atom.place.is_empty() { atom.law.clone() } else { format!("{} ({})", atom.law, atom.place) }
}
