//! The threads of the middleware, which end for good when the program is suspended: the system then interrupts their
//! wait for messages, which RustDDS takes for an error.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folder with an entry for each thread of this program.
const THREADS: &str = "/proc/self/task";
/// Beginning of the names of the middleware's threads.
const NAME: &str = "RustDDS";
/// Number of threads of a participant: one for messages, and one for discovery.
const COUNT: usize = 2;

/// The threads of one participant.
#[derive(Debug)]
pub(crate) struct MiddlewareThreads(Vec<PathBuf>);

impl MiddlewareThreads {
    /// Returns the threads of all participants of this program.
    ///
    /// # Errors
    /// Fails if the system does not list the threads.
    pub(crate) fn all() -> io::Result<Self> {
        let entries = fs::read_dir(THREADS)?.collect::<io::Result<Vec<_>>>()?;
        let threads = entries.into_iter().map(|entry| entry.path());
        Ok(Self(threads.filter(|thread| is_of_middleware(thread)).collect()))
    }

    /// Returns the threads that are not among `others`.
    pub(crate) fn without(mut self, others: &Self) -> Self {
        self.0.retain(|thread| !others.0.contains(thread));
        self
    }

    /// Returns `true` if the participant has all its threads. The call takes a few microseconds, and allocates nothing.
    pub(crate) fn are_alive(&self) -> bool {
        self.0.len() >= COUNT && self.0.iter().all(|thread| thread.exists())
    }
}

/// Returns `true` if `thread` has a name that the middleware gives.
fn is_of_middleware(thread: &Path) -> bool {
    // A thread that has just ended has no name.
    fs::read_to_string(thread.join("comm")).is_ok_and(|name| name.starts_with(NAME))
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::thread::{Builder, sleep};
    use std::time::Duration;

    use super::*;

    #[test]
    fn an_ended_thread_is_noticed() {
        let before = MiddlewareThreads::all().unwrap();
        let (begun, beginnings) = mpsc::channel();
        let threads = ["RustDDS discovery thread", "RustDDS Participant 0 event loop", "another"].map(|name| {
            let (end, ending) = mpsc::channel::<()>();
            let begun = begun.clone();
            let body = move || {
                begun.send(()).unwrap();
                let _ = ending.recv();
            };
            (end, Builder::new().name(name.to_owned()).spawn(body).unwrap())
        });
        threads.iter().for_each(|_| beginnings.recv().unwrap());
        let watched = MiddlewareThreads::all().unwrap().without(&before);
        assert_eq!(watched.0.len(), COUNT);
        assert!(watched.are_alive());
        let [first, second, _other] = threads;
        drop(second.0);
        second.1.join().unwrap();
        // A joined thread may still be in the list for a moment.
        (0..1000).take_while(|_| watched.are_alive()).for_each(|_| sleep(Duration::from_millis(1)));
        assert!(!watched.are_alive());
        drop(first.0);
        first.1.join().unwrap();
        assert!(!MiddlewareThreads(Vec::new()).are_alive(), "of which none was found");
    }
}
