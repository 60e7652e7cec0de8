//! A thread that drops what the control thread no longer needs: large plans, and modules, whose code runs then.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Sender, channel};
use std::thread;

/// The thread; it ends once this value is dropped, and everything before it.
pub(crate) struct Janitor(Sender<Box<dyn Any + Send>>);

impl Janitor {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn new() -> io::Result<Self> {
        let (sender, waste) = channel();
        let drop_all = move || {
            for thing in waste {
                // A panic while it is dropped concerns nobody else.
                let _ = catch_unwind(AssertUnwindSafe(|| drop::<Box<dyn Any + Send>>(thing))).map_err(std::mem::forget);
            }
        };
        thread::Builder::new().name("mdle janitor".to_owned()).spawn(drop_all)?;
        Ok(Self(sender))
    }

    /// Drops a value on the janitor's thread, soon.
    pub(crate) fn drop_later(&self, thing: impl Any + Send) {
        // Without its thread the value is dropped here.
        let _ = self.0.send(Box::new(thing));
    }
}
