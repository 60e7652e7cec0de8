//! A plan that drives a robot, behind one interface without the types of either: the host around the turns is compiled
//! once, and each executable compiles its own turn only.

use std::any::Any;
use std::time::Duration;

use mdle_record::Change;
use mdle_runtime::{MetersPerSecond, Nanos, Output as _, Plan, Radians, Robot, Sensed, Turn, Twist};

use crate::helm::Helm;
use crate::observer::{Observer, Observes};
use crate::pilot::{Pilot, PilotFault};
use crate::position::Position;
use crate::report::Report;
use crate::run_end::RunEnd;
use crate::transitions::Transitions;
use crate::{Break, Intervention, Orders, SettingsOf, Supervisor};

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
    /// Returns the last output, for views of the run; `None` if there is none yet, or if it is of another type.
    fn sensed(&self) -> Option<&Sensed>;
    /// Returns the last output and input, for a record; `None` if they are of other types than a record has.
    fn exact(&self) -> Option<Exact<'_>>;
    /// Notes from now on what [`Drive::take_changes`] returns: called before the first turn.
    fn record(&mut self);
    /// Takes the causes of the last turn besides its output.
    fn take_changes(&mut self) -> Vec<Change>;
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

/// The output and the input of a turn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exact<'y> {
    /// The robot's output.
    pub(crate) y: &'y Sensed,
    /// The input that the plan asked for.
    pub(crate) asked: Twist,
    /// The input that is sent.
    pub(crate) sent: Twist,
}

/// A robot, and the pilot that drives it.
pub(crate) struct PilotOnRobot<'p, R: Robot, B: Pilot> {
    robot: R,
    observer: Observes<R>,
    /// Returns the speed of the robot by an output, if paths are recorded.
    speed: Option<Speed<R>>,
    helm: Helm<'p, B>,
    /// Settings of the robot, for the supervisor.
    settings: Option<SettingsOf<R>>,
    output: Option<R::Output>,
}

/// Returns the forward speed of a robot by an output.
type Speed<R> = fn(&<R as Robot>::Output) -> MetersPerSecond;

impl<'p, R, B> PilotOnRobot<'p, R, B>
where
    R: Robot,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    pub(crate) fn new(robot: R, observer: Observes<R>, speed: Option<Speed<R>>, helm: Helm<'p, B>) -> Self {
        Self { robot, observer, speed, helm, settings: None, output: None }
    }

    /// Lets the supervisor change these settings of the robot.
    pub(crate) fn with_settings(self, settings: Option<SettingsOf<R>>) -> Self {
        Self { settings, ..self }
    }
}

impl<R, B> Drive for PilotOnRobot<'_, R, B>
where
    R: Robot<Output: 'static, Input: 'static>,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    fn exchange(&mut self) -> Result<(), String> {
        self.output = Some(self.robot.exchange(self.helm.input()).map_err(|fault| fault.to_string())?);
        Ok(())
    }

    fn release(&mut self) -> Result<(), String> {
        self.helm.send(R::Input::default(), self.output.as_ref());
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

    fn sensed(&self) -> Option<&Sensed> {
        (self.output.as_ref()? as &dyn Any).downcast_ref()
    }

    fn exact(&self) -> Option<Exact<'_>> {
        let y = self.sensed()?;
        let sent = (self.helm.input() as &dyn Any).downcast_ref()?;
        Some(Exact { y, asked: self.helm.asked()?, sent: *sent })
    }

    fn record(&mut self) {
        self.helm.record();
    }

    fn take_changes(&mut self) -> Vec<Change> {
        self.helm.take_changes()
    }

    fn turn(&mut self, t: Nanos, number: u64, transitions: &mut Transitions) -> Result<Turn<()>, RunEnd> {
        // Without an output no law can compute an input.
        let Some(y) = &mut self.output else { return Ok(Turn::Cut) };
        self.helm.turn(y, t, number, transitions).map_err(|fault| match fault {
            PilotFault::Stopped(sentence) => RunEnd::Pilot(sentence),
            PilotFault::Panicked(message) => RunEnd::Bug(message),
        })
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.helm.pilot_mut().messages(say);
    }

    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>) {
        let observer = self.observer.map(|observer| observer(&mut self.robot));
        (observer, self.helm.pilot().machine().map(|machine| machine as _))
    }

    fn zero(&self) -> Nanos {
        self.helm.pilot().zero()
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        self.helm.intervention()
    }

    fn take_requests(&mut self) -> Vec<String> {
        self.helm.supervisor_mut().map(Supervisor::take_requests).unwrap_or_default()
    }

    fn plan(&self) -> (u64, &str) {
        (self.helm.pilot().plan_number(), self.helm.pilot().reason())
    }

    fn ended_by(&mut self, rule: &str) -> bool {
        self.helm.pilot_mut().ended_by(rule)
    }

    fn at_break(&mut self, turns: u64, t: Nanos, is_over: bool, report: &Report<'_>) -> Orders {
        let Self { robot, helm, settings, output: Some(y), .. } = self else { return Orders::default() };
        let Some((supervisor, pilot, input)) = helm.parts() else { return Orders::default() };
        let (settings, course) = (settings.map(|settings| settings(robot)), report.course());
        supervisor.at_break(&mut Break { turns, t, y, input, is_over, pilot, settings, course })
    }
}
