//! The laws, interrupts and signals that `alphabet.mdle` declares itself. `go` is declared there for its ranges: its
//! law is the shared one.

pub use mdle_atoms::Go;
