//! The janitor: a thread that drops values for the control thread. Dropping a large plan takes long, and the destructor
//! of a module may take any time.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Channel that passes values to the janitor's thread, which drops them.
#[derive(Debug, Clone)]
pub(crate) struct Janitor(Sender<Box<dyn Any + Send>>);

/// The janitor; `None` until it is first needed.
static JANITOR: Mutex<Option<Janitor>> = Mutex::new(None);

impl Janitor {
    /// Returns the janitor; the first call starts the thread.
    ///
    /// # Errors
    /// Fails if the system cannot create the thread.
    pub(crate) fn get() -> io::Result<Self> {
        let mut janitor = JANITOR.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(janitor) = &*janitor {
            return Ok(janitor.clone());
        }
        let (sender, waste) = channel();
        let drop_all = move || {
            for thing in waste {
                // A panic in a destructor affects nothing else.
                let _ = catch_unwind(AssertUnwindSafe(|| drop::<Box<dyn Any + Send>>(thing))).map_err(std::mem::forget);
            }
        };
        thread::Builder::new().name("mdle janitor".to_owned()).spawn(drop_all)?;
        Ok(janitor.insert(Self(sender)).clone())
    }

    /// Drops a value on the janitor's thread, at some later time.
    pub(crate) fn drop_later(&self, thing: impl Any + Send) {
        // If the thread has ended, the value is dropped here.
        let _ = self.0.send(Box::new(thing));
    }
}
