//! A plan that drives a robot, behind one interface without the types of either: the host around the turns is compiled
//! once, and each executable compiles its own turn only.

use std::time::Duration;

use mdle_runtime::{Frame, Fsm, Machine, MetersPerSecond, Nanos, Output as _, Plan, Radians, Robot, Turn, Words};

use crate::observer::{Observer, Observes};
use crate::pilot::{Moment, Pilot, PilotFault};
use crate::run_end::RunEnd;
use crate::transitions::Transitions;

/// Texts and tables of a plan, for reports: [`Plan`] without the types of its robot.
pub(crate) trait Texts {
    /// The machine's tables.
    fn fsm(&self) -> Fsm<'_>;
    /// The quark text of an atom's law.
    fn law(&self, atom: u32) -> &str;
    /// The condition text of a scope's interrupt, by its bracket.
    fn condition(&self, scope: u32) -> &str;
    /// The name of a scope, by its bracket; empty for an atom.
    fn name(&self, scope: u32) -> &str;
    /// The words and places of the plan's text, if it has one.
    fn source(&self) -> &dyn Words;
    /// Returns the names of the paths that its laws replay.
    fn paths(&self) -> &[&'static str];
}

impl<P: Plan> Texts for P {
    fn fsm(&self) -> Fsm<'_> {
        Plan::fsm(self)
    }

    fn law(&self, atom: u32) -> &str {
        Plan::law(self, atom)
    }

    fn condition(&self, scope: u32) -> &str {
        Plan::condition(self, scope)
    }

    fn name(&self, scope: u32) -> &str {
        Plan::name(self, scope)
    }

    fn source(&self) -> &dyn Words {
        Plan::source(self)
    }

    fn paths(&self) -> &[&'static str] {
        Plan::paths(self)
    }
}

/// The position in a plan that runs, for reports: [`Machine`] without the types of its plan.
pub(crate) trait Position {
    /// The plan's texts.
    fn texts(&self) -> &dyn Texts;
    /// The number of the current state in the expanded plan.
    fn state(&self) -> u64;
    /// Returns the index of the current atom in source order, from 0; `None` when the plan is over.
    fn atom(&self) -> Option<u32>;
    /// Frame of the current atom if a `FRAME here` encloses it.
    fn frame(&self) -> Option<Frame>;
    /// The bracket of the enclosing scope of this level.
    fn scope(&self, level: u16) -> u32;
    /// Time since the enclosing scope of this level was entered, at time `t`.
    fn since(&self, level: u16, t: Nanos) -> Nanos;
}

impl<P: Plan> Position for Machine<P> {
    fn texts(&self) -> &dyn Texts {
        self.plan()
    }

    fn state(&self) -> u64 {
        self.state()
    }

    fn atom(&self) -> Option<u32> {
        self.atom()
    }

    fn frame(&self) -> Option<Frame> {
        self.frame()
    }

    fn scope(&self, level: u16) -> u32 {
        self.cursor().scope(self.plan().fsm(), level)
    }

    fn since(&self, level: u16, t: Nanos) -> Nanos {
        self.cursor().since(level, t)
    }
}

/// A robot with the plan that drives it: exchange and turn alternate, the exchange first.
pub(crate) trait Drive {
    /// Sends the input of the last turn, the null input before the first, and takes the output that follows.
    ///
    /// # Errors
    /// A sentence for the operator about the fault of the robot.
    fn exchange(&mut self) -> Result<(), String>;
    /// Sends the null input.
    ///
    /// # Errors
    /// A sentence for the operator about the fault of the robot.
    fn release(&mut self) -> Result<(), String>;
    /// Stops the robot.
    ///
    /// # Errors
    /// A sentence for the operator about the fault of the robot.
    fn stop(&mut self) -> Result<(), String>;
    /// Returns [`Robot::longest_gap`].
    fn longest_gap(&self) -> Option<Duration>;
    /// Returns the heading and the speed of the robot by its last output, if it has one and paths are recorded.
    fn motion(&self) -> Option<(Radians, MetersPerSecond)>;
    /// Makes turn `number` with the last output at time `t`; the first turn begins the plan.
    ///
    /// # Errors
    /// Why the run has to end, though the robot is well.
    fn turn(&mut self, t: Nanos, number: u64, transitions: &mut Transitions) -> Result<Turn<()>, RunEnd>;
    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, say: &mut dyn FnMut(&str));
    /// Returns the robot's observer, if it has one, and the position in the plan, if it has begun.
    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>);
    /// Returns the time of the run at which the plan began.
    fn zero(&self) -> Nanos;

    /// Returns the robot's observer, if it has one.
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        self.parts().0
    }
}

/// A robot, and the pilot that drives it.
pub(crate) struct PilotOnRobot<R: Robot, B> {
    robot: R,
    observer: Observes<R>,
    /// Returns the speed of the robot by an output, if paths are recorded.
    speed: Option<Speed<R>>,
    pilot: B,
    output: Option<R::Output>,
    input: R::Input,
}

/// Returns the forward speed of a robot by an output.
type Speed<R> = fn(&<R as Robot>::Output) -> MetersPerSecond;

impl<R: Robot, B> PilotOnRobot<R, B> {
    pub(crate) fn new(robot: R, observer: Observes<R>, speed: Option<Speed<R>>, pilot: B) -> Self {
        Self { robot, observer, speed, pilot, output: None, input: R::Input::default() }
    }
}

impl<R, B> Drive for PilotOnRobot<R, B>
where
    R: Robot,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    fn exchange(&mut self) -> Result<(), String> {
        self.output = Some(self.robot.exchange(&self.input).map_err(|fault| fault.to_string())?);
        Ok(())
    }

    fn release(&mut self) -> Result<(), String> {
        self.input = R::Input::default();
        self.exchange()
    }

    fn stop(&mut self) -> Result<(), String> {
        self.robot.stop().map_err(|fault| fault.to_string())
    }

    fn longest_gap(&self) -> Option<Duration> {
        self.robot.longest_gap()
    }

    fn motion(&self) -> Option<(Radians, MetersPerSecond)> {
        let (output, speed) = (self.output.as_ref()?, self.speed?);
        Some((output.here().theta, speed(output)))
    }

    fn turn(&mut self, t: Nanos, number: u64, transitions: &mut Transitions) -> Result<Turn<()>, RunEnd> {
        // Without an output no law can compute an input.
        let Some(y) = &self.output else { return Ok(Turn::Cut) };
        let turn = self.pilot.turn(Moment { y, t, number }, transitions).map_err(|fault| match fault {
            PilotFault::Stopped(sentence) => RunEnd::Pilot(sentence),
            PilotFault::Panicked(message) => RunEnd::Bug(message),
        })?;
        let kind = match turn {
            Turn::Law(_) => Turn::Law(()),
            Turn::Cut => Turn::Cut,
            Turn::Over => Turn::Over,
        };
        self.input = turn.input();
        Ok(kind)
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.pilot.messages(say);
    }

    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>) {
        let observer = self.observer.map(|observer| observer(&mut self.robot));
        (observer, self.pilot.machine().map(|machine| machine as _))
    }

    fn zero(&self) -> Nanos {
        self.pilot.zero()
    }
}
