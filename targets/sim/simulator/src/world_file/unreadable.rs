//! Writes messages about text that is not TOML, and about keys and values that a world does not have, in the terms that
//! the author of the file knows.

use mdle_quantity::did_you_mean;

use super::Wrong;

/// Returns the error of a text that cannot be read as a world.
pub(super) fn unreadable(text: &str, error: &toml::de::Error) -> Wrong {
    let what = error.message().replace('\n', " ").replace("expected f64", "expected a number");
    let value = error.span().and_then(|span| text.get(span.start..)).unwrap_or_default();
    let key = error.span().and_then(|span| key_before(text.get(..span.start)?));
    let sentence = match key {
        Some(key) => format!("`{key}`: {}", number(key, value, &what).unwrap_or(what)),
        None => format!("{what}{}", meant(&what)),
    };
    Wrong(error.span(), sentence)
}

/// Keys whose values are texts in quotes.
const TEXTS: [&str; 3] = ["name", "units", "kind"];

/// Returns a sentence about a value that should be a number, such as `50%` and `2m`; `None` if `what` is about
/// something else.
fn number(key: &str, value: &str, what: &str) -> Option<String> {
    if what.ends_with("expected a number") {
        return (key == "rough").then(|| format!("{what} from 0 to 1, as in `rough = 0.5`"));
    }
    let end = value.find(|letter: char| !letter.is_ascii_digit() && !"+-.".contains(letter)).unwrap_or(value.len());
    let (digits, unit) = value.split_at(end);
    let written = digits.parse::<f64>().ok();
    if !what.starts_with("string values must be quoted") || TEXTS.contains(&key) {
        return None;
    }
    if key == "rough" {
        let percent = written.filter(|percent| unit.starts_with('%') && (0.0..=100.0).contains(percent));
        let share = percent.map_or(0.5, |percent| percent / 100.0);
        return Some(format!("expected a number from 0 to 1, as in `rough = {share}`"));
    }
    written.map(|_| format!("expected a number without a unit, as in `{key} = {digits}`"))
}

/// Returns the end of a sentence that lists the known keys: the key that is meant by the unknown one.
fn meant(what: &str) -> String {
    let mut names = what.split('`').skip(1).step_by(2);
    match names.next() {
        Some(unknown) if what.starts_with("unknown field") => did_you_mean(unknown, &names.collect::<Vec<_>>()),
        Some(_) | None => String::new(),
    }
}

/// Returns the key whose value follows `before`; `None` if no value follows it.
fn key_before(before: &str) -> Option<&str> {
    let assigned = before.trim_end().strip_suffix('=')?.trim_end();
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-');
    let from = assigned.rfind(|letter| !is_part(letter)).map_or(0, |at| at + 1);
    assigned.get(from..).filter(|key| !key.is_empty())
}
