//! Prints the lists of `mdlec targets` and `mdlec quarks`: robots, and the laws, interrupts and signals of a robot.

use mdle_compiler::alphabet::{Alphabet, Declaration, DeclarationKind};
use mdle_compiler::builtin;
use mdle_compiler::plan::signature;
use mdle_files::target;

use super::{CommandFailure, report};

/// Prints the list of `mdlec targets`.
pub(super) fn print_targets() -> Result<(), CommandFailure> {
    let mut text = String::new();
    for builtin in builtin::alphabets().iter().filter(|alphabet| alphabet.target) {
        let target = target(Some(builtin.name))?;
        let capabilities: Vec<_> = target.alphabet.capabilities.iter().map(ToString::to_string).collect();
        text += &format!("{}: {}\n", builtin.name, capabilities.join(", "));
    }
    report::print(&text)
}

/// Maximum width of the column of signatures in characters; longer signatures exceed the column.
const WIDEST: usize = 100;

/// Prints the list of `mdlec quarks`.
pub(super) fn print_quarks(option: Option<&str>) -> Result<(), CommandFailure> {
    let target = target(option)?;
    let widths = target.alphabet.declarations().map(|declaration| signature(declaration).chars().count());
    let width = widths.filter(|width| *width <= WIDEST).max().unwrap_or(0);
    let mut text = String::new();
    for (kind, title) in [
        (DeclarationKind::Interrupt, "interrupts"),
        (DeclarationKind::Control, "laws"),
        (DeclarationKind::Signal, "signals"),
    ] {
        text += &format!("{title}\n");
        let of_kind = target.alphabet.declarations().filter(|declaration| declaration.kind == kind);
        of_kind.for_each(|declaration| text += &line(declaration, &target.alphabet, width));
    }
    report::print(&text)
}

fn line(declaration: &Declaration, alphabet: &Alphabet, width: usize) -> String {
    let missing: Vec<_> =
        declaration.needs.iter().filter(|need| !alphabet.has(need)).map(ToString::to_string).collect();
    let missing = match missing.as_slice() {
        [] => String::new(),
        missing => format!(" (not on {}: it has no {})", alphabet.name, missing.join(", ")),
    };
    let exclusive =
        if declaration.exclusive { " Exclusive: fires for one value of its arguments at a time." } else { "" };
    format!("  {:width$}  {}{exclusive}{missing}\n", signature(declaration), declaration.docs)
}
