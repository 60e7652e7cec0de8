//! Data from outside the robot that a plan reads: numbers that modules publish, with their times (paper, section
//! III-B), and the states of other robots.

use crate::{Links, Nanos};

/// Maximum number of module attributes that one plan reads.
pub const PUBLISHED: usize = 16;

/// A module's attribute that a plan reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ModuleRead {
    /// Name of the module.
    pub module: &'static str,
    /// Name of the attribute in the module.
    pub attribute: &'static str,
    /// SI unit of the attribute's values; `None` if the plan accepts any number.
    pub unit: Option<&'static str>,
}

/// A number that a module has published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedNumber {
    /// The value, in SI units.
    pub value: f64,
    /// Time of the publication, on the engine's clock.
    pub at: Nanos,
    /// Time since the publication.
    pub age: Nanos,
}

/// The latest numbers that modules have published for a plan; without an engine, there are no such numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    names: &'static [ModuleRead],
    numbers: [Option<PublishedNumber>; PUBLISHED],
    /// Age of the oldest number that a plan or a safety rule reads.
    oldest: Nanos,
    links: Links,
}

impl Published {
    /// Storage without any published numbers.
    pub const NONE: Self = Self::new(&[]);

    /// Creates storage for the numbers that modules will publish for the attributes `names`. Only the first
    /// [`PUBLISHED`] attributes can have a number.
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

    /// Sets the states of other robots, which the state link provides.
    #[must_use]
    pub const fn with_links(self, links: Links) -> Self {
        Self { links, ..self }
    }

    /// Returns the states of other robots, which the state link provides.
    #[must_use]
    pub const fn links(&self) -> &Links {
        &self.links
    }

    /// Sets the number of the attribute at the index `place` in the list of names.
    pub fn set(&mut self, place: usize, number: Option<PublishedNumber>) {
        if let Some(entry) = self.numbers.get_mut(place) {
            *entry = number;
        }
    }

    /// Returns the last number that the module has published for this attribute; `None` before the first publication.
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
