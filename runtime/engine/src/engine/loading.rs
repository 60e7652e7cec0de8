//! Modules that are made while the robot drives: each on a thread of its own, as its code may take long.

use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use mdle_host::StopRequest;

use crate::library::Library;
use crate::module::{Candidate, Refusal};

/// Maximum number of modules that are being made.
const AT_ONCE: usize = 4;

/// The modules that are being made, and those that can be loaded at the next break.
pub(crate) struct Loading<Y> {
    library: Library<Y>,
    request: StopRequest,
    done: Receiver<Made<Y>>,
    sender: Sender<Made<Y>>,
    /// Number of the last request.
    last: u32,
    /// Number of modules that are being made.
    begun: usize,
}

/// A module that was made, or the reason why it was not, with the number of the request.
type Made<Y> = (u32, Result<Candidate<Y>, Refusal>);

impl<Y: 'static> Loading<Y> {
    /// Returns what loads modules of this library.
    pub(crate) fn new(library: Library<Y>, request: StopRequest) -> Self {
        let (sender, done) = channel();
        Self { library, request, done, sender, last: 0, begun: 0 }
    }

    /// Returns the library.
    pub(crate) fn library(&self) -> &Library<Y> {
        &self.library
    }

    /// Begins to make a module; returns the number of the request.
    ///
    /// # Errors
    /// No module can be made at present: a sentence.
    pub(crate) fn begin(&mut self, name: &str) -> Result<u32, String> {
        if self.begun >= AT_ONCE {
            return Err(format!("{AT_ONCE} modules are being made already: try again later"));
        }
        self.last = self.last.saturating_add(1);
        let (library, request, sender) = (self.library.clone(), self.request.clone(), self.sender.clone());
        let (own, number) = (name.to_owned(), self.last);
        let make = move || {
            // The run may have ended meanwhile.
            let _ = sender.send((number, library.candidate(&own, &request)));
        };
        let started = thread::Builder::new().name("mdle loader".to_owned()).spawn(make);
        started.map_err(|error: io::Error| format!("the system gives no thread for module `{name}`: {error}"))?;
        self.begun = self.begun.saturating_add(1);
        Ok(number)
    }

    /// Returns the next module that is made; never waits.
    pub(crate) fn next(&mut self) -> Option<Made<Y>> {
        let made = self.done.try_recv().ok()?;
        self.begun = self.begun.saturating_sub(1);
        Some(made)
    }
}
