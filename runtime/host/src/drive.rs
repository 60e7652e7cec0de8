//! A plan that drives a robot, behind one interface without the types of either: the host around the turns is compiled
//! once, and each executable compiles its own turn only.

use std::any::Any;
use std::time::Duration;

use mdle_runtime::{MetersPerSecond, Nanos, Output as _, Plan, Radians, Robot, Sensed, Turn, Twist};

use crate::observer::{Observer, Observes};
use crate::pilot::{Moment, Pilot, PilotFault};
use crate::position::Position;
use crate::report::Report;
use crate::run_end::RunEnd;
use crate::transitions::Transitions;
use crate::{Break, Intervention, Orders, SettingsOf, Supervisor, Verdict};

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
    /// Returns the last output and the input that is sent next, for a record; `None` if they are of other types than a
    /// record has.
    fn exact(&self) -> Option<(&Sensed, Twist)>;
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
    /// Returns what the supervisor did in the last turn.
    fn intervention(&self) -> Option<Intervention<'_>>;
    /// Returns the requests that the supervisor has carried out since the last call.
    fn take_requests(&mut self) -> Vec<String>;
    /// Returns the number of the plan that runs, from 1, and why it has replaced another one.
    fn plan(&self) -> (u64, &str);
    /// Ends the plan for this rule of the supervisor; returns `true` if another plan goes on.
    fn ended_by(&mut self, rule: &str) -> bool;
    /// Calls the supervisor, if there is one, at the break after `turns` turns, the last one at time `t`.
    fn at_break(&mut self, turns: u64, t: Nanos, is_over: bool, report: &Report<'_>) -> Orders;

    /// Returns the robot's observer, if it has one.
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        self.parts().0
    }
}

/// A robot, and the pilot that drives it.
pub(crate) struct PilotOnRobot<'p, R: Robot, B: Pilot> {
    robot: R,
    observer: Observes<R>,
    /// Returns the speed of the robot by an output, if paths are recorded.
    speed: Option<Speed<R>>,
    pilot: B,
    supervised: Option<Supervised<'p, B>>,
    /// Settings of the robot, for the supervisor.
    settings: Option<SettingsOf<R>>,
    /// Time of the last turn.
    t: Nanos,
    output: Option<R::Output>,
    input: R::Input,
}

/// The supervisor of a run, and the plans to which it may divert.
pub(crate) struct Supervised<'p, B: Pilot> {
    pub(crate) supervisor: Box<dyn Supervisor<B> + 'p>,
    pub(crate) diversions: &'p dyn Fn(usize) -> Option<B::Plan>,
}

/// Returns the forward speed of a robot by an output.
type Speed<R> = fn(&<R as Robot>::Output) -> MetersPerSecond;

impl<'p, R, B> PilotOnRobot<'p, R, B>
where
    R: Robot,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    pub(crate) fn new(robot: R, observer: Observes<R>, speed: Option<Speed<R>>, pilot: B) -> Self {
        let (output, input) = (None, R::Input::default());
        Self { robot, observer, speed, pilot, supervised: None, settings: None, t: Nanos::ZERO, output, input }
    }

    /// Puts a supervisor between the plan and the robot, which can change the robot's settings.
    pub(crate) fn supervised(self, supervised: Option<Supervised<'p, B>>, settings: Option<SettingsOf<R>>) -> Self {
        Self { supervised, settings, ..self }
    }

    /// Sets the input that is sent next, as the supervisor changes it.
    fn send(&mut self, asked: R::Input) {
        self.input = match (&mut self.supervised, &self.output) {
            (Some(supervised), Some(y)) => supervised.supervisor.filter(asked, y, self.t),
            (Some(_) | None, _) => asked,
        };
    }

    /// Returns the plan to which the last turn has diverted.
    fn diversion(&self) -> Option<B::Plan> {
        let supervised = self.supervised.as_ref()?;
        match supervised.supervisor.intervention()?.verdict {
            Verdict::Diverted(plan) => (supervised.diversions)(plan),
            Verdict::Limited | Verdict::Held | Verdict::Ended => None,
        }
    }
}

impl<R, B> Drive for PilotOnRobot<'_, R, B>
where
    R: Robot<Output: 'static, Input: 'static>,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    fn exchange(&mut self) -> Result<(), String> {
        self.output = Some(self.robot.exchange(&self.input).map_err(|fault| fault.to_string())?);
        Ok(())
    }

    fn release(&mut self) -> Result<(), String> {
        self.send(R::Input::default());
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

    fn exact(&self) -> Option<(&Sensed, Twist)> {
        let y = (self.output.as_ref()? as &dyn Any).downcast_ref()?;
        Some((y, *(&self.input as &dyn Any).downcast_ref()?))
    }

    fn turn(&mut self, t: Nanos, number: u64, transitions: &mut Transitions) -> Result<Turn<()>, RunEnd> {
        self.t = t;
        let diversion = self.diversion();
        // Without an output no law can compute an input.
        let Some(y) = &mut self.output else { return Ok(Turn::Cut) };
        self.pilot.complete(y, t);
        if let Some(plan) = diversion {
            self.pilot.divert(plan, Moment { y, t, number });
        }
        let turn = self.pilot.turn(Moment { y, t, number }, transitions).map_err(|fault| match fault {
            PilotFault::Stopped(sentence) => RunEnd::Pilot(sentence),
            PilotFault::Panicked(message) => RunEnd::Bug(message),
        })?;
        let kind = match turn {
            Turn::Law(_) => Turn::Law(()),
            Turn::Cut => Turn::Cut,
            Turn::Over => Turn::Over,
        };
        self.send(turn.input());
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

    fn intervention(&self) -> Option<Intervention<'_>> {
        self.supervised.as_ref().and_then(|supervised| supervised.supervisor.intervention())
    }

    fn take_requests(&mut self) -> Vec<String> {
        self.supervised.as_mut().map(|supervised| supervised.supervisor.take_requests()).unwrap_or_default()
    }

    fn plan(&self) -> (u64, &str) {
        (self.pilot.plan_number(), self.pilot.reason())
    }

    fn ended_by(&mut self, rule: &str) -> bool {
        self.pilot.ended_by(rule)
    }

    fn at_break(&mut self, turns: u64, t: Nanos, is_over: bool, report: &Report<'_>) -> Orders {
        let Self { robot, supervised: Some(supervised), settings, output: Some(y), input, pilot, .. } = self else {
            return Orders::default();
        };
        let (settings, course) = (settings.map(|settings| settings(robot)), report.course());
        supervised.supervisor.at_break(&mut Break { turns, t, y, input, is_over, pilot, settings, course })
    }
}
