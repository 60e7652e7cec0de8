//! T(N) as a person would write it by hand: as a `match`, and as a table with a loop over it.

use mdle_runtime::{Nanos, Turn};

use super::Robot;
use crate::{Input, Output};

/// T(8) as a `match`.
#[derive(Debug)]
pub struct Match8 {
    state: u32,
}

impl Robot for Match8 {
    fn begin(_: &Output, _: Nanos) -> Self {
        Self { state: 0 }
    }

    #[inline(never)]
    fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {
        if self.state == 8 || y.halt {
            self.state = 8;
            return Turn::Over;
        }
        loop {
            match self.state {
                0 if y.measured >= 1.0 => self.state = 1,
                1 if y.measured >= 2.0 => self.state = 2,
                2 if y.measured >= 3.0 => self.state = 3,
                3 if y.measured >= 4.0 => self.state = 4,
                4 if y.measured >= 5.0 => self.state = 5,
                5 if y.measured >= 6.0 => self.state = 6,
                6 if y.measured >= 7.0 => self.state = 7,
                7 if y.measured >= 8.0 => self.state = 8,
                0 => return Turn::Law(Input { left: 1.25, right: 0.5 }),
                1 => return Turn::Law(Input { left: 2.25, right: 1.5 }),
                2 => return Turn::Law(Input { left: 3.25, right: 2.5 }),
                3 => return Turn::Law(Input { left: 4.25, right: 3.5 }),
                4 => return Turn::Law(Input { left: 5.25, right: 4.5 }),
                5 => return Turn::Law(Input { left: 6.25, right: 5.5 }),
                6 => return Turn::Law(Input { left: 7.25, right: 6.5 }),
                7 => return Turn::Law(Input { left: 8.25, right: 7.5 }),
                _ => return Turn::Over,
            }
        }
    }
}

/// T(1000) as a `match`, which nobody writes by hand.
#[cfg(feature = "thousands")]
mod thousand {
    use super::{Input, Nanos, Output, Robot, Turn};

    include!(concat!(env!("OUT_DIR"), "/match_1000.rs"));
}

#[cfg(feature = "thousands")]
pub use thousand::Match as Match1000;

/// T(8) as a `match` with arms in the form of those of `Match1000`.
mod eight {
    use super::{Input, Nanos, Output, Robot, Turn};

    include!(concat!(env!("OUT_DIR"), "/match_8.rs"));
}

pub use eight::Match as NestedMatch8;

/// T(N) as a table of limits and inputs.
#[derive(Debug)]
pub struct Table<const N: usize> {
    state: usize,
}

struct Row {
    limit: f64,
    input: Input,
}

#[allow(clippy::cast_precision_loss, reason = "far fewer atoms than a double counts exactly")]
const fn rows<const N: usize>() -> [Row; N] {
    let mut rows = [const { Row { limit: 0.0, input: Input { left: 0.0, right: 0.0 } } }; N];
    let mut atom = 0;
    while atom < N {
        let number = atom as f64;
        rows[atom] = Row { limit: number + 1.0, input: Input { left: number + 1.25, right: number + 0.5 } };
        atom += 1;
    }
    rows
}

impl<const N: usize> Table<N> {
    const ROWS: &'static [Row; N] = &rows();
}

impl<const N: usize> Robot for Table<N> {
    fn begin(_: &Output, _: Nanos) -> Self {
        Self { state: 0 }
    }

    #[inline(never)]
    fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {
        if y.halt {
            self.state = N;
        }
        while let Some(row) = Self::ROWS.get(self.state) {
            if y.measured < row.limit {
                return Turn::Law(row.input);
            }
            self.state += 1;
        }
        Turn::Over
    }
}
