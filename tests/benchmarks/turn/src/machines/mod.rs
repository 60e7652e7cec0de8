//! T(N) in several forms. All machines behave equally, as `tests/same.rs` asserts.

pub mod by_hand;
pub mod loaded;
pub mod plan;
pub mod smlang;
pub mod statig;

use mdle_runtime::{Nanos, Turn};

use crate::{Input, Output};

/// A machine that runs T(N). Its turn is not inlined into the calling loop, because it would not be inlined into a
/// robot's driver either.
pub trait Robot {
    /// Returns the plan at its first atom.
    fn begin(y: &Output, t: Nanos) -> Self;
    /// Makes transitions until no condition fires; the plan's own interrupt takes precedence. Then applies the law of
    /// the current atom.
    fn turn(&mut self, y: &Output, t: Nanos) -> Turn<Input>;
}

/// A machine that does nothing, to measure the cost of the calling loop.
#[derive(Debug)]
pub struct Nothing;

impl Robot for Nothing {
    fn begin(_: &Output, _: Nanos) -> Self {
        Self
    }

    #[inline(never)]
    fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {
        if y.halt { Turn::Over } else { Turn::Law(Input { left: 1.25, right: 0.5 }) }
    }
}
