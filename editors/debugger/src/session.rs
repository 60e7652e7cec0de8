//! The state of a session in which a client debugs a plan.

use crate::breakpoints::Breakpoints;
use crate::client::Client;
use crate::launch::Loaded;
use crate::run::Run;
use crate::variables::Lists;

/// Numbers of the first line and of the first column for the client, 0 or 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base {
    pub(crate) line: u32,
    pub(crate) column: u32,
}

/// A plan that is being debugged.
pub(crate) struct Session<'l, 'c, 'o> {
    pub(crate) loaded: &'l Loaded,
    pub(crate) run: Run<'l>,
    pub(crate) breakpoints: Breakpoints,
    pub(crate) lists: Lists,
    pub(crate) base: Base,
    pub(crate) client: &'c mut Client<'o>,
}
