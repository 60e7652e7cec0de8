//! T(8) as rows that are loaded from the text of the plan, as `mdle` loads a plan.

use std::sync::{Arc, LazyLock};

use mdle_compiler::alphabet;
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::load::{self, Loaded, LoadedPlan};
use mdle_runtime::{Machine, Nanos, Turn};

use super::Robot;
use crate::alphabet::Alphabet;
use crate::{Input, Output};

/// Declares machines that run loaded plans, each with the file of the plan's text.
macro_rules! loaded {
    ($($(#[$doc:meta])* $machine:ident $file:literal),+ $(,)?) => {$(
        $(#[$doc])*
        #[allow(missing_debug_implementations, reason = "what is in it is the plan's")]
        pub struct $machine(Machine<LoadedPlan<Alphabet>>);

        impl Robot for $machine {
            fn begin(y: &Output, t: Nanos) -> Self {
                static PLAN: LazyLock<Arc<Loaded<Alphabet>>> =
                    LazyLock::new(|| plan(include_str!(concat!(env!("OUT_DIR"), $file))));
                Self(Machine::begin(PLAN.plan(), y, t))
            }

            #[inline(always)]
            fn turn(&mut self, y: &Output, t: Nanos) -> Turn<Input> {
                turn(&mut self.0, y, t)
            }
        }
    )+};
}

loaded!(
    /// T(8).
    Loaded8 "/rows_8.mdle",
    /// T(8) whose own interrupt has a memory.
    LoadedRising8 "/rows_rising_8.mdle",
);

/// Runs a turn of any loaded plan. All loaded plans have the same type, so the machine's turn is inlined only here.
#[inline(never)]
fn turn(machine: &mut Machine<LoadedPlan<Alphabet>>, y: &Output, t: Nanos) -> Turn<Input> {
    machine.turn(y, t, &mut ())
}

/// Compiles and loads the plan in `text`.
fn plan(text: &str) -> Arc<Loaded<Alphabet>> {
    let mut sources = Sources::default();
    let source = sources.add("alphabet.mdle", ALPHABET);
    let (file, _) = alphabet::read(source, ALPHABET);
    let (robot, _) = alphabet::combine(file.expect("an alphabet"), &[]);
    let (plans, _) = mdle_compiler::compile(sources.add("T.mdle", text), text, &robot, Some("T"));
    let plan = plans.first().expect("a plan");
    load::load(&plan.machine, &sources, &robot).map(Arc::new).expect("a bound alphabet")
}

const ALPHABET: &str = include_str!("../../alphabet.mdle");
