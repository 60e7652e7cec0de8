//! Writes the answer to the question why an atom or a scope did not begin, as text for people.

use std::fmt::Write as _;

use mdle_host::{Clocked, rounded};

use super::never::{Beginnings, Chance, NeverAnswer, Skips, Stay, Turned};
use super::text::{named, scope};

/// Returns the text of an answer about the record `log`.
pub(super) fn text(never: &NeverAnswer, log: &str) -> String {
    let NeverAnswer { asked, began, runs, skipped, chance, follows, plan, end, is_replaced, last } = never;
    let mut text = match began {
        Some(began) => beginnings(asked, began, log),
        None => format!("`{asked}` did not begin\n"),
    };
    if !plan.is_empty() {
        let _ = writeln!(text, "several plans drove; this is about `{plan}`, the last that has it");
    }
    if *runs {
        let until = if *is_replaced { "until another plan took over" } else { "up to the end of the record" };
        let _ = writeln!(text, "\nit ran {until}, {}", turned(end));
        return text;
    }
    if began.is_some() {
        text += "\nit has not begun again since\n";
    }
    if let Some(skips) = skipped {
        skip(&mut text, skips);
    } else if let Some(chance) = chance {
        chances(&mut text, chance);
    } else {
        let last = last.as_ref().map_or_else(|| "the plan was over".to_owned(), |last| format!("{} ran", named(last)));
        let follows = match follows.as_slice() {
            [] => String::new(),
            laws => {
                let laws: Vec<_> = laws.iter().map(|law| format!("`{law}`")).collect();
                format!(" (it follows {})", laws.join(" or "))
            }
        };
        let at = if *is_replaced { "before another plan took over" } else { "at the end" };
        let end = turned(end);
        let _ = writeln!(text, "\nno atom ran that leads to it{follows}; {at}, in {end}, {last}");
    }
    text
}

fn turned((turn, t): &Turned) -> String {
    format!("turn {turn} at {}", Clocked(*t))
}

/// Returns the text about the turns in which the element began.
fn beginnings(asked: &str, began: &Beginnings, log: &str) -> String {
    let Beginnings { times, first, last } = began;
    let when = |(turn, cause): &(Turned, String)| {
        let cause = if cause.is_empty() { "the start of the plan" } else { cause };
        format!("{}  <- {cause}", turned(turn))
    };
    let times = match times {
        1 => format!("`{asked}` began in {}\n", when(first)),
        _ => format!("`{asked}` began {times} times\n  first in {}\n  last in {}\n", when(first), when(last)),
    };
    let ((_, t), _) = last;
    format!("{times}help: `mdle why {log} {}` explains that turn\n", rounded(t.0))
}

/// Writes the first turn in which the element was entered and left immediately.
fn skip(text: &mut String, skips: &Skips) {
    let Skips { times, first: Stay { turned: turn, atom, scopes, cause }, last } = skips;
    let _ = writeln!(text, "\n{} was entered in {} and skipped  <- {cause}", named(atom), turned(turn));
    scopes.iter().for_each(|around| scope(text, around));
    if *times > 1 {
        let _ = writeln!(text, "it was skipped {times} times, last in {}", turned(last));
    }
}

/// Writes the first and the last turn in which the element could have begun.
fn chances(text: &mut String, chance: &Chance) {
    let Chance { begins, times, scopes, first, last } = chance;
    let begins = begins.as_ref().map_or_else(String::new, |name| match name.as_str() {
        "" => ", as the first atom of the scope around it".to_owned(),
        name => format!(", with `{name}`"),
    });
    let had = if scopes.len() > 1 { "one of these scopes had" } else { "this scope had" };
    let _ = writeln!(text, "\nit could first have begun in {}{begins}, if {had} ended:", turned(&first.turned));
    let around = scopes.iter().filter_map(|number| first.scopes.get(*number));
    around.for_each(|around| scope(text, around));
    let of = if *times > 1 { format!(", the last of {times} periods in which it could") } else { String::new() };
    let (turn, atom) = (turned(&last.turned), named(&last.atom));
    let _ = writeln!(text, "\nit could last have begun in {turn}, during {atom}{of}:");
    last.scopes.iter().for_each(|around| scope(text, around));
    if last.cause.is_empty() {
        *text += "  after that the record ended\n";
    } else {
        let _ = writeln!(text, "  after that another scope ended  <- {}", last.cause);
    }
}
