//! Formats causes of transitions, and the values from which operands of conditions were evaluated, in the words of the
//! plan.

use std::fmt::Write as _;

use mdle_runtime::trace::COMPLETED;
use mdle_runtime::{Cause, Measured, OperandWords, Operator, SourceLine, Transition, ValueWords, Words};

use crate::rounded;

/// Number of decimal places of a value, unless more are needed to distinguish the value from the value with which it is
/// compared.
const DECIMALS: usize = 2;
/// Maximum number of decimal places of a value.
const DECIMALS_MOST: usize = 9;

/// Returns the text of a transition's cause, with the values of the operands that have fired: `r1 = 0.38 m < 40cm
/// (wall.mdle:7)`. `operands` contains, for each operand that has fired, its number in the interrupt of the scope that
/// ended, and its values. Returns `None` for a plan without source text.
#[must_use]
pub fn cause_text(source: &dyn Words, transition: &Transition, operands: &[(u32, Measured)]) -> Option<String> {
    let Transition { scope, cause, .. } = *transition;
    let bracket = source.bracket(scope)?;
    if matches!(cause, Cause::Completed(_)) {
        return Some(format!("{COMPLETED} ({})", file_line(source, bracket.at)));
    }
    let mut words: Vec<String> = Vec::new();
    let mut at = bracket.at;
    for (number, measured) in operands {
        let Some(operand) = source.operand(scope, *number) else { continue };
        let text = operand_words(&operand, *measured, true);
        if words.is_empty() {
            at = operand.at;
        }
        if !words.contains(&text) {
            words.push(text);
        }
    }
    let of = if bracket.count > 1 { format!(", of \"{}\"", bracket.condition) } else { String::new() };
    Some(format!("{} ({}{of})", words.join(" and "), file_line(source, at)))
}

/// Returns a file of the plan and a line in it as text: `wall.mdle:7`.
#[must_use]
pub fn file_line(source: &dyn Words, at: SourceLine) -> String {
    format!("{}:{}", source.file(at), at.line)
}

/// Returns the words of an operand with its values: `r1 = 0.38 m < 40cm` if `holds` is `true`, and `r1 = 0.5 m, not <
/// 40cm` otherwise.
#[must_use]
pub fn operand_words(operand: &OperandWords<'_>, measured: Measured, holds: bool) -> String {
    let values = match measured {
        Measured::Nothing => [None, None],
        Measured::Elapsed(t) => [Some(rounded(t.0)), None],
        Measured::Driven(length) => [Some(rounded(length.0)), None],
        Measured::Compared { left, operator, right } => compared(operand.values, left, operator, right),
    };
    let mut words = String::new();
    let mut written = 0;
    for (value, ValueWords { after, unit, .. }) in values.into_iter().flatten().zip(operand.values) {
        let after = *after as usize;
        words += operand.written.get(written..after).unwrap_or("");
        let between = if unit.is_empty() { "" } else { " " };
        let is_first = written == 0;
        let _ = write!(words, " = {value}{between}{unit}");
        written = after;
        if is_first && !holds {
            let rest = operand.written.get(after..).unwrap_or("");
            words += ", not ";
            written += rest.len() - rest.trim_start().len();
        }
    }
    words + operand.written.get(written..).unwrap_or("")
}

/// Returns the values of both sides in the units of their signals, with the smallest number of decimal places for which
/// the comparison still has the same result.
fn compared(words: &[ValueWords<'_>], left: f64, operator: Operator, right: f64) -> [Option<String>; 2] {
    let scale = |side: usize| words.get(side).map(|words| words.scale);
    let Some(one) = scale(0) else { return [None, None] };
    let text = |value: f64, scale: f64, decimals: usize| shown(value / scale, decimals);
    let back = |text: &str, scale: f64| text.parse::<f64>().map_or(f64::NAN, |value| value * scale);
    let so = operator.holds(left, right);
    let stays = |decimals: &usize| {
        let other = scale(1).map_or(right, |scale| back(&text(right, scale, *decimals), scale));
        operator.holds(back(&text(left, one, *decimals), one), other) == so
    };
    let decimals = (DECIMALS..DECIMALS_MOST).find(stays).unwrap_or(DECIMALS_MOST);
    [Some(text(left, one, decimals)), scale(1).map(|scale| text(right, scale, decimals))]
}

/// Formats a number with at most `decimals` decimal places and no trailing zeros.
fn shown(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    (if text == "-0" { "0" } else { text }).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::{Nanometers, Nanos};

    const AT: SourceLine = SourceLine { file: 0, line: 7 };
    const METRES: ValueWords<'static> = ValueWords { after: 2, unit: "m", scale: 1.0 };

    fn words(written: &str, values: &[ValueWords<'_>], measured: Measured) -> String {
        operand_words(&OperandWords { text: "", written, at: AT, values }, measured, true)
    }

    fn less(left: f64, right: f64) -> Measured {
        Measured::Compared { left, operator: Operator::Less, right }
    }

    #[test]
    fn values_stand_after_their_signals() {
        assert_eq!(words("r1 < 40cm", &[METRES], less(0.38, 0.4)), "r1 = 0.38 m < 40cm");
        assert_eq!(
            words("RISING r1<40cm", &[ValueWords { after: 9, ..METRES }], less(0.1, 0.4)),
            "RISING r1 = 0.1 m<40cm"
        );
        let both = [METRES, ValueWords { after: 7, ..METRES }];
        assert_eq!(words("r3 < r5", &both, less(0.25, 1.0)), "r3 = 0.25 m < r5 = 1 m");
        assert_eq!(words("r3 < r5", &both, less(1.5, f64::INFINITY)), "r3 = 1.5 m < r5 = inf m");
        assert_eq!(words("bumper", &[], Measured::Nothing), "bumper");
        assert_eq!(words("wait 10min", &[], Measured::Elapsed(Nanos(1))), "wait 10min");
        let time = [ValueWords { after: 1, unit: "s", scale: 1.0 }];
        assert_eq!(words("t > 3s", &time, Measured::Elapsed(Nanos(3_050_000_000))), "t = 3.05 s > 3s");
        let way = [ValueWords { after: 3, ..METRES }];
        assert_eq!(words("way > 2m", &way, Measured::Driven(Nanometers(2_013_400_000))), "way = 2.013 m > 2m");
    }

    #[test]
    fn what_does_not_hold_says_so() {
        let unfired = |written: &'static str, values: &[ValueWords<'_>], measured| {
            operand_words(&OperandWords { text: "", written, at: AT, values }, measured, false)
        };
        assert_eq!(unfired("r1 < 40cm", &[METRES], less(0.5, 0.4)), "r1 = 0.5 m, not < 40cm");
        assert_eq!(unfired("r1<40cm", &[METRES], less(0.5, 0.4)), "r1 = 0.5 m, not <40cm");
        let both = [METRES, ValueWords { after: 7, ..METRES }];
        assert_eq!(unfired("r3 < r5", &both, less(1.0, 0.25)), "r3 = 1 m, not < r5 = 0.25 m");
        assert_eq!(unfired("bumper", &[], Measured::Nothing), "bumper");
    }

    #[test]
    fn a_value_is_not_rounded_to_what_it_is_compared_with() {
        assert_eq!(words("r1 < 40cm", &[METRES], less(0.399_97, 0.4)), "r1 = 0.39997 m < 40cm");
        let centimetres = [ValueWords { after: 1, unit: "cm/s", scale: 0.01 }];
        assert_eq!(words("v < 80", &centimetres, less(0.123_45, 0.8)), "v = 12.35 cm/s < 80");
        assert_eq!(words("v < 80", &centimetres, less(-0.000_001, 0.8)), "v = 0 cm/s < 80");
    }
}
