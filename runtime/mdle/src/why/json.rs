//! Writes explanations as JSON, for programs.

use mdle_runtime::{Measured, Nanos, Twist};
use serde_json::{Value, json};

use super::explanation::{AppliedAtom, AtomWords, Ended, Explanation, Replaced};
use super::never::{Beginnings, Chance, NeverAnswer, Skips, Stay, Turned};
use super::operands::MeasuredOperand;
use super::scopes::{ScopeRole, ScopeState};
use super::{NextEvents, TurnAnswer};

/// Returns an answer as a JSON object.
pub(super) fn object(answer: &TurnAnswer) -> Value {
    let TurnAnswer { explanation, asked, next, safety } = answer;
    let Explanation { turn, t, replaced, ended, runs, cut, output_age, sent, computed } = explanation;
    json!({
        "asked": asked.seconds(),
        "turn": turn,
        "t": t.seconds(),
        "replaced": replaced.as_ref().map(|Replaced { atom, since, cause }| {
            json!({ "atom": words(atom), "for": since.seconds(), "cause": cause })
        }),
        "ended": ended.iter().map(end).collect::<Vec<_>>(),
        "runs": runs.as_ref().map(|runs| run(runs, *t)),
        "cut": cut.is_some(),
        "output_age": output_age.seconds(),
        "sent": input(*sent),
        "computed": computed.map(input),
        "safety": safety,
        "next": following(next),
    })
}

fn end(ended: &Ended) -> Value {
    let Ended { atom, is_skipped, cause, was_done, scopes, to } = ended;
    json!({
        "atom": words(atom),
        "skipped": is_skipped,
        "cause": cause,
        "done": was_done,
        "scopes": scopes.iter().map(scope).collect::<Vec<_>>(),
        "to": to.as_ref().map(words),
    })
}

fn run(runs: &AppliedAtom, t: Nanos) -> Value {
    let AppliedAtom { atom, since, paused, began, completes, scopes } = runs;
    json!({
        "atom": words(atom),
        "since": t.since(*since).since(*paused).seconds(),
        "paused": paused.seconds(),
        "began": began,
        "completes": completes,
        "scopes": scopes.iter().map(scope).collect::<Vec<_>>(),
    })
}

fn words(atom: &AtomWords) -> Value {
    json!({ "law": atom.law, "place": atom.place })
}

fn scope(scope: &ScopeState) -> Value {
    let ScopeState { name, is_atom, line, condition, since, part, examination, leads_to } = scope;
    let part = match part {
        ScopeRole::Ended => "ended",
        ScopeRole::Completed => "completed",
        ScopeRole::Shadowed => "shadowed",
        ScopeRole::Waits => "waits",
        ScopeRole::NoInterrupt => "no interrupt",
        ScopeRole::Removed => "removed",
    };
    json!({
        "name": name,
        "atom": is_atom,
        "line": line,
        "condition": condition,
        "for": since.seconds(),
        "part": part,
        "fired": examination.fired,
        "operands": examination.operands.iter().map(operand).collect::<Vec<_>>(),
        "missing": examination.missing,
        "leads_to": leads_to,
    })
}

fn operand(operand: &MeasuredOperand) -> Value {
    let MeasuredOperand { written, words, fired, decided, suffices, measured, lack, stale, inside } = operand;
    json!({
        "operand": written,
        "words": words,
        "fired": fired,
        "decided": decided,
        "suffices": suffices,
        "value": match measured {
            Measured::Nothing => Value::Null,
            Measured::Compared { left, .. } => json!(left),
            Measured::Elapsed(t) => json!(t.seconds()),
            Measured::Driven(way) => json!(way.0 as f64 / 1e9),
        },
        "with": match measured {
            Measured::Compared { right, .. } => json!(right),
            Measured::Nothing | Measured::Elapsed(_) | Measured::Driven(_) => Value::Null,
        },
        "lacks": lack,
        "stale": stale,
        "inside": inside.iter().map(self::operand).collect::<Vec<_>>(),
    })
}

fn input(input: Twist) -> Value {
    json!({ "v": input.v.0, "omega": input.omega.0 })
}

/// Returns the answer to the question why an atom or a scope did not begin, as a JSON object.
pub(super) fn absence(never: &NeverAnswer) -> Value {
    let NeverAnswer { asked, began, runs, skipped, chance, follows, end, last, .. } = never;
    let turned = |(turn, t): &Turned| json!({ "turn": turn, "t": t.seconds() });
    let caused = |((turn, t), cause): &(Turned, String)| json!({ "turn": turn, "t": t.seconds(), "cause": cause });
    json!({
        "asked": asked,
        "began": began.as_ref().map(|Beginnings { times, first, last }| {
            json!({ "times": times, "first": caused(first), "last": caused(last) })
        }),
        "runs": runs,
        "skipped": skipped.as_ref().map(|Skips { times, first, last }| {
            json!({ "times": times, "first": stay(first), "last": turned(last) })
        }),
        "chance": chance.as_ref().map(|Chance { begins, times, scopes, first, last }| {
            json!({ "begins": begins, "times": times, "scopes": scopes, "first": stay(first), "last": stay(last) })
        }),
        "follows": follows,
        "end": json!({ "turn": end.0, "t": end.1.seconds(), "atom": last.as_ref().map(words) }),
    })
}

fn stay(stay: &Stay) -> Value {
    let Stay { turned: (turn, t), atom, scopes, cause } = stay;
    json!({
        "turn": turn,
        "t": t.seconds(),
        "atom": words(atom),
        "scopes": scopes.iter().map(scope).collect::<Vec<_>>(),
        "cause": cause,
    })
}

fn following(next: &NextEvents) -> Value {
    match next {
        NextEvents::Turn { turn, t, steps } => {
            let step =
                |(cause, to): &(String, Option<AtomWords>)| json!({ "cause": cause, "to": to.as_ref().map(words) });
            json!({ "turn": turn, "t": t.seconds(), "steps": steps.iter().map(step).collect::<Vec<_>>() })
        }
        NextEvents::End { .. } => Value::Null,
    }
}
