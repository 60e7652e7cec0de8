//! Reports mistakes with names before the brace of a plan.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;

/// Reports a name before the brace of its plan, either at the beginning of the file or after a label.
pub(super) fn name_before_plan(site: &Site<'_, '_>, at: usize) -> Diagnostic {
    let name = site.name_at(at).unwrap_or("Name");
    let words = format!("the name of a plan is the first thing inside: `{{ {name} … }}`");
    site.about(at, format!("the name `{name}` is before the brace of its plan"), "put it inside the braces").fix(
        &words,
        site.span(at, at + 1),
        format!("{{ {name}"),
    )
}

/// Reports a name that is followed by `=` but is not a label.
pub(super) fn not_a_label(site: &Site<'_, '_>, at: usize, name: &str) -> Diagnostic {
    site.about(at, format!("`{name}` is not a label"), "the label of a plan begins with `Γ_` or `Gamma_`")
        .fix("write {}", site.span(at, at), format!("Gamma_{name}"))
        .fix(&format!("or remove `{name} =`: a plan's own name is inside its braces"), site.span(at, at + 1), "")
}
