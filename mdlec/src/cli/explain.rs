//! `mdlec explain`: prints the meaning of a code, with a wrong and a corrected example.

use super::{CommandFailure, report};
use mdle_compiler::diagnostic::Code;

/// Explains a code, or lists all codes.
pub(super) fn explain(code: Option<&str>) -> Result<(), CommandFailure> {
    let Some(name) = code else {
        let lines = Code::ALL.iter().map(|code| format!("{code}  {}\n", code.title()));
        return report::print(&lines.collect::<String>());
    };
    let named = |code: &&Code| code.name().eq_ignore_ascii_case(name);
    let code = Code::ALL.iter().find(named).ok_or_else(|| unknown(name))?;
    report::print(&format!("{code}: {}\n\n{}", code.title(), code.explanation().text()))
}

fn unknown(name: &str) -> CommandFailure {
    let distance = |code: &Code| strsim::damerau_levenshtein(&name.to_uppercase(), code.name());
    let near = Code::ALL.iter().copied().filter(|code| distance(code) <= 1).min_by_key(distance);
    let near = near.map(|code| format!("; did you mean `{code}`, {}?", code.title())).unwrap_or_default();
    CommandFailure::usage(format!(
        "there is no code `{name}`{near}\nhelp: a code is a letter and four digits, as in `mdlec explain E0201`; `mdlec explain` lists all codes"
    ))
}
