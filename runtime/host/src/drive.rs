//! Interface to a plan on its robot, independent of the types of the plan and the robot. The host is therefore compiled
//! only once; each executable compiles only its own turn.

use std::any::Any;
use std::time::Duration;

use mdle_record::RecordedChange;
use mdle_runtime::{MetersPerSecond, Nanos, Output as _, Plan, Radians, Robot, Sensed, Turn, Twist};

use crate::helm::Helm;
use crate::observer::{Observer, Observes};
use crate::pilot::{AfterPlan, Pilot, PilotFault};
use crate::position::Position;
use crate::report::ReportWriter;
use crate::run_end::RunEnd;
use crate::timing::Timing;
use crate::transitions::Transitions;
use crate::{Break, BreakOrders, Intervention, SettingsOf, Supervisor};

/// A robot with the plan that drives it. Exchanges and turns alternate, and an exchange comes first.
pub(crate) trait Drive {
    /// Sends the input of the last turn, or the null input before the first turn, and reads the next output.
    ///
    /// # Errors
    /// Returns a message for the operator if the robot has a fault.
    fn exchange(&mut self) -> Result<(), String>;
    /// Sends the null input.
    ///
    /// # Errors
    /// Returns a message for the operator if the robot has a fault.
    fn release(&mut self) -> Result<(), String>;
    /// Stops the robot.
    ///
    /// # Errors
    /// Returns a message for the operator if the robot has a fault.
    fn stop(&mut self) -> Result<(), String>;
    /// Returns the value of [`Robot::longest_gap`].
    fn longest_gap(&self) -> Option<Duration>;
    /// Returns the heading and the speed of the robot in its last output. Returns `None` before the first output, and
    /// if no path is recorded.
    fn motion(&self) -> Option<(Radians, MetersPerSecond)>;
    /// Returns the last output, for views of the run; `None` if there is no output, or if it is not a [`Sensed`].
    fn sensed(&self) -> Option<&Sensed>;
    /// Returns the last output and input for a record; `None` if there is no output, or if a record cannot contain
    /// their types.
    fn exact(&self) -> Option<Exact<'_>>;
    /// Starts recording the changes that [`Drive::take_changes`] returns; called before the first turn.
    fn record(&mut self);
    /// Removes and returns the changes, other than the robot's output, that influenced the last turn.
    fn take_changes(&mut self) -> Vec<RecordedChange>;
    /// Makes turn `number` with the last output, which was read at time `t`. The first turn begins the plan.
    ///
    /// # Errors
    /// Returns the reason if the run must end although the robot has no fault.
    fn turn(&mut self, t: Nanos, number: u64, transitions: &mut Transitions) -> Result<Turn<()>, RunEnd>;
    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, say: &mut dyn FnMut(&str));
    /// Returns the robot's observer and the position in the plan. The observer is `None` if the robot has none, and the
    /// position is `None` if the plan has not begun.
    fn parts(&mut self) -> (Option<&mut dyn Observer>, Option<&dyn Position>);
    /// Returns the time at which the plan began, on the clock of the run.
    fn zero(&self) -> Nanos;
    /// Returns the supervisor's intervention in the last turn.
    fn intervention(&self) -> Option<Intervention<'_>>;
    /// Returns the requests that the supervisor has fulfilled since the last call.
    fn take_requests(&mut self) -> Vec<String>;
    /// Returns the number of the current plan, counting from 1, and the reason why this plan has replaced another one.
    fn plan(&self) -> (u64, &str);
    /// Ends the plan, as the rule `rule` of the supervisor demands. Returns `true` if another plan continues.
    fn ended_by(&mut self, rule: &str) -> bool;
    /// Returns the continuation of the run after a turn in which the current plan has ended.
    fn after_plan(&mut self) -> AfterPlan;
    /// Calls the supervisor, if there is one, at the break between two turns. `moment` contains the number of turns so
    /// far, the time of the last turn, and `true` if the plan is over. `timing` describes the turns; `None` in stepped
    /// time.
    fn at_break(
        &mut self,
        moment: (u64, Nanos, bool),
        report: &ReportWriter<'_>,
        timing: Option<&Timing>,
    ) -> BreakOrders;
    /// Passes the last state of a run to the supervisor, if there is one. The run has ended before its plan, after
    /// `turns` turns.
    fn at_end(&mut self, turns: u64, t: Nanos, report: &ReportWriter<'_>, timing: Option<&Timing>);
    /// Tells the supervisor, if there is one, why the run has ended, and the exit status.
    fn ended(&mut self, why: &str, status: u8);

    /// Returns the robot's observer; `None` if the robot has no observer.
    fn observer(&mut self) -> Option<&mut dyn Observer> {
        self.parts().0
    }
}

/// The output and the inputs of a turn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exact<'y> {
    /// Output of the robot.
    pub(crate) y: &'y Sensed,
    /// Input that the plan requested.
    pub(crate) asked: Twist,
    /// Input that is sent to the robot.
    pub(crate) sent: Twist,
}

/// A robot with the pilot that drives it.
pub(crate) struct PilotOnRobot<'p, R: Robot, B: Pilot> {
    robot: R,
    observer: Observes<R>,
    /// Function that returns the robot's speed in an output; `None` if no path is recorded.
    speed: Option<Speed<R>>,
    helm: Helm<'p, B>,
    /// Function that returns the settings of the robot, for the supervisor.
    settings: Option<SettingsOf<R>>,
    output: Option<R::Output>,
}

/// A function that returns the forward speed of a robot in an output.
type Speed<R> = fn(&<R as Robot>::Output) -> MetersPerSecond;

impl<'p, R, B> PilotOnRobot<'p, R, B>
where
    R: Robot,
    B: Pilot<Plan: Plan<Output = R::Output, Input = R::Input>>,
{
    pub(crate) fn new(robot: R, observer: Observes<R>, speed: Option<Speed<R>>, helm: Helm<'p, B>) -> Self {
        Self { robot, observer, speed, helm, settings: None, output: None }
    }

    /// Sets the function that returns the robot's settings; the supervisor can change these settings.
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

    fn take_changes(&mut self) -> Vec<RecordedChange> {
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
        if let Some(supervisor) = self.helm.supervisor_mut() {
            supervisor.messages(say);
        }
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

    fn after_plan(&mut self) -> AfterPlan {
        self.helm.pilot_mut().after_plan()
    }

    fn at_break(
        &mut self,
        moment: (u64, Nanos, bool),
        report: &ReportWriter<'_>,
        timing: Option<&Timing>,
    ) -> BreakOrders {
        let (turns, t, is_over) = moment;
        let Self { robot, helm, settings, output: Some(y), .. } = self else { return BreakOrders::default() };
        let Some((supervisor, pilot, input)) = helm.parts() else { return BreakOrders::default() };
        let (settings, course) = (settings.map(|settings| settings(robot)), report.course());
        supervisor.at_break(&mut Break { turns, t, y, input, is_over, pilot, settings, course, timing })
    }

    fn at_end(&mut self, turns: u64, t: Nanos, report: &ReportWriter<'_>, timing: Option<&Timing>) {
        let Self { robot, helm, settings, output: Some(y), .. } = self else { return };
        let Some((supervisor, pilot, input)) = helm.parts() else { return };
        let (settings, course) = (settings.map(|settings| settings(robot)), report.course());
        let is_over = false;
        supervisor.at_end(&Break { turns, t, y, input, is_over, pilot, settings, course, timing });
    }

    fn ended(&mut self, why: &str, status: u8) {
        if let Some(supervisor) = self.helm.supervisor_mut() {
            supervisor.ended(why, status);
        }
    }
}
