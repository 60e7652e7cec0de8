//! The time or the value that an operand lacks to fire, in words.

use mdle_compiler::plan::Condition;
use mdle_host::rounded;
use mdle_runtime::{Examined, Measured, Nanometers, Nanos, Operator, Radians};

/// The facts of a turn that the words need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Values<'v> {
    /// Time since the scope was entered.
    pub(crate) since: Nanos,
    /// Length of the path driven since then.
    pub(crate) way: Nanometers,
    /// Time for which the law of the turn before has made no progress; `None` if it has no goal.
    pub(crate) stalled: Option<Nanos>,
    /// `true` if the atom was entered in this turn.
    pub(crate) is_new: bool,
    /// Unit in which the operand's first value is shown, and its SI value.
    pub(crate) unit: Option<(&'v str, f64)>,
    /// `true` if the first value is the range of a sonar.
    pub(crate) is_range: bool,
}

/// Returns what an operand lacks; for a timer that has fired the time that has passed. `inner` is the condition of NOT
/// or RISING. Empty if nothing can be said.
pub(crate) fn lack(
    condition: &Condition,
    part: Examined,
    inner: Option<(&Condition, Examined)>,
    values: &Values<'_>,
) -> String {
    let Values { since, way, stalled, is_new, .. } = *values;
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
            Some((Condition::Wait { .. } | Condition::Quark(_), inner)) => match inner.measured {
                Measured::Compared { .. } => "it holds".to_owned(),
                Measured::Elapsed(_) | Measured::Driven(_) => "it is over".to_owned(),
                Measured::Nothing => "it has fired".to_owned(),
            },
            Some(_) | None => "it holds".to_owned(),
        },
        Condition::After(_) => "that was not the last to end, or it ended otherwise".to_owned(),
        Condition::Null => "it never fires".to_owned(),
        Condition::Or(_) | Condition::And(_) => String::new(),
    }
}

/// Returns the difference by which a comparison does not hold.
fn compared(measured: Measured, values: &Values<'_>) -> String {
    let Measured::Compared { left, operator, right } = measured else { return "it has not fired".to_owned() };
    let Some((unit, scale)) = values.unit else { return String::new() };
    if left.is_nan() || right.is_nan() {
        return "the value is not known".to_owned();
    }
    if left.is_infinite() && values.is_range {
        return "no echo".to_owned();
    }
    let (difference, words) = match operator {
        Operator::Less | Operator::LessOrEqual => (left - right, "too much"),
        Operator::Greater | Operator::GreaterOrEqual => (right - left, "too little"),
        Operator::Equal(tolerance) => ((left - right).abs() - tolerance, "outside the tolerance"),
        Operator::SameDirection(tolerance) => {
            (Radians(left - right).wrapped().0.abs() - tolerance, "outside the tolerance")
        }
    };
    if difference == 0.0 {
        return "just not".to_owned();
    }
    let between = if unit.is_empty() { "" } else { " " };
    format!("{}{between}{unit} {words}", short(difference / scale))
}

/// Formats a number with two decimals, or with as many more as it takes to have another digit than 0.
pub(crate) fn short(value: f64) -> String {
    let text = |decimals: usize| format!("{value:.decimals$}");
    let is_zero = |text: &str| text.parse() == Ok(0.0);
    let text = (2..9).map(text).find(|text| !is_zero(text)).unwrap_or_else(|| text(9));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
