//! What emulated robots share, whatever their languages: the pseudo-terminal, how time passes, and their programs.
#![forbid(unsafe_code)]

mod fault;
mod port;
mod program;
mod serve;

pub use fault::{Ailment, At, Fault, Faulty};
pub use port::Port;
pub use program::{Options, program};
pub use serve::{Emulated, Pace, STEP, serve};
