//! Writes the texts on atoms, scopes and loops in a picture.

use crate::fsm::{Atom, Element, ElementKind};
use crate::plan::{Condition, Interrupt, frame_text};

/// Maximum length of a tooltip, in characters, because nobody reads a longer text.
const TOOLTIP: usize = 4000;

/// Condition that ends an atom or a scope, in the form that pictures show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Until {
    /// The element ends when this condition fires.
    Fires(String),
    /// The element ends when its law completes.
    Done,
    /// The atom ends when this condition fires or its law completes.
    FiresOrDone(String),
    /// The element has no condition any more: its condition, with this text, was removed because an outer scope repeats
    /// it.
    Removed(String),
    /// The element has no condition.
    Never,
}

impl Until {
    /// Returns the condition that ends a scope or an atom; `completes` is `true` if the atom's law may complete.
    pub(super) fn of(interrupt: &Interrupt, completes: bool) -> Self {
        let (text, fires) = (interrupt.text.clone(), interrupt.condition != Condition::Null);
        match (fires, completes, interrupt.removed) {
            (true, true, _) => Self::FiresOrDone(text),
            (true, false, _) => Self::Fires(text),
            (false, true, _) => Self::Done,
            (false, false, true) => Self::Removed(text),
            (false, false, false) => Self::Never,
        }
    }

    /// Returns `true` if the element can end by itself.
    pub(super) fn ends(&self) -> bool {
        match self {
            Self::Fires(_) | Self::Done | Self::FiresOrDone(_) => true,
            Self::Removed(_) | Self::Never => false,
        }
    }

    /// Returns the words that follow "until" in a picture.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Fires(text) => text.clone(),
            Self::Done => "done".into(),
            Self::FiresOrDone(text) => format!("{text} or done"),
            Self::Removed(text) => format!("{text} (removed: a scope around it has the same)"),
            Self::Never => "never".into(),
        }
    }
}

/// Returns the condition that ends an element by itself. A loop has no such condition.
pub(super) fn until(element: Element<'_>) -> Until {
    element.interrupt().map_or(Until::Never, |interrupt| Until::of(interrupt, element.completes()))
}

/// Returns the labels of the elements that end together with this element, such as `s1: `; empty if there are no
/// labels.
pub(super) fn labels(element: Element<'_>) -> String {
    element.marks().iter().rev().map(|mark| format!("{}: ", mark.label)).collect()
}

/// Returns the text of an atom's frame and law, such as `FRAME 90deg go 20 0`.
pub(super) fn law(atom: Atom<'_>) -> String {
    format!("{}{}", frame_text(atom.frame()), atom.law().text)
}

/// Returns the text of a tooltip: all data of an element, in a few lines.
pub(super) fn tooltip(element: Element<'_>) -> String {
    let (labels, until) = (labels(element), until(element));
    let text = match element.kind() {
        ElementKind::Atom(atom) => format!("{labels}atom {}: {}\nuntil {}", atom.state(), law(atom), until.text()),
        ElementKind::Scope => {
            let name = if element.name().is_empty() { "a scope without a name" } else { element.name() };
            match until {
                Until::Never => format!("{labels}{name}\nends with its last element"),
                until @ (Until::Fires(_) | Until::Done | Until::FiresOrDone(_) | Until::Removed(_)) => {
                    format!("{labels}{name}\nuntil {}", until.text())
                }
            }
        }
        ElementKind::Loop { times } => format!("{labels}{}", passes(times)),
    };
    bounded(&text)
}

/// Returns the exponent of a loop, such as `^3` or `^inf`.
pub(super) fn exponent(times: Option<u64>) -> String {
    times.map_or_else(|| "^inf".into(), |times| format!("^{times}"))
}

/// Returns the number of a loop's passes in words, such as `3 passes`, `1 pass` or `for ever`.
pub(super) fn passes(times: Option<u64>) -> String {
    match times {
        None => "for ever".into(),
        Some(1) => "1 pass".into(),
        Some(times) => format!("{times} passes"),
    }
}

/// Shortens a text that exceeds the maximum length of a tooltip.
pub(super) fn bounded(text: &str) -> String {
    match text.char_indices().nth(TOOLTIP) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}… and {} more characters", &text[..end], text[end..].chars().count()),
    }
}
