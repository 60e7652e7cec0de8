//! Executables on emulated robots by the clock: signals, suspension and faults. Nothing else runs beside these tests.

mod faults;
mod signalled;
mod stands;
