//! T(N) as states of the crate statig. An event contains the robot's output, and the context contains the result of a
//! state.

use mdle_runtime::{Nanos, Turn};
use statig::blocking::InitializedStateMachine;
use statig::prelude::*;

use super::Robot;
use crate::{Input, Output};

/// Includes each generated state chart as a separate module, with the type that runs its turns.
macro_rules! charts {
    ($($module:ident $machine:ident $file:literal),+) => {$(
        mod $module {
            use super::*;

            include!(concat!(env!("OUT_DIR"), $file));
        }

        /// A chart that is run until one of its states has set the input.
        #[allow(missing_debug_implementations, reason = "statig's machine has none")]
        pub struct $machine(InitializedStateMachine<$module::Chart>);

        impl Robot for $machine {
            fn begin(_: &Output, _: Nanos) -> Self {
                Self($module::Chart.uninitialized_state_machine().init_with_context(&mut None))
            }

            #[inline(never)]
            fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {
                let mut turn = None;
                loop {
                    self.0.handle_with_context(y, &mut turn);
                    if let Some(turn) = turn {
                        return turn;
                    }
                }
            }
        }
    )+};
}

charts!(eight Statig8 "/statig_8.rs");
#[cfg(feature = "thousands")]
charts!(thousand Statig1000 "/statig_1000.rs");
