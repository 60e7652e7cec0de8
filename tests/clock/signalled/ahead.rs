//! A plan that drives ahead for a second, as an executable for two robots. The environment variable `ROBOT` selects the
//! robot. Called as `ahead run PLAN`, the program is `mdle` with a module that takes 40 ms of each turn.

use std::process::ExitCode;
use std::thread;
use std::time::Duration;

use mdle::engine::{Fault, Module, Turn};
use mdle_atrv::Target as Atrv;
use mdle_host::run;
use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Begin, Cause, Cursor, Ending, Fsm, MetersPerSecond, Nanos, Plan, Sensed, Twist};
use mdle_scout::Target as Scout;

fn main() -> ExitCode {
    if std::env::args_os().nth(1).is_some_and(|word| word == "run") {
        mdle::main_with(|library| library.registered("slow", |_| Slow))
    } else if std::env::var_os("ROBOT").is_some_and(|robot| robot == "scout") {
        run::<Scout, _>("Ahead", || Ahead)
    } else {
        run::<Atrv, _>("Ahead", || Ahead)
    }
}

/// A module that takes 40 ms of each turn.
struct Slow;

impl Module<Sensed> for Slow {
    fn turn(&mut self, _: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        thread::sleep(Duration::from_millis(40));
        Ok(())
    }
}

/// The plan `{ Ahead (wait 1s) (Atom (null) go 20 0) }`.
struct Ahead;

const SECOND: Nanos = Nanos(1_000_000_000);
const FSM: Fsm<'static> = Fsm {
    brackets: &[Bracket::scope(0, 0, 0, 0), Bracket::scope(1, 0, 0, 0)],
    atoms: &[Atom::new(1, 1)],
    termination: 2,
};

impl Plan for Ahead {
    type Output = Sensed;
    type Input = Twist;
    type Entered = [Nanos; 2];
    type Left = [u64; 0];

    fn fsm(&self) -> Fsm<'_> {
        FSM
    }

    fn slots(&self) -> ([Nanos; 2], [u64; 0]) {
        ([Nanos::ZERO; 2], [])
    }

    fn enter(&mut self, _: u32, _: &Sensed, _: Begin) {}

    fn next(&self, cursor: &Cursor<[Nanos; 2], [u64; 0]>, _: &Sensed, t: Nanos) -> Option<Ending> {
        (cursor.since(0, t) >= SECOND).then(|| Cause::Fired(0).into())
    }

    fn input(&mut self, _: &Sensed, _: Nanos) -> Twist {
        Twist { v: MetersPerSecond(0.2), ..Twist::default() }
    }

    fn law(&self, _: u32) -> &str {
        "go 20 0"
    }

    fn condition(&self, scope: u32) -> &str {
        if scope == 0 { "wait 1s" } else { "null" }
    }

    fn name(&self, scope: u32) -> &str {
        if scope == 0 { "Ahead" } else { "" }
    }
}
