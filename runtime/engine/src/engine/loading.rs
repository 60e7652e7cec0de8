//! Creates modules while the robot drives, each on its own thread, because a module's code may take long.
//!
//! The thread that starts these threads is started with the engine, before the control thread gets real-time
//! scheduling: threads and child processes inherit the scheduling of the thread that starts them.

use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use mdle_host::StopRequest;

use crate::library::Library;
use crate::module::{Candidate, Refusal};

/// Maximum number of modules that are created at the same time.
const AT_ONCE: usize = 4;

/// Modules that are being created, and modules that are ready to be loaded at the next turn break.
pub(crate) struct Loading<Y> {
    library: Library<Y>,
    orders: Sender<(u32, NewModule)>,
    done: Receiver<Made<Y>>,
    /// Number of the last request.
    last: u32,
    /// Number of modules that are currently being created.
    begun: usize,
}

/// Number of a request, and its result: the created module, or the reason why the module could not be created.
type Made<Y> = (u32, Result<Candidate<Y>, Refusal>);

/// A module to create.
#[derive(Debug, Clone)]
pub(crate) enum NewModule {
    /// A module of the library, given by its name.
    OfLibrary(String),
    /// A child process, given by the name of its module and its command line.
    Process(String, String),
}

impl<Y: 'static> Loading<Y> {
    /// Creates a loader for modules of this library.
    ///
    /// # Errors
    /// Fails if the system cannot create the thread.
    pub(crate) fn new(library: Library<Y>, request: StopRequest) -> io::Result<Self> {
        let ((orders, waiting), (sender, done)) = (channel(), channel());
        let own = library.clone();
        let start_all = move || {
            for (number, module) in waiting {
                start(number, module, &own, &request, &sender);
            }
        };
        thread::Builder::new().name("mdle loader".to_owned()).spawn(start_all)?;
        Ok(Self { library, orders, done, last: 0, begun: 0 })
    }

    /// Returns the library.
    pub(crate) fn library(&self) -> &Library<Y> {
        &self.library
    }

    /// Starts to create a module on its own thread; returns the number of the request.
    ///
    /// # Errors
    /// Fails with a sentence if no module can be created now.
    pub(crate) fn begin(&mut self, module: NewModule) -> Result<u32, String> {
        if self.begun >= AT_ONCE {
            return Err(format!("{AT_ONCE} modules are being made already: try again later"));
        }
        self.last = self.last.saturating_add(1);
        self.orders.send((self.last, module)).map_err(|_| "the thread that makes modules has ended".to_owned())?;
        self.begun = self.begun.saturating_add(1);
        Ok(self.last)
    }

    /// Returns a module that was created since the last call; `None` if there is no such module. Never waits.
    pub(crate) fn next(&mut self) -> Option<Made<Y>> {
        let made = self.done.try_recv().ok()?;
        self.begun = self.begun.saturating_sub(1);
        Some(made)
    }
}

impl NewModule {
    /// Returns the name of the module.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::OfLibrary(name) | Self::Process(name, _) => name,
        }
    }
}

/// Starts the thread that creates a module.
fn start<Y: 'static>(
    number: u32,
    module: NewModule,
    library: &Library<Y>,
    request: &StopRequest,
    sender: &Sender<Made<Y>>,
) {
    let name = module.name().to_owned();
    let (library, request, own) = (library.clone(), request.clone(), sender.clone());
    let make = move || {
        let candidate = match module {
            NewModule::OfLibrary(name) => library.candidate(&name, &request),
            NewModule::Process(name, command) => Candidate::process(&name, &command, &request),
        };
        // The run may have ended in the meantime.
        let _ = own.send((number, candidate));
    };
    if let Err(error) = thread::Builder::new().name("mdle maker".to_owned()).spawn(make) {
        let _ = sender.send((number, Err(Refusal::NoThread(name, error.to_string()))));
    }
}
