//! The text of random plans.

use std::fmt;

use super::{Element, PARAMETERS, RandomPlan, Scope};
use crate::pipeline::LIBRARY_FILE;

impl fmt::Display for RandomPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.uses {
            writeln!(f, "use \"{LIBRARY_FILE}\"")?;
        }
        for (name, scope) in &self.definitions {
            let parameters = if self.parameters && *name == "Other" { PARAMETERS } else { "" };
            scope.write(name, parameters, f)?;
            writeln!(f)?;
        }
        Ok(())
    }
}

impl Scope {
    fn write_formally(&self, time: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        write_all(&self.body, f)?;
        write!(f, ", {}{time})", self.condition.as_deref().unwrap_or("null"))
    }

    fn write(&self, name: &str, parameters: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{{ {name}{parameters}", self.label)?;
        match (&self.condition, self.body.first()) {
            (Some(condition), _) => write!(f, " ({condition})")?,
            (None, Some(Element::Atom { .. } | Element::Scope(_)) | None) => {}
            // An open string there would be read as the condition.
            (None, Some(Element::Labelled(..) | Element::Framed(..) | Element::Loop { .. }))
            | (None, Some(Element::String(_) | Element::Reference(..))) => write!(f, " (null)")?,
        }
        write_all(&self.body, f)?;
        write!(f, "{} }}", self.end)
    }
}

/// Returns a law without its enclosing parentheses.
fn bare(law: &str) -> &str {
    law.strip_prefix('(').and_then(|law| law.strip_suffix(')')).unwrap_or(law)
}

fn write_all(elements: &[Element], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    elements.iter().try_for_each(|element| write!(f, " {element}"))
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
                write_all(body, f)?;
                f.write_str(")")
            }
            Self::Loop { times, body, exec: true } => {
                if let [Self::Reference(..)] = body.as_slice() {
                    return write!(f, "ExecPlan {times} {}", body[0]);
                }
                write!(f, "ExecPlan {times} {{")?;
                write_all(body, f)?;
                f.write_str(" }")
            }
            Self::Loop { times, body, exec: false } => {
                match body.as_slice() {
                    [one @ (Self::Atom { .. } | Self::Scope(_) | Self::Reference(..))] => write!(f, "{one}")?,
                    _ => {
                        f.write_str("(")?;
                        write_all(body, f)?;
                        f.write_str(" )")?;
                    }
                }
                write!(f, "^{times}")
            }
        }
    }
}
