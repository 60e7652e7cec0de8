//! T(N) as mdlec emits it, with entry times, laws that may have a state, and a limit on the transitions of a turn.

use mdle_runtime::{Machine, Nanos, Plan, Turn};

use super::Robot;
use crate::{Input, Output};

/// Includes each emitted file as a separate module.
macro_rules! emitted {
    ($($module:ident $file:literal),+) => {$(
        #[allow(missing_docs, reason = "mdlec wrote it")]
        mod $module {
            include!(concat!(env!("OUT_DIR"), $file));
        }
    )+};
}

emitted!(plan_8 "/plan_8.rs", rows_8 "/rows_8.rs", rows_rising_8 "/rows_rising_8.rs");
#[cfg(feature = "thousands")]
emitted!(plan_1000 "/plan_1000.rs", plan_100000 "/plan_100000.rs");

/// A plan on the run-time system's machine.
#[allow(missing_debug_implementations, reason = "what is in it is the plan's")]
pub struct Compiled<P: Plan>(Machine<P>);

/// T(8): emitted as code with an arm for each atom.
pub type Plan8 = Compiled<plan_8::T>;
/// T(8): emitted as rows of tables.
pub type Rows8 = Compiled<rows_8::T>;
/// T(8) whose own interrupt has a memory: emitted as rows of tables.
pub type RowsRising8 = Compiled<rows_rising_8::T>;
/// T(1000): emitted as rows of tables.
#[cfg(feature = "thousands")]
pub type Plan1000 = Compiled<plan_1000::T>;
/// T(100000): emitted as rows of tables.
#[cfg(feature = "thousands")]
pub type Plan100000 = Compiled<plan_100000::T>;

impl<P: Plan<Output = Output, Input = Input> + Default> Robot for Compiled<P> {
    fn begin(y: &Output, t: Nanos) -> Self {
        Self(Machine::begin(P::default(), y, t))
    }

    #[inline(never)]
    fn turn(&mut self, y: &Output, t: Nanos) -> Turn<Input> {
        self.0.turn(y, t, &mut ())
    }
}
