//! The robot's hardware: REPLACE everything in this file to drive your own robot. Until then the robot is only
//! simulated.

use std::fmt;
use std::time::Duration;

use mdle_host::clap::{Arg, ArgMatches, Command};
use mdle_host::{Pace, Refusal, StopRequest, Time};
use mdle_runtime::capability::Steering;
use mdle_runtime::{
    Compass, Meters, MetersPerSecond, Nanos, PathStore, Pings, Pose, Published, Radians, RadiansPerSecond, Robot,
    SONARS, Sensed, Shape, Supply,
};

use crate::{Input, Output, alphabet};

/// REPLACE with the dimensions of your robot. `body_radius` is the radius of the smallest circle around it. For a round
/// body, `half_length` and `half_width` have the same value.
const SHAPE: Shape = Shape {
    body_radius: Meters(0.2),
    half_length: Meters(0.2),
    half_width: Meters(0.2),
    sonars_apart: None,
    wheel_base: Meters(0.35),
    ring_radius: Meters(0.2),
    confirmation: 3,
    steering: Steering::USUAL,
};
/// REPLACE with the maximum speed that laws may request.
const FASTEST: MetersPerSecond = MetersPerSecond(0.5);
/// REPLACE with the maximum turn rate that laws may request.
const FASTEST_TURN: RadiansPerSecond = RadiansPerSecond(2.0);

/// Reason why the robot cannot continue. Add the faults of your robot: a closed line, a missing answer, an emergency
/// stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A law has requested a speed that is not a number.
    NoNumber,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoNumber => f.write_str("a law has asked for a speed that is no number"),
        }
    }
}

/// Returns the command for this input. If the input is too fast, both speeds are reduced by the same factor, so that
/// the robot stays on its curve.
fn within_limits(input: &Input) -> Result<Input, Fault> {
    if !(input.v.0.is_finite() && input.omega.0.is_finite()) {
        return Err(Fault::NoNumber);
    }
    let scale = (FASTEST.0 / input.v.0.abs()).min(FASTEST_TURN.0 / input.omega.0.abs()).min(1.0);
    Ok(Input { v: MetersPerSecond(input.v.0 * scale), omega: RadiansPerSecond(input.omega.0 * scale) })
}

/// The robot. REPLACE the fields with the connection to your robot, and the functions below with your driver.
#[derive(Debug)]
pub struct Hardware {
    period: Duration,
    pose: Pose,
    velocity: Input,
}

/// The target on which the host runs plans.
#[derive(Debug, Clone, Copy)]
pub struct Target;

impl mdle_host::Target for Target {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Hardware;

    /// REPLACE with the options that your robot needs, such as the device of its serial line.
    fn arguments(command: Command) -> Command {
        let speed = Arg::new("speed").long("speed").value_name("real|max").value_parser(["real", "max"]);
        command.arg(speed.help("Speed of the simulated time: as fast as the clock, or as possible [default: real]"))
    }

    /// REPLACE: remove this function, and time follows the clock. Only simulated time can run faster.
    fn time(options: &ArgMatches) -> Result<Time, String> {
        let is_hurried = options.get_one::<String>("speed").is_some_and(|speed| speed == "max");
        Ok(Time::Stepped(if is_hurried { Pace::Max } else { Pace::Times(1.0) }))
    }

    /// Connects to the robot, which does not move yet. Your function sets the odometry to zero here and arms the
    /// robot's watchdog, which has to stop the robot if no more commands arrive: even this program can be killed.
    fn connect(_options: &ArgMatches, period: Duration, _request: &StopRequest) -> Result<Hardware, Refusal> {
        Ok(Hardware { period, pose: Pose::ORIGIN, velocity: Input::default() })
    }
}

impl Robot for Hardware {
    type Output = Output;
    type Input = Input;
    type Error = Fault;

    /// Sends the speeds for this period and returns the sensor values at its end. Your function waits for these values,
    /// but with a timeout: a robot that does not answer is a fault, and old values must never be returned again.
    fn exchange(&mut self, input: &Input) -> Result<Output, Fault> {
        let speeds = within_limits(input)?;
        let seconds = self.period.as_secs_f64();
        self.pose = self.pose.moved(Meters(speeds.v.0 * seconds), Radians(speeds.omega.0 * seconds));
        self.velocity = speeds;
        Ok(Sensed {
            odometry: self.pose,
            velocity: self.velocity,
            // The alphabet declares no quarks for these sensors, so no plan can use them. They stay empty until the
            // robot has them.
            switches: 0,
            pings: [Pings::default(); SONARS],
            compass: Compass::default(),
            at: Nanos::ZERO,
            data_age: Nanos::ZERO,
            supply: Supply::default(),
            shape: SHAPE,
            paths: PathStore::EMPTY,
            published: Published::NONE,
        })
    }

    /// Stops the robot. Every run ends with this call, also after a fault. Your function sends the robot's own stop
    /// command, even if the last command was not answered.
    fn stop(&mut self) -> Result<(), Fault> {
        self.velocity = Input::default();
        Ok(())
    }
}

impl Hardware {
    /// Returns the pose of the simulated robot, relative to its start. REPLACE: remove this function, since the true
    /// pose of a real robot is not known here; `tests/conformance.rs` has to measure it.
    #[must_use]
    pub fn imagined(&self) -> Pose {
        self.pose
    }
}

#[cfg(test)]
mod tests {
    use mdle_host::Target as _;

    use super::*;

    fn hardware() -> Hardware {
        let options = Target::arguments(Command::new("test")).get_matches_from(["test"]);
        Target::connect(&options, Duration::from_millis(100), &StopRequest::default())
            .unwrap_or_else(|refusal| unreachable!("{refusal:?}"))
    }

    fn twist(v: f64, omega: f64) -> Input {
        Input { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
    }

    /// Returns the sensor values after a second at these speeds.
    fn after_a_second(v: f64, omega: f64) -> Result<Output, Fault> {
        let mut hardware = hardware();
        (0..9).try_for_each(|_| hardware.exchange(&twist(v, omega)).map(|_| ()))?;
        hardware.exchange(&twist(v, omega))
    }

    #[test]
    fn forward_is_forward_and_a_positive_rate_turns_left() -> Result<(), Fault> {
        let (ahead, left) = (after_a_second(0.2, 0.0)?, after_a_second(0.2, 0.5)?);
        assert!((ahead.odometry.x.0 - 0.2).abs() < 1e-9 && ahead.odometry.y.0 == 0.0, "{ahead:?}");
        assert!((left.odometry.theta.0 - 0.5).abs() < 1e-9 && left.odometry.y.0 > 0.0, "{left:?}");
        assert_eq!([ahead.velocity, left.velocity], [twist(0.2, 0.0), twist(0.2, 0.5)]);
        Ok(())
    }

    #[test]
    fn what_is_too_fast_stays_on_its_curve() {
        assert_eq!(within_limits(&twist(-1.0, 0.5)), Ok(twist(-0.5, 0.25)));
        assert_eq!(within_limits(&twist(0.4, 4.0)), Ok(twist(0.2, 2.0)));
        assert_eq!(within_limits(&twist(0.0, 0.0)), Ok(twist(0.0, 0.0)));
        assert_eq!(within_limits(&twist(f64::NAN, 0.0)), Err(Fault::NoNumber));
    }

    #[test]
    fn a_robot_that_is_stopped_stands() -> Result<(), Fault> {
        let mut hardware = hardware();
        hardware.exchange(&twist(0.2, 0.5))?;
        hardware.stop()?;
        let [before, after] = [hardware.exchange(&Input::default())?, hardware.exchange(&Input::default())?];
        assert_eq!((before.odometry, after.velocity), (after.odometry, Input::default()));
        Ok(())
    }
}
