//! Writes messages about text that is not a token: unexpected characters, malformed numbers, and unterminated comments
//! and strings.

use super::arithmetic::{arithmetic, computed, foreign_unit, sum_of_units, word};
use super::number::split;
use super::source::{FileText, TextRange};
use super::touching::touching;
use crate::alphabet::Unit;
use crate::diagnostic::{Code, Diagnostic, Span};

/// Reports a series of characters with which no token begins.
pub(super) fn characters(source: FileText<'_>, place: TextRange) -> Diagnostic {
    let found = source.slice(place);
    if let Some(diagnostic) = arithmetic(source, found, place) {
        return diagnostic;
    }
    let (what, noun) = match found.chars().count() {
        1 => (shown(found), "character"),
        2..=12 => (shown(found), "text"),
        _ => (format!("{}…", shown(found.get(..found.char_indices().nth(8).map_or(0, |c| c.0)).unwrap_or(""))), "text"),
    };
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("unexpected {noun} {what}"), source.span(place), "not part of MDLe");
    characters_help(diagnostic, source, found, place)
}

/// Returns `diagnostic` with help about the meaning that the characters `found` usually have.
fn characters_help(diagnostic: Diagnostic, source: FileText<'_>, found: &str, place: TextRange) -> Diagnostic {
    let after = source.text.get(place.end..).unwrap_or("");
    let next = after.chars().next();
    let operator =
        |diagnostic: Diagnostic, word| diagnostic.fix("write {}", source.span(place), apart(source, place, word));
    if let Some(words) = words_around(&diagnostic, source, found, place) {
        return words;
    }
    match found {
        "&&" | "&" | "∧" => operator(diagnostic, "AND"),
        "|" if is_magnitude(source, place) => {
            diagnostic.help("nothing is computed in a plan; two ranges are compared with `==`: `r7 == r9`")
        }
        "||" | "|" | "∨" => operator(diagnostic, "OR"),
        "!" if next == Some('=') => diagnostic.help("write `NOT` before an equality: `NOT r 3 == r 5`"),
        "!" | "~" | "¬"
            if begins_operand(source, place.start) && next.is_some_and(|c| c.is_alphabetic() || c == '(') =>
        {
            diagnostic.fix("write {} and a space", source.span(place), apart(source, place, "NOT"))
        }
        "~" if !begins_operand(source, place.start) => diagnostic.help("write a space; `~` is one in typesetting only"),
        "!" | "~" | "¬" => diagnostic.help("write `NOT` and a space before a condition: `NOT bumper`"),
        "≠" => diagnostic.help("write `NOT` before an equality: `NOT r 3 == r 5`"),
        "/" | "--" if begins_line(source, place.start) => {
            diagnostic.fix("a comment begins with {}", source.span(place), "//")
        }
        "#" | "%" if begins_line(source, place.start) => {
            diagnostic.fix("a comment begins with {}", source.span(place), "//")
        }
        "#" | "%" => diagnostic.help("a comment begins with `//`"),
        "*" => pascal_comment(diagnostic, source, place),
        "'" | "“" | "”" | "„" | "‘" | "’" | "`" => {
            diagnostic.help("text is written between plain double quotes: `\"path.txt\"`")
        }
        "−" | "–" | "—" => sign(diagnostic, source, "-", place),
        // A name that begins with a lower-case letter is not a plan, because plans begin with a capital.
        "." if ends_name(source, place.start) && next.is_some_and(char::is_lowercase) => {
            diagnostic.help("in a condition of a group, a dot is between a robot and its signal: `robot1.x > 7m`")
        }
        "." if ends_name(source, place.start) && next.is_some_and(char::is_alphabetic) => {
            diagnostic.help("a plan of a file that is used is called by its name alone: `Leg(3m)`")
        }
        "." if next.is_some_and(|c| c.is_ascii_digit()) && begins_operand(source, place.start) => {
            let digits: String = after.chars().take_while(char::is_ascii_digit).take(12).collect();
            let span = source.span(TextRange::new(place.start, place.end + digits.len()));
            diagnostic.fix("a number has digits on both sides of its dot: {}", span, format!("0.{digits}"))
        }
        "-" | "+" => sign(diagnostic, source, found, place),
        "°" => diagnostic.help("write `deg`, touching the number: `90deg`"),
        "/" => diagnostic.help("a unit is written out and touches its number: `20cm/s`"),
        "\\" => diagnostic.help(TYPESETTING),
        _ => diagnostic,
    }
}

/// Returns the message with help about the surrounding text, such as `T#5s`, `bend.csv` or `r0 != 50cm`.
fn words_around(diagnostic: &Diagnostic, source: FileText<'_>, found: &str, place: TextRange) -> Option<Diagnostic> {
    let (before, after) = (source.text.get(..place.start)?, source.text.get(place.end..)?);
    let left = word(before);
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let of = |text: &'_ str| text.find(|c: char| !is_part(c)).unwrap_or(text.len());
    let (skipped, right) = match after.strip_prefix('=').filter(|_| found == "!") {
        Some(rest) => {
            let operand = rest.trim_start_matches(' ');
            (after.len() - operand.len(), operand.get(..of(operand))?)
        }
        None => (0, after.get(..of(after))?),
    };
    let end = place.end + skipped + right.len();
    let whole = |left: &str| source.span(TextRange::new(place.start - left.len(), end));
    let (number, unit) = split(right);
    let diagnostic = diagnostic.clone();
    match found {
        "#" if matches!(left, "T" | "t" | "TIME" | "Time") && !number.is_empty() && Unit::from_name(unit).is_some() => {
            Some(diagnostic.fix("a time is a number that its unit touches: {}", whole(left), right))
        }
        "." if matches!(right, "csv" | "tsv" | "txt" | "dat" | "path") && ends_name(source, place.start) => {
            let file = format!("\"{left}.{right}\"");
            Some(diagnostic.fix("the name of a file is written between double quotes: {}", whole(left), file))
        }
        "!" if skipped > 0 && !right.is_empty() => {
            let signal = word(before.trim_end_matches(' '));
            let start = before.trim_end_matches(' ').len() - signal.len();
            let begins = before.get(..start)?.trim_end();
            let is_whole = ["(", " OR", " AND", " or", " and"].iter().any(|end| begins.ends_with(end));
            let is_signal = signal.starts_with(char::is_alphabetic) && is_whole;
            let words = "write `NOT` before an equality: {}";
            let span = source.span(TextRange::new(start, end));
            is_signal.then(|| diagnostic.fix(words, span, format!("NOT {signal} == {right}")))
        }
        _ => None,
    }
}

/// Returns `true` if this is one of the two strokes around a difference, as in `|r7 - r9| < 1cm`.
fn is_magnitude(source: FileText<'_>, place: TextRange) -> bool {
    let (before, after) = (source.text.get(..place.start), source.text.get(place.end..));
    let begun = after.and_then(|after| Some(after.split_once('|')?.0));
    let ended = before.and_then(|before| Some(before.rsplit_once('|')?.1));
    let is_difference = |text: &str| text.contains('-') && !text.contains('\n') && text.trim() == text;
    [begun, ended].into_iter().flatten().any(is_difference)
}

/// Returns `true` if only spaces and tabs precede this place in its line.
fn begins_line(source: FileText<'_>, at: usize) -> bool {
    let before = source.text.get(..at).unwrap_or("");
    before.rsplit('\n').next().unwrap_or(before).trim().is_empty()
}

/// Help text that lists the typesetting commands that the lexer accepts.
const TYPESETTING: &str = "of typesetting only `\\\\`, `\\{`, `\\}`, `\\text{…}`, `\\infty`, `\\leq`, `\\geq`, `\\Gamma_{…}` and `\\sigma_{null}` are read";

/// Returns `true` if an operand can begin at this offset, because a space, an opening bracket, or a sign between
/// operands precedes it.
fn begins_operand(source: FileText<'_>, at: usize) -> bool {
    let before = source.text.get(..at).unwrap_or("");
    before.is_empty() || before.ends_with(|c: char| c.is_whitespace() || "(,<>=".contains(c))
}

/// Returns `true` if a name may end at this offset.
fn ends_name(source: FileText<'_>, at: usize) -> bool {
    source.text.get(..at).is_some_and(|before| before.ends_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// Reports a file name that is not in double quotes.
pub(super) fn file(source: FileText<'_>, place: TextRange, name: &str) -> Diagnostic {
    let span = source.span(place);
    let diagnostic = Diagnostic::new(Code::E0101, "this text is not between double quotes", span, "not part of MDLe");
    diagnostic.fix("write {}", span, format!("\"{name}\""))
}

/// Returns `diagnostic` with help about a sign that does not touch its number.
fn sign(diagnostic: Diagnostic, source: FileText<'_>, found: &str, place: TextRange) -> Diagnostic {
    let after = source.text.get(place.end..).unwrap_or("");
    let spaces = after.len() - after.trim_start_matches([' ', '\t']).len();
    let (number, _) = split(after.get(spaces..).unwrap_or(""));
    if number.is_empty() || number.starts_with(['+', '-']) {
        return diagnostic.help("a sign touches its number: `-5`");
    }
    let span = source.span(TextRange::new(place.start, place.end + spaces + number.len()));
    let is_plain = source.slice(place).is_ascii();
    let words = if is_plain { "a sign touches its number: {}" } else { "the minus sign is a plain `-`: {}" };
    diagnostic.fix(words, span, format!("{found}{number}"))
}

/// Returns `word`, which is to replace the characters at `place`. Adds a space on each side on which these characters
/// touch other text.
fn apart(source: FileText<'_>, place: TextRange, word: &str) -> String {
    let is_blank = |c: Option<char>| c.is_none_or(char::is_whitespace);
    let before = source.text.get(..place.start).and_then(|before| before.chars().next_back());
    let after = source.text.get(place.end..).and_then(|after| after.chars().next());
    let before = if is_blank(before) || before == Some('(') { "" } else { " " };
    format!("{before}{word}{}", if is_blank(after) { "" } else { " " })
}

/// Reports a typesetting command that has no meaning in a plan.
pub(super) fn command(source: FileText<'_>, place: TextRange) -> Diagnostic {
    let found = source.slice(place);
    let diagnostic = Diagnostic::new(
        Code::E0101,
        format!("`{found}` has no meaning in a plan"),
        source.span(place),
        "unknown command",
    );
    let name = found.trim_start_matches('\\').to_lowercase();
    let word = match name.as_str() {
        "gamma" => return diagnostic.help("a label is written `\\Gamma_{from}^{to}` or `Γ_from^to`"),
        "sigma" => return diagnostic.help("the end of a plan is written `\\sigma_{null}` or `σ_null`"),
        "le" | "leqslant" => "<=",
        "ge" | "geqslant" => ">=",
        "wedge" | "land" => "AND",
        "vee" | "lor" => "OR",
        "neg" | "lnot" => "NOT",
        "inf" | "infinity" => "inf",
        "," | ";" | ":" | "!" | "quad" | "qquad" => {
            return diagnostic.fix("a space needs no command: write one", source.span(place), " ");
        }
        _ => return diagnostic.help(TYPESETTING),
    };
    diagnostic.fix("write {}", source.span(place), apart(source, place, word))
}

/// Reports the range of a sonar whose number is in braces.
pub(super) fn range(source: FileText<'_>, place: TextRange, digits: &str) -> Diagnostic {
    let message = format!("the sonar of `{}` has no braces", source.slice(place));
    let diagnostic = Diagnostic::new(Code::E0101, message, source.span(place), "not part of MDLe");
    diagnostic.fix("write {}", source.span(place), format!("r_{digits}"))
}

/// Reports a block comment that is never closed.
pub(super) fn comment(source: FileText<'_>, place: TextRange) -> Diagnostic {
    let opener = TextRange::new(place.start, place.start + 2);
    Diagnostic::new(Code::E0105, "this comment does not end", source.span(opener), "begins here")
        .help("end it with `*/`, or write `//` for a comment that ends with its line")
}

/// Reports a string that does not end on its line.
pub(super) fn string(source: FileText<'_>, place: TextRange) -> Diagnostic {
    let opener = source.span(TextRange::new(place.start, place.start + 1));
    let diagnostic = Diagnostic::new(Code::E0105, "this text does not end on its line", opener, "begins here");
    if place.end == place.start + 1 {
        return diagnostic.help("end it with `\"`, or remove this quote");
    }
    diagnostic.fix("end it with {}", source.span(TextRange::new(place.end, place.end)), "\"")
}

/// Reports a `\text{` that is never closed.
pub(super) fn text(source: FileText<'_>, place: TextRange) -> Diagnostic {
    Diagnostic::new(Code::E0103, "this `\\text{` is never closed", source.span(place), "opened here")
        .help("close it with `}`; it contains no braces")
}

/// Reports a number that touches text other than a unit.
pub(super) fn number(source: FileText<'_>, number: &str, tail: &str, place: TextRange) -> Diagnostic {
    let span = source.span(TextRange::new(place.end - tail.len(), place.end));
    let whole = source.span(place);
    if let Some(diagnostic) = touching(source, number, tail, place) {
        return diagnostic;
    }
    if tail.starts_with('.') {
        return dot(number, tail, span, whole);
    }
    if tail.starts_with(['+', '-']) {
        let message = format!("`{tail}` touches the number before it");
        let diagnostic = Diagnostic::new(Code::E0104, message, span, "MDLe has no arithmetic");
        let diagnostic = match computed(number, tail.get(..1).unwrap_or(""), tail.get(1..).unwrap_or("")) {
            Some(result) => diagnostic.fix("write the result: {}", whole, result),
            None => diagnostic,
        };
        let (_, unit) = split(tail);
        let words = "for two numbers put a space between them: {}";
        return match unit.is_empty() || Unit::from_name(unit).is_some() {
            true => diagnostic.fix(words, whole, format!("{number} {tail}")),
            false => diagnostic,
        };
    }
    let is_label = source.text.get(place.end..).is_some_and(|after| after.trim_start_matches(' ').starts_with(':'));
    if is_label && tail.len() <= 40 && tail.chars().all(|c| c.is_alphanumeric() || c == '_') {
        let message = format!("`{number}{tail}` is not a name");
        let diagnostic = Diagnostic::new(Code::E0104, message, whole, "begins with a digit");
        let digits = number.trim_start_matches(['+', '-']).replace('.', "_");
        return diagnostic.fix("a name begins with a letter: {}", whole, format!("{tail}{digits}"));
    }
    // After hours, `m` means minutes.
    let of_time = || Some(format!("{tail}in")).filter(|_| tail.starts_with('h') && tail.ends_with('m'));
    if let Some(sum) = sum_of_units(number, tail).or_else(|| sum_of_units(number, &of_time()?)) {
        let message = format!("`{number}{tail}` is a sum of two units");
        let diagnostic = Diagnostic::new(Code::E0104, message, whole, "a number has one unit");
        return diagnostic.fix("write the sum in one of them: {}", whole, sum);
    }
    let shown = if tail.len() > 40 { "…" } else { tail };
    let message = format!("`{shown}` is not a unit");
    let mut diagnostic = Diagnostic::new(Code::E0104, message, span, format!("touches the number `{number}`"));
    let near = match foreign_unit(number, tail) {
        Some(converted) => Some(diagnostic.clone().fix("in a unit that MDLe has: {}", whole, converted)),
        None => nearest_unit(tail).map(|unit| {
            diagnostic.clone().fix(&format!("the nearest unit is `{unit}`: {{}}"), whole, format!("{number}{unit}"))
        }),
    };
    let is_near = near.is_some();
    diagnostic = near.unwrap_or(diagnostic);
    if !is_near
        && tail.len() <= 40
        && tail.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && !tail.contains(['/', '.', '+', '-', '°'])
    {
        diagnostic = diagnostic.fix("if it is a name, put a space before it: {}", whole, format!("{number} {tail}"));
    }
    if !is_near {
        diagnostic = diagnostic.help(format!("the units are {}", units()));
    }
    diagnostic
}

/// Reports a number with too many dots, or without digits after a dot.
fn dot(number: &str, tail: &str, span: Span, whole: Span) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0104, format!("`{number}{tail}` is not a number"), span, "not part of a number");
    let rest = tail.trim_start_matches('.');
    if (rest.is_empty() || Unit::from_name(rest).is_some()) && !number.contains('.') {
        return diagnostic.fix("a number has digits on both sides of its dot: {}", whole, format!("{number}.0{rest}"));
    }
    diagnostic.help("a number has one dot at most, with digits on both sides: `0.36`")
}

/// Returns the unit that the user probably meant by `written`.
pub(crate) fn nearest_unit(written: &str) -> Option<&'static str> {
    let spelled = match written.to_lowercase().as_str() {
        "°" | "degree" | "degrees" => Some("deg"),
        "°/s" | "deg/sec" | "dps" => Some("deg/s"),
        "radian" | "radians" => Some("rad"),
        "sec" | "secs" | "second" | "seconds" => Some("s"),
        "msec" | "millisecond" | "milliseconds" => Some("ms"),
        "minute" | "minutes" | "mins" => Some("min"),
        "hour" | "hours" | "hr" => Some("h"),
        "meter" | "meters" | "metre" | "metres" => Some("m"),
        "inch" | "inches" => Some("in"),
        "foot" | "feet" => Some("ft"),
        "volt" | "volts" => Some("V"),
        "hertz" => Some("Hz"),
        "mps" => Some("m/s"),
        _ => None,
    };
    spelled.or_else(|| {
        let near = |name: &str| {
            let is_like = written.len() > 1 && name.len() > 1 && written.chars().next() == name.chars().next();
            written.eq_ignore_ascii_case(name)
                || is_like
                    && !written.contains(|c: char| c.is_ascii_digit())
                    && strsim::damerau_levenshtein(written, name) <= 1
        };
        let names = || Unit::ALL.iter().map(|unit| unit.name);
        names().find(|name| *name == written).or_else(|| names().find(|name| written.len() <= 40 && near(name)))
    })
}

/// Returns a list of all units for use in a sentence.
fn units() -> String {
    let names: Vec<String> = Unit::ALL.iter().map(|unit| format!("`{}`", unit.name)).collect();
    names.join(" ")
}

/// Returns `text` in quotes, with each invisible character replaced by its code point.
fn shown(text: &str) -> String {
    let shown: String = text
        .chars()
        .map(|c| if c.is_control() || c.is_whitespace() { format!("U+{:04X}", u32::from(c)) } else { c.to_string() })
        .collect();
    format!("`{shown}`")
}

/// Returns `diagnostic` with help about a comment between `(*` and `*)`. The characters at both ends get the same help.
fn pascal_comment(diagnostic: Diagnostic, source: FileText<'_>, place: TextRange) -> Diagnostic {
    let text = source.text;
    let begins = |at: usize| text.get(..at).filter(|before| before.ends_with('(')).map(|before| before.len() - 1);
    let ends = |at: usize| text.get(at..).filter(|after| after.starts_with("*)")).map(|_| at + 2);
    let start = begins(place.start).or_else(|| text.get(..place.start)?.rfind("(*"));
    let end = ends(place.start).or_else(|| Some(place.end + text.get(place.end..)?.find("*)")? + 2));
    let (Some(start), Some(end)) = (start, end) else { return diagnostic };
    let span = source.span(TextRange::new(start, end));
    let inside = text.get(start + 2..end - 2).unwrap_or_default();
    let message = "a comment is not written between `(*` and `*)`";
    Diagnostic::new(Code::E0101, message, span, "not part of MDLe").fix("write {}", span, format!("/*{inside}*/"))
}
