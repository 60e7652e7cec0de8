//! The modules of a program, as functions that create the modules for each run.

use std::fmt;
use std::sync::Arc;

use mdle_host::StopRequest;

use crate::attribute::is_name;
use crate::module::{Background, Candidate, Declare, Module, PLAN, ROBOT, Refusal};

/// The modules that each run of a program loads, in order.
pub struct Library<Y> {
    makers: Vec<(String, Arc<MakeCandidate<Y>>)>,
}

/// Function that creates a module.
type MakeCandidate<Y> = dyn Fn(&StopRequest) -> Result<Candidate<Y>, Refusal> + Send + Sync;

impl<Y> Library<Y> {
    /// Creates a library without modules.
    #[must_use]
    pub const fn new() -> Self {
        Self { makers: Vec::new() }
    }

    /// Adds a registered module with this name; `make` declares the module's attributes and returns the module.
    pub fn registered<M: Module<Y> + 'static>(
        &mut self,
        name: &str,
        make: impl Fn(&mut Declare) -> M + Send + Sync + 'static,
    ) {
        let own = name.to_owned();
        self.makers.push((name.to_owned(), Arc::new(move |_| Candidate::registered(&own, &make))));
    }

    /// Adds a background module with this name; `make` declares the module's attributes and returns the module.
    pub fn background<M: Background>(&mut self, name: &str, make: impl Fn(&mut Declare) -> M + Send + Sync + 'static) {
        let own = name.to_owned();
        self.makers.push((name.to_owned(), Arc::new(move |_| Candidate::background(&own, &make))));
    }

    /// Adds a background module with the name `name`. A child process, which `/bin/sh` starts with the command line
    /// `command`, computes the module's values. See [`Candidate::process`].
    pub fn process(&mut self, name: &str, command: &str) {
        let (own, command) = (name.to_owned(), command.to_owned());
        self.makers.push((name.to_owned(), Arc::new(move |request| Candidate::process(&own, &command, request))));
    }

    /// Returns the names of the modules.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.makers.iter().map(|(name, _)| name.as_str())
    }

    /// Checks that a module can be added under this name.
    ///
    /// # Errors
    /// Fails if the name is invalid, reserved or taken.
    pub fn admits(&self, name: &str) -> Result<(), Refusal> {
        if !is_name(name) {
            return Err(Refusal::BadName(name.to_owned()));
        }
        if [PLAN, ROBOT].contains(&name) {
            return Err(Refusal::Reserved(name.to_owned()));
        }
        let is_taken = self.names().any(|known| known == name);
        if is_taken { Err(Refusal::NameTaken(name.to_owned())) } else { Ok(()) }
    }

    /// Creates the modules; stops early if `request` asks the run to end.
    pub(crate) fn candidates(&self, request: &StopRequest) -> impl Iterator<Item = Result<Candidate<Y>, Refusal>> {
        self.makers.iter().map(move |(_, make)| make(request))
    }

    /// Creates the module with this name; stops early if `request` asks the run to end.
    ///
    /// # Errors
    /// Fails if there is no such module, or if it cannot be created.
    pub(crate) fn candidate(&self, name: &str, request: &StopRequest) -> Result<Candidate<Y>, Refusal> {
        let found = self.makers.iter().find(|(known, _)| known == name);
        found.map_or_else(|| Err(Refusal::Unknown(name.to_owned())), |(_, make)| make(request))
    }
}

impl<Y> Clone for Library<Y> {
    fn clone(&self) -> Self {
        Self { makers: self.makers.clone() }
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
