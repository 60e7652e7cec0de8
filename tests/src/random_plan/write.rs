//! Writes random plans as text.

use std::fmt;

use super::{Element, PARAMETERS, RandomPlan, Scope};
use crate::chance::Chance;
use crate::pipeline::LIBRARY_FILE;

/// Mark between two elements where a comma is allowed. It does not occur in plans.
const BETWEEN: char = '\u{1}';

impl fmt::Display for RandomPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&Marked(self).to_string().replace(BETWEEN, ""))
    }
}

impl RandomPlan {
    /// Returns the text with a comma at some of the positions between two elements where a comma is allowed
    /// (docs/src/reference/language.md, 3.2).
    pub fn with_commas(&self, chance: &mut Chance) -> String {
        let marked = Marked(self).to_string();
        marked.chars().filter(|one| *one != BETWEEN || chance.percent(60)).collect::<String>().replace(BETWEEN, ",")
    }
}

/// A plan that is written with all marks.
struct Marked<'p>(&'p RandomPlan);

impl fmt::Display for Marked<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(RandomPlan { definitions, parameters, uses }) = self;
        if *uses {
            writeln!(f, "use \"{LIBRARY_FILE}\"")?;
        }
        for (name, scope) in definitions {
            let parameters = if *parameters && *name == "Other" { PARAMETERS } else { "" };
            scope.write(name, parameters, f)?;
            writeln!(f)?;
        }
        Ok(())
    }
}

impl Scope {
    fn write_formally(&self, time: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        write_all(&self.body, Element::is_no_condition, f)?;
        write!(f, ", {}{time})", self.condition.as_deref().unwrap_or("null"))
    }

    fn write(&self, name: &str, parameters: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{{ {name}{parameters}", self.label)?;
        match (&self.condition, self.body.first()) {
            (Some(condition), _) => write!(f, " ({condition})")?,
            (None, Some(Element::Atom { .. } | Element::Scope(_)) | None) => {}
            // Without it, an open string would be parsed as the condition.
            (None, Some(Element::Labelled(..) | Element::Framed(..) | Element::Loop { .. }))
            | (None, Some(Element::String(_) | Element::Reference(..))) => write!(f, " (null)")?,
        }
        write_all(&self.body, |_| true, f)?;
        write!(f, "{} }}", self.end)
    }
}

/// Returns a law without its enclosing parentheses.
fn bare(law: &str) -> &str {
    law.strip_prefix('(').and_then(|law| law.strip_suffix(')')).unwrap_or(law)
}

/// Writes elements. Before each element except the first, writes a mark if `may_precede` returns `true` for it.
fn write_all(elements: &[Element], may_precede: impl Fn(&Element) -> bool, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    elements.iter().enumerate().try_for_each(|(number, element)| {
        if number > 0 && may_precede(element) {
            write!(f, "{BETWEEN}")?;
        }
        write!(f, " {element}")
    })
}

impl Element {
    /// Returns `true` if this element cannot be parsed as a condition after a comma inside parentheses.
    fn is_no_condition(&self) -> bool {
        match self {
            Self::Labelled(..) | Self::Framed(..) | Self::Atom { .. } | Self::Scope(_) => true,
            Self::Reference(..) => false,
            Self::Loop { exec: true, .. } => true,
            Self::Loop { body, exec: false, .. } | Self::String(body) => {
                body.iter().any(|element| element.is_no_condition() || matches!(element, Self::Loop { .. }))
            }
        }
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Labelled(label, element) => write!(f, "{label}: {element}"),
            Self::Framed(angle, element) => write!(f, "FRAME {angle} {element}"),
            Self::Atom { condition, law, formal: Some(time) } => {
                write!(f, "({}, {condition}{time})", bare(law))
            }
            Self::Atom { condition, law, formal: None } => write!(f, "(Atom ({condition}) {law})"),
            Self::Scope(scope @ Scope { formal: Some(time), .. }) => scope.write_formally(time, f),
            Self::Scope(scope) => scope.write(scope.name, "", f),
            Self::Reference(name, None) => f.write_str(name),
            Self::Reference(name, Some(arguments)) => write!(f, "{name}({arguments})"),
            Self::String(body) => {
                f.write_str("(")?;
                write_all(body, Self::is_no_condition, f)?;
                f.write_str(")")
            }
            Self::Loop { times, body, exec: true } => {
                if let [Self::Reference(..)] = body.as_slice() {
                    return write!(f, "ExecPlan {times} {}", body[0]);
                }
                write!(f, "ExecPlan {times} {{")?;
                write_all(body, |_| true, f)?;
                f.write_str(" }")
            }
            Self::Loop { times, body, exec: false } => {
                match body.as_slice() {
                    [one @ (Self::Atom { .. } | Self::Scope(_) | Self::Reference(..))] => write!(f, "{one}")?,
                    _ => {
                        f.write_str("(")?;
                        write_all(body, Self::is_no_condition, f)?;
                        f.write_str(" )")?;
                    }
                }
                write!(f, "^{times}")
            }
        }
    }
}
