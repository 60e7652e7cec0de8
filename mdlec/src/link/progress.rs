//! Represents the progress of a build, so that it can be shown.

use std::fmt;

/// A step of a build. A build that compiles only the plan reports no steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BuildStep {
    /// Another mdlec is building; the field is the number of its process, if it is known. This build continues
    /// afterwards.
    Waiting(Option<u32>),
    /// Cargo waits for a lock that is held by a cargo that mdlec did not start.
    Blocked,
    /// Cargo fetches libraries that are not on this machine yet.
    Fetching,
    /// The libraries in the cache are damaged or were replaced, so all of them are compiled again.
    Mending,
    /// Compiled files in the cache differ from those that cargo wrote, and are compiled again.
    Discarding,
    /// Number of crates compiled so far, counted from 1 and without the plan itself.
    Compiling(usize),
}

impl BuildStep {
    /// Returns `true` for the first report of a step. Returns `false` for later reports of the same step, which contain
    /// a higher number.
    #[must_use]
    pub fn is_first(&self) -> bool {
        match self {
            Self::Waiting(_)
            | Self::Blocked
            | Self::Fetching
            | Self::Mending
            | Self::Discarding
            | Self::Compiling(1) => true,
            Self::Compiling(_) => false,
        }
    }
}

impl fmt::Display for BuildStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Waiting(None) => f.write_str("waiting for another mdlec to finish its build"),
            Self::Waiting(Some(process)) => {
                write!(f, "waiting for another mdlec to finish its build (process {process})")
            }
            Self::Blocked => f.write_str("waiting for another cargo to finish, which uses the same libraries"),
            Self::Discarding => {
                f.write_str("compiled files in the cache are not as cargo wrote them: they are compiled again")
            }
            Self::Fetching => f.write_str("fetching the libraries that programs are built on; only the first time"),
            Self::Mending => f.write_str("the cache is damaged: all libraries are compiled again"),
            Self::Compiling(1) => f.write_str("compiling libraries; only the first time takes long"),
            Self::Compiling(done) => {
                write!(f, "compiling libraries; only the first time takes long ({done} crates)")
            }
        }
    }
}
