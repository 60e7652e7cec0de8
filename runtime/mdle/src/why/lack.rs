//! Describes the time or the value that an operand still needs to fire. For an operand that has fired, describes how
//! long or by which margin it remains fired.

use mdle_compiler::plan::Condition;
use mdle_host::rounded;
use mdle_runtime::{Examined, Measured, Nanometers, Nanos, Operator, Radians};

/// Facts about a turn, which are needed to describe an operand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TurnFacts<'v> {
    /// Time since the scope was entered.
    pub(crate) since: Nanos,
    /// Length of the driven path since the scope was entered.
    pub(crate) way: Nanometers,
    /// Time for which the law of the previous turn has made no progress; `None` if that law has no goal.
    pub(crate) stalled: Option<Nanos>,
    /// `true` if the atom was entered in this turn.
    pub(crate) is_new: bool,
    /// Unit in which the operand's first value is shown, with the value of the unit in SI units; `None` if the operand
    /// has no value.
    pub(crate) unit: Option<(&'v str, f64)>,
    /// `true` if the first value is the range of a sonar.
    pub(crate) is_range: bool,
}

/// Returns a description of the time or value that an operand still needs to fire. For a timer that has fired, returns
/// the time that has passed. The description is empty if there is neither. `inner` is the operand of NOT or RISING.
pub(crate) fn lack(
    condition: &Condition,
    part: Examined,
    inner: Option<(&Condition, Examined)>,
    values: &TurnFacts<'_>,
) -> String {
    let TurnFacts { since, way, stalled, is_new, .. } = *values;
    if condition.lasting().is_some_and(|(_, due)| due == MEETING) {
        return meeting(part, since);
    }
    if let Some((_, due)) = condition.lasting() {
        return match stalled {
            _ if since == Nanos::ZERO => "the law has not begun".to_owned(),
            None if is_new => "the law before had no goal".to_owned(),
            None => "the law has no goal".to_owned(),
            Some(_) if part.fired => String::new(),
            Some(stalled) => {
                let left = Nanos(due).since(stalled).0.max(Nanos(due).since(since).0);
                format!("no progress for {} s, {} s left", rounded(stalled.0), rounded(left))
            }
        };
    }
    match condition {
        Condition::Wait { nanos, .. } => {
            let passed = format!("{} s passed", rounded(since.0));
            if part.fired { passed } else { format!("{passed}, {} s left", rounded(Nanos(*nanos).since(since).0)) }
        }
        Condition::Not(_) if part.fired => match inner {
            Some((Condition::Wait { .. }, _)) => {
                inner.map_or_else(String::new, |(inner, part)| lack(inner, part, None, values))
            }
            Some(_) | None => String::new(),
        },
        _ if part.fired => String::new(),
        Condition::Elapsed { from, until, .. } => match until {
            Some(until) if since.0 >= *until => format!("over for {} s", rounded(since.0 - until)),
            Some(_) | None => format!("{} s left", rounded(Nanos(*from).since(since).0)),
        },
        Condition::Driven { from, until, .. } => match until {
            Some(until) if way.0 >= *until => format!("{} m too far", rounded(way.0 - until)),
            Some(_) | None => format!("{} m left", rounded(Nanometers(*from).since(way).0)),
        },
        Condition::Quark(_) => compared(part.measured, values),
        Condition::Rising { .. } => match inner {
            Some((_, inner)) if inner.fired => "it has not been false since its scope was entered".to_owned(),
            Some((condition, part)) => lack(condition, part, None, values),
            None => String::new(),
        },
        Condition::Not(_) => match inner {
            Some((Condition::Wait { .. }, _)) => format!("it is over: {} s passed", rounded(since.0)),
            Some((Condition::Quark(_), Examined { measured: Measured::Nothing, .. })) => "it has fired".to_owned(),
            Some((condition, inner)) => ["it holds", &held(condition, inner, values)].join(" ").trim_end().to_owned(),
            None => String::new(),
        },
        Condition::After(_) => "that was not the last to end, or it ended otherwise".to_owned(),
        Condition::Null => "it never fires".to_owned(),
        Condition::Or(_) | Condition::And(_) => String::new(),
    }
}

/// Duration, in nanoseconds, that distinguishes a `rendezvous` from `stuck`. With this duration, a `rendezvous` fires
/// at the earliest in the turn after its scope was entered.
const MEETING: u64 = 1;

/// Returns the reason, in words, why a `rendezvous` has not fired; empty if it has fired.
fn meeting(part: Examined, since: Nanos) -> String {
    match (part.fired, since) {
        (true, _) => String::new(),
        (false, Nanos::ZERO) => "its scope was entered in this turn".to_owned(),
        (false, _) => "no state has told that the other robot is there".to_owned(),
    }
}

/// Returns, in words, how much longer or further a fired operand remains fired; empty if this is not known.
pub(crate) fn held(condition: &Condition, part: Examined, values: &TurnFacts<'_>) -> String {
    let TurnFacts { since, way, .. } = *values;
    match condition {
        Condition::Wait { .. } => format!("{} s passed", rounded(since.0)),
        Condition::Elapsed { until, .. } => match until {
            Some(until) => format!("for {} s more", rounded(Nanos(*until).since(since).0)),
            None => "from now on".to_owned(),
        },
        Condition::Driven { until, .. } => match until {
            Some(until) => format!("for {} m more", rounded(Nanometers(*until).since(way).0)),
            None => "from now on".to_owned(),
        },
        Condition::Quark(_) => margin(part.measured, values),
        Condition::Null
        | Condition::Or(_)
        | Condition::And(_)
        | Condition::Not(_)
        | Condition::Rising { .. }
        | Condition::After(_) => String::new(),
    }
}

/// Returns a description of the difference by which a comparison is false.
fn compared(measured: Measured, values: &TurnFacts<'_>) -> String {
    let Measured::Compared { left, right, .. } = measured else { return "it has not fired".to_owned() };
    let Some((unit, scale)) = values.unit else { return String::new() };
    if left.is_nan() || right.is_nan() {
        return "the value is not known".to_owned();
    }
    if left.is_infinite() && values.is_range {
        return "no echo".to_owned();
    }
    let (difference, words) = difference(measured);
    if difference == 0.0 {
        return "just not".to_owned();
    }
    format!("{} {words}", amount(difference / scale, unit))
}

/// Returns a description of the difference by which a comparison is true; empty if the operand is not a comparison.
fn margin(measured: Measured, values: &TurnFacts<'_>) -> String {
    let (Measured::Compared { left, right, .. }, Some((unit, scale))) = (measured, values.unit) else {
        return String::new();
    };
    if (left.is_infinite() || right.is_infinite()) && values.is_range {
        return "as there is no echo".to_owned();
    }
    format!("by {}", amount(-difference(measured).0 / scale, unit))
}

/// Returns the difference by which a comparison is false (a negative number if it is true), and the kind of the
/// difference in words.
fn difference(measured: Measured) -> (f64, &'static str) {
    let Measured::Compared { left, operator, right } = measured else { return (0.0, "") };
    match operator {
        Operator::Less | Operator::LessOrEqual => (left - right, "too much"),
        Operator::Greater | Operator::GreaterOrEqual => (right - left, "too little"),
        Operator::Equal(tolerance) => ((left - right).abs() - tolerance, "outside the tolerance"),
        Operator::SameDirection(tolerance) => {
            (Radians(left - right).wrapped().0.abs() - tolerance, "outside the tolerance")
        }
    }
}

fn amount(value: f64, unit: &str) -> String {
    let between = if unit.is_empty() { "" } else { " " };
    format!("{}{between}{unit}", short(value))
}

/// Formats a number with two decimals. If all digits would be 0, uses as many decimals as needed to show another digit.
fn short(value: f64) -> String {
    let text = |decimals: usize| format!("{value:.decimals$}");
    let is_zero = |text: &str| text.parse() == Ok(0.0);
    let text = (2..9).map(text).find(|text| !is_zero(text)).unwrap_or_else(|| text(9));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
