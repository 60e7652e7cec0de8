//! A plan that drives a robot, behind one interface without the types of either: the host around the turns is compiled
//! once, and each executable compiles its own turn only.

use std::time::Duration;

use mdle_runtime::{Frame, Fsm, Machine, MetersPerSecond, Nanos, Output as _, Plan, Radians, Robot, Turn, Words};

use crate::observer::{Observer, Observes};
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
    /// Makes a turn with the last output at time `t`; the first turn begins the plan.
    fn turn(&mut self, t: Nanos, transitions: &mut Transitions) -> Turn<()>;
    /// Returns the robot's observer, if it has one, and the position in the plan, if it has begun.
    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>);

    /// Returns the robot's observer, if it has one.
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        self.parts().0
    }
}

/// A robot, and the plan that drives it.
pub(crate) struct PlanOnRobot<'p, R: Robot, P: Plan<Output = R::Output, Input = R::Input>> {
    robot: R,
    observer: Observes<R>,
    /// Returns the speed of the robot by an output, if paths are recorded.
    speed: Option<Speed<R>>,
    /// Makes the plan.
    plan: &'p dyn Fn() -> P,
    machine: Option<Machine<P>>,
    output: Option<R::Output>,
    input: R::Input,
}

/// Returns the forward speed of a robot by an output.
type Speed<R> = fn(&<R as Robot>::Output) -> MetersPerSecond;

impl<'p, R: Robot, P: Plan<Output = R::Output, Input = R::Input>> PlanOnRobot<'p, R, P> {
    pub(crate) fn new(robot: R, observer: Observes<R>, speed: Option<Speed<R>>, plan: &'p dyn Fn() -> P) -> Self {
        Self { robot, observer, speed, plan, machine: None, output: None, input: R::Input::default() }
    }
}

impl<R: Robot, P: Plan<Output = R::Output, Input = R::Input>> Drive for PlanOnRobot<'_, R, P> {
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

    fn turn(&mut self, t: Nanos, transitions: &mut Transitions) -> Turn<()> {
        // Without an output no law can compute an input.
        let Some(y) = &self.output else { return Turn::Cut };
        let machine = self.machine.get_or_insert_with(|| Machine::begin((self.plan)(), y, t));
        let turn = machine.turn(y, t, transitions);
        let kind = match turn {
            Turn::Law(_) => Turn::Law(()),
            Turn::Cut => Turn::Cut,
            Turn::Over => Turn::Over,
        };
        self.input = turn.input();
        kind
    }

    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>) {
        let observer = self.observer.map(|observer| observer(&mut self.robot));
        (observer, self.machine.as_ref().map(|machine| machine as _))
    }
}
