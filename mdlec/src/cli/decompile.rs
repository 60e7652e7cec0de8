//! `mdlec decompile`: prints the MDLe string of a machine, or the reasons why none exists (paper, Theorem 1).

use std::path::Path;

use super::{CommandFailure, Decompile, report};
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::syntax;
use mdle_files::read::LARGEST_DATA;
use mdle_theory::theorem::{Machine, TheoremResult, as_printed, augment, decompile as theorem, monomial, read, string};

/// Maximum number of states for which the matrices of a machine are printed.
const SHOWN: usize = 12;

/// Prints the plan of a machine. With `--as-printed`, reports whether the conditions hold in the form in which the
/// paper prints them.
pub(super) fn decompile(options: &Decompile) -> Result<(), CommandFailure> {
    let file = options.machine.display();
    let text = mdle_files::read_text(&options.machine, LARGEST_DATA)?;
    let machine = read(&text).map_err(|error| {
        let line = error.line.map(|line| format!("{line}:")).unwrap_or_default();
        refused(format!("{file}:{line} {}", error.message))
    })?;
    if options.augment {
        return print(&options.machine, &augment(&machine));
    }
    let answer = theorem(&machine, options.steps);
    if options.as_printed {
        report::print(&printed(&machine, &answer))?;
    }
    match answer {
        TheoremResult::String(_) if options.as_printed => Ok(()),
        TheoremResult::String(found) => print(&options.machine, &string(&machine, &found)),
        TheoremResult::None(broken) => {
            let count = broken.len();
            let mut message = format!("{file}: no MDLe string is equivalent to this machine (Theorem 1)");
            broken.iter().take(CONDITIONS).for_each(|broken| message += &format!("\n  {}", broken.sentence(&machine)));
            if count > CONDITIONS {
                message += &format!("\n  … and {} more", count - CONDITIONS);
            }
            Err(refused(format!("{message}\nhelp: `mdlec decompile --augment {file}` makes a plan with `after` of it")))
        }
        TheoremResult::Stopped(steps) => Err(refused(format!(
            "{file}: the search for an order of its states was stopped after {steps} steps: whether this machine has an MDLe string is \
             not known\nhelp: `--steps {}` searches longer; `--augment` makes a plan with `after` of any machine",
            steps.saturating_mul(10)
        ))),
    }
}

/// Maximum number of failed conditions in a message.
const CONDITIONS: usize = 100;

fn refused(message: String) -> CommandFailure {
    CommandFailure::of(1, message)
}

/// Prints a plan in the canonical layout. Reports an error if laws or conditions in the machine's file are not valid
/// MDLe.
fn print(file: &Path, plan: &str) -> Result<(), CommandFailure> {
    let mut sources = Sources::default();
    let source = mdle_files::add(&mut sources, Path::new(&format!("the plan of {}", file.display())), plan.to_owned())?;
    match syntax::format(source, plan) {
        Ok(text) => report::print(&text),
        Err(found) => {
            report::diagnostics(&sources, &found, false);
            Err(refused(format!("{}: what it has as `laws` and `text` is not valid MDLe", file.display())))
        }
    }
}

/// Returns a report on the conditions in the form in which the paper prints them. The report says whether they hold for
/// a machine, and how they differ from the exact conditions.
fn printed(machine: &Machine, exactly: &TheoremResult) -> String {
    let mut text = String::new();
    if machine.states().len() <= SHOWN {
        text += &monomial(machine);
        text += "\n";
    }
    let rules = as_printed(machine, exactly);
    for rule in &rules {
        text += &match (&rule.letter, &rule.meant) {
            (None, None) => format!("{} holds\n", rule.name),
            (Some(letter), Some(meant)) if letter == meant => format!("{} fails: {letter}\n", rule.name),
            (Some(letter), Some(meant)) => format!("{} fails: {meant}; to the letter: {letter}\n", rule.name),
            (Some(letter), None) => format!("{} holds as intended, but to the letter: {letter}\n", rule.name),
            (None, Some(meant)) => format!("{} holds to the letter, but: {meant}\n", rule.name),
        };
    }
    let verdict = |holds: bool| if holds { "there is a string" } else { "there is no string" };
    let letter = rules.iter().all(|rule| rule.letter.is_none());
    let meant = rules.iter().all(|rule| rule.meant.is_none());
    let exact = match exactly {
        TheoremResult::String(_) => verdict(true),
        TheoremResult::None(_) => verdict(false),
        TheoremResult::Stopped(_) => "the search was stopped",
    };
    let differ = match (meant, exactly) {
        (true, TheoremResult::None(_)) | (false, TheoremResult::String(_)) => ": they differ",
        (true, TheoremResult::String(_) | TheoremResult::Stopped(_))
        | (false, TheoremResult::None(_) | TheoremResult::Stopped(_)) => "",
    };
    text + &format!(
        "to the letter: {}\nas intended:   {}\nexactly:       {exact}{differ}\n",
        verdict(letter),
        verdict(meant)
    )
}
