//! Tests the parser with snapshots: each source with its outline and messages.

mod format;
mod forms;
mod listings;
mod mistakes;
mod properties;

use super::outline::outline;
use super::{Arena, parse};
use crate::diagnostic::Sources;

/// Compares sources, each with its outline and its messages, with the recorded snapshot.
fn check(name: &str, texts: &[&str]) {
    let shown = texts.iter().map(|text| one(text)).collect::<Vec<_>>().join("\n════════\n");
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, shown));
}

fn one(text: &str) -> String {
    let mut sources = Sources::default();
    sources.add("before.mdle", "Γ");
    let id = sources.add("plan.mdle", text);
    let arena = Arena::new();
    let (file, diagnostics) = parse(id, text, &arena);
    let messages: Vec<String> = diagnostics.iter().map(|diagnostic| sources.render(diagnostic)).collect();
    format!("{text}\n────────\n{}{}", outline(&file), messages.concat())
}
