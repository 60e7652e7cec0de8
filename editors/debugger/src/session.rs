//! The state of a debugging session.

use crate::breakpoints::Breakpoints;
use crate::client::Client;
use crate::launch::LaunchedPlan;
use crate::run::DebugRun;
use crate::variables::Lists;

/// Numbers that the first line and the first column have in the client's messages: 0 or 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base {
    pub(crate) line: u32,
    pub(crate) column: u32,
}

/// The session of a client that debugs a plan.
pub(crate) struct DebugSession<'l, 'c, 'o> {
    pub(crate) loaded: &'l LaunchedPlan,
    pub(crate) run: DebugRun<'l>,
    pub(crate) breakpoints: Breakpoints,
    pub(crate) lists: Lists,
    pub(crate) base: Base,
    pub(crate) client: &'c mut Client<'o>,
}
