//! The modules of a program: functions that make them, for each run anew.

use std::fmt;

use crate::module::{Background, Candidate, Declare, Module, Refusal};

/// The modules that each run of a program loads, in this order.
pub struct Library<Y> {
    makers: Vec<Box<MakeCandidate<Y>>>,
}

/// Makes a module.
type MakeCandidate<Y> = dyn Fn() -> Result<Candidate<Y>, Refusal> + Send + Sync;

impl<Y> Library<Y> {
    /// Returns a library without modules.
    #[must_use]
    pub const fn new() -> Self {
        Self { makers: Vec::new() }
    }

    /// Adds a registered module of this name, which `make` declares and returns.
    pub fn registered<M: Module<Y> + 'static>(
        &mut self,
        name: &str,
        make: impl Fn(&mut Declare) -> M + Send + Sync + 'static,
    ) {
        let name = name.to_owned();
        self.makers.push(Box::new(move || Candidate::registered(&name, &make)));
    }

    /// Adds a background module of this name, which `make` declares and returns.
    pub fn background<M: Background>(&mut self, name: &str, make: impl Fn(&mut Declare) -> M + Send + Sync + 'static) {
        let name = name.to_owned();
        self.makers.push(Box::new(move || Candidate::background(&name, &make)));
    }

    /// Makes the modules.
    pub(crate) fn candidates(&self) -> impl Iterator<Item = Result<Candidate<Y>, Refusal>> {
        self.makers.iter().map(|make| make())
    }
}

impl<Y> Default for Library<Y> {
    fn default() -> Self {
        Self::new()
    }
}

impl<Y> fmt::Debug for Library<Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Library of {} modules", self.makers.len())
    }
}
