//! Writes messages about text that touches a number in the arguments of `atIsection` and `align`, whose meaning is
//! known there: bits and sonars.

use mdle_runtime::SONARS;

use super::source::{FileText, TextRange};
use crate::diagnostic::{Code, Diagnostic};

/// Help text with the order of the bits.
pub(crate) const BITS: &str = "the bits are front, left, back, right; 1 where an obstacle is near: `0100`";

/// Reports malformed bits of `atIsection`, and sonars of `align` that are joined by `-`; `None` for any other text.
pub(super) fn touching(source: FileText<'_>, number: &str, tail: &str, place: TextRange) -> Option<Diagnostic> {
    let before = source.text.get(..place.start)?.trim_end_matches(' ');
    let follows = |name: &str| {
        let rest = before.strip_suffix('(').unwrap_or(before).strip_suffix(name)?;
        (!rest.ends_with(|c: char| c.is_alphanumeric() || c == '_')).then_some(rest.len())
    };
    if let Some(start) = follows("atIsection") {
        return prefix(source, number, tail, place).or_else(|| not_bits(source, start, before.ends_with('('), place));
    }
    follows("align").and_then(|_| sonars(source, number, tail, place))
}

/// Reports the prefix of bits, as in `atIsection 0b1000`.
fn prefix(source: FileText<'_>, number: &str, tail: &str, place: TextRange) -> Option<Diagnostic> {
    let bits = tail.strip_prefix(['b', 'B', 'x', 'X']).filter(|_| number == "0")?;
    if bits.len() != 4 || !bits.bytes().all(|bit| matches!(bit, b'0' | b'1')) {
        return None;
    }
    let span = source.span(place);
    let message = format!("the bits of `{number}{tail}` have no prefix");
    Some(Diagnostic::new(Code::E0104, message, span, "not four digits 0 or 1").fix("write {}", span, bits))
}

/// Reports other text than bits, such as `10x0`, whose third bit may have either value. The name of the call begins at
/// `start`.
fn not_bits(source: FileText<'_>, start: usize, in_parentheses: bool, place: TextRange) -> Option<Diagnostic> {
    let written = source.slice(place);
    let is_any = |c: char| matches!(c, 'x' | 'X' | '_');
    if written.len() > 40 {
        return None;
    }
    let message = format!("`{written}` is not four bits");
    let diagnostic = Diagnostic::new(Code::E0104, message, source.span(place), "each bit is 0 or 1");
    if written.len() != 4 || !written.chars().all(|c| matches!(c, '0' | '1') || is_any(c)) {
        return Some(diagnostic.help(BITS));
    }
    if in_parentheses || written.chars().filter(|c| is_any(*c)).count() != 1 {
        return Some(diagnostic.help("for a bit of either value write both: `(atIsection 1000 OR atIsection 1010)`"));
    }
    let (zero, one) = (written.replace(is_any, "0"), written.replace(is_any, "1"));
    let both = format!("(atIsection {zero} OR atIsection {one})");
    Some(diagnostic.fix(
        "for a bit of either value write both: {}",
        source.span(TextRange::new(start, place.end)),
        both,
    ))
}

/// Reports two sonars that are joined by `-`, as in `align 3-5`.
fn sonars(source: FileText<'_>, number: &str, tail: &str, place: TextRange) -> Option<Diagnostic> {
    let second = tail.strip_prefix('-')?;
    let is_sonar = |text: &str| text.parse::<usize>().is_ok_and(|sonar| sonar < SONARS);
    if !is_sonar(number) || !is_sonar(second) {
        return None;
    }
    let span = source.span(place);
    let message = format!("`{tail}` touches the number before it");
    let diagnostic = Diagnostic::new(Code::E0104, message, span, "two sonars have a space between them");
    Some(diagnostic.fix("write {}", span, format!("{number} {second}")))
}
