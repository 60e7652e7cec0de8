//! T(N) as transitions of the crate smlang. An event contains the robot's output, and the context contains the result
//! of an action.

use mdle_runtime::{Nanos, Turn};

use super::Robot;
use crate::{Input, Output};

/// Result of an action.
#[derive(Debug, Default)]
pub struct Context {
    turn: Option<Turn<Input>>,
}

/// Includes each generated machine as a separate module, with the type that runs its turns.
macro_rules! machines {
    ($($module:ident $machine:ident $file:literal),+) => {$(
        #[allow(missing_docs, clippy::result_unit_err, reason = "as smlang has it")]
        mod $module {
            use mdle_runtime::Turn as PlanTurn;
            use smlang::statemachine;

            use super::{Context, Input, Output};

            include!(concat!(env!("OUT_DIR"), $file));
        }

        /// A machine that is sent the turn's event until one of its actions has set the input.
        #[allow(missing_debug_implementations, reason = "smlang's machine has none")]
        pub struct $machine($module::StateMachine<Context>);

        impl Robot for $machine {
            fn begin(_: &Output, _: Nanos) -> Self {
                Self($module::StateMachine::new(Context::default()))
            }

            #[inline(never)]
            fn turn(&mut self, y: &Output, _: Nanos) -> Turn<Input> {
                self.0.context_mut().turn = None;
                loop {
                    // An error is impossible: each state has a transition without a guard.
                    let _ = self.0.process_event($module::Events::Turn(y));
                    if let Some(turn) = self.0.context().turn {
                        return turn;
                    }
                }
            }
        }
    )+};
}

machines!(eight Smlang8 "/smlang_8.rs");
#[cfg(feature = "thousands")]
machines!(thousand Smlang1000 "/smlang_1000.rs");
