//! Numbers that modules publish for a plan: those alone that the plan reads, with their times (paper, section III-B).
//! And the other robots that the plan names.

use crate::{Links, Nanos};

/// Maximum number of attributes of modules that one plan reads.
pub const PUBLISHED: usize = 16;

/// An attribute of a module that a plan reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ModuleRead {
    /// Name of the module.
    pub module: &'static str,
    /// Name of the attribute in the module.
    pub attribute: &'static str,
    /// SI unit of its values; `None` if any number will do.
    pub unit: Option<&'static str>,
}

/// A number that a module has published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedNumber {
    /// The number, in SI units.
    pub value: f64,
    /// Time of its publication, on the engine's clock.
    pub at: Nanos,
    /// Time since its publication.
    pub age: Nanos,
}

/// The numbers that a plan reads, as they were published last. Without an engine there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    names: &'static [ModuleRead],
    numbers: [Option<PublishedNumber>; PUBLISHED],
    /// Age of the oldest number that somebody waits for.
    oldest: Nanos,
    links: Links,
}

impl Published {
    /// No number of any module.
    pub const NONE: Self = Self::new(&[]);

    /// Returns the numbers of these attributes before any is published; attributes after the first [`PUBLISHED`] have
    /// none.
    #[must_use]
    pub const fn new(names: &'static [ModuleRead]) -> Self {
        Self { names, numbers: [None; PUBLISHED], oldest: Nanos::ZERO, links: Links::NONE }
    }

    /// Sets the age of the oldest number that a plan or a safety rule reads.
    #[must_use]
    pub const fn as_old_as(self, oldest: Nanos) -> Self {
        Self { oldest, ..self }
    }

    /// Returns the age of the oldest number that the plan or a safety rule reads; zero if they read none.
    #[must_use]
    pub const fn oldest(&self) -> Nanos {
        self.oldest
    }

    /// Sets what the state link knows of other robots.
    #[must_use]
    pub const fn with_links(self, links: Links) -> Self {
        Self { links, ..self }
    }

    /// Returns what the state link knows of other robots.
    #[must_use]
    pub const fn links(&self) -> &Links {
        &self.links
    }

    /// Sets the number of the attribute at this place among the names.
    pub fn set(&mut self, place: usize, number: Option<PublishedNumber>) {
        if let Some(entry) = self.numbers.get_mut(place) {
            *entry = number;
        }
    }

    /// Returns the number that the module has published last; `None` before the first.
    #[must_use]
    pub fn number(&self, module: &str, attribute: &str) -> Option<PublishedNumber> {
        let place = self.names.iter().position(|name| name.module == module && name.attribute == attribute)?;
        self.numbers.get(place).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_found_by_both_names() {
        static NAMES: [ModuleRead; 2] = [
            ModuleRead { module: "ears", attribute: "bearing", unit: None },
            ModuleRead { module: "heading", attribute: "bearing", unit: None },
        ];
        let mut published = Published::new(&NAMES);
        let number = PublishedNumber { value: 0.5, at: Nanos(3), age: Nanos(7) };
        published.set(1, Some(number));
        published.set(PUBLISHED, Some(number));
        let names = [("ears", "bearing"), ("heading", "bearing"), ("heading", "range"), ("nobody", "bearing")];
        let numbers = names.map(|(module, attribute)| published.number(module, attribute));
        assert_eq!(numbers, [None, Some(number), None, None]);
        assert_eq!(Published::NONE.number("heading", "bearing"), None);
    }
}
