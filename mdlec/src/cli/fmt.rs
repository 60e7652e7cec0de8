//! `mdlec fmt`: formats plans in the canonical layout.

use std::fs;
use std::io::{self, IsTerminal};
use std::path::Path;

use super::each::each;
use super::{CommandFailure, Fmt, report};
use crate::link;
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::syntax;
use mdle_files::read::LARGEST_PLAN;

/// Formats each file, or lists the files whose layout differs. A file with errors stays unchanged.
pub(super) fn fmt(options: &Fmt) -> Result<(), CommandFailure> {
    each(&options.plans, |path| {
        let text = mdle_files::read_text(path, LARGEST_PLAN)?;
        let formatted = formatted(path, text.clone())?;
        if options.check {
            return if formatted == text { Ok(()) } else { differs(path) };
        }
        if path == Path::new("-") {
            // An editor needs the text back unchanged. On a terminal, control characters in the text must have no
            // effect.
            let is_terminal = io::stdout().is_terminal();
            return if is_terminal { report::print(&formatted) } else { report::print_exactly(&formatted) };
        }
        if formatted == text { Ok(()) } else { write(path, &formatted) }
    })
}

fn formatted(path: &Path, text: String) -> Result<String, CommandFailure> {
    let mut sources = Sources::default();
    let source = mdle_files::add(&mut sources, path, text)?;
    syntax::format(source, sources.text(source)).map_err(|found| {
        report::diagnostics(&sources, &found, false);
        CommandFailure::PLAN
    })
}

/// Prints the path of a file whose layout differs, and fails with exit status 1.
fn differs(path: &Path) -> Result<(), CommandFailure> {
    report::print(&format!("{}\n", path.display()))?;
    Err(CommandFailure::PLAN)
}

/// Overwrites a file, unless it is read-only.
fn write(path: &Path, text: &str) -> Result<(), CommandFailure> {
    if fs::metadata(path).is_ok_and(|found| found.permissions().readonly()) {
        return Err(CommandFailure::usage(format!("`{}` is read-only", path.display())));
    }
    link::write_whole(path, text.as_bytes(), &[]).map_err(CommandFailure::from)
}
