//! Runs a robot in a room for a trial: makes exchanges, and measures the motion of the body.

use std::format;

use mdle_runtime::{
    Alphabet, Argument, Begin, Completes, Control, Frame, Law, MetersPerSecond, Nanos, Output as _, Pose, Radians,
    RadiansPerSecond, Robot, Twist,
};

use super::room::AT;
use super::{Out, Room, Stage, Supplied, Verdict, stored_path};

/// Maximum deviation of the robot from the pose that the suite requested, in metres and radians.
const PUT: (f64, f64) = (0.02, 0.02);

/// A trial of the conformance suite: a robot in a room, with its last output and the number of exchanges so far.
pub(super) struct Trial<'s, S: Stage> {
    stage: &'s mut S,
    pub(super) robot: S::Robot,
    /// The robot's last output.
    pub(super) y: Out<S>,
    /// Frame of a plan that begins with the robot's first output.
    frame: Frame,
    /// Number of exchanges so far.
    exchanges: u64,
}

/// The motion of a body between two poses, relative to the first pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// Distance forward, in metres.
    pub(super) ahead: f64,
    /// Distance to the left, in metres.
    pub(super) left: f64,
    /// Turn in radians between -π and π, counter-clockwise.
    pub(super) turn: f64,
}

impl Way {
    pub(super) fn between(from: Pose, to: Pose) -> Self {
        let (x, y) = (to.x.0 - from.x.0, to.y.0 - from.y.0);
        let (sin, cos) = libm::sincos(from.theta.0);
        let turn = Radians(to.theta.0 - from.theta.0).wrapped().0;
        Self { ahead: x * cos + y * sin, left: y * cos - x * sin, turn }
    }

    /// Returns the distance between the two poses, in metres.
    pub(super) fn far(&self) -> f64 {
        libm::hypot(self.ahead, self.left)
    }
}

pub(super) fn twist(v: f64, omega: f64) -> Twist {
    Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
}

impl<'s, S: Stage> Trial<'s, S> {
    /// Puts a robot at the start pose of this room and makes its first exchange.
    pub(super) fn of(stage: &'s mut S, room: &Room) -> Result<Self, String> {
        let mut robot = stage.robot(room, AT).map_err(|why| format!("the stage has no robot: {why}"))?;
        stage.take_paths(&mut robot, stored_path::STORED);
        let put = Way::between(AT, stage.truth(&robot));
        if put.far() > PUT.0 || put.turn.abs() > PUT.1 {
            let (far, turned) = (put.far(), put.turn.to_degrees());
            return Err(format!(
                "the stage has put the robot {far:.2} m and {turned:.0} degrees off where it was to be"
            ));
        }
        let y = robot.exchange(&Twist::default()).map_err(|fault| format!("its first exchange failed: {fault}"))?;
        let frame = Frame(y.here().theta);
        Ok(Self { stage, robot, y, frame, exchanges: 1 })
    }

    /// Returns the time of the robot's last output.
    pub(super) fn now(&self) -> Nanos {
        Nanos(S::PERIOD.0.saturating_mul(self.exchanges.saturating_sub(1)))
    }

    /// Returns the true pose of the robot's body.
    pub(super) fn truth(&self) -> Pose {
        self.stage.truth(&self.robot)
    }

    /// Makes one exchange with this input.
    pub(super) fn exchange(&mut self, input: &Twist) -> Result<(), String> {
        self.y = self.robot.exchange(input).map_err(|fault| format!("an exchange failed: {fault}"))?;
        self.exchanges = self.exchanges.saturating_add(1);
        Ok(())
    }

    /// Sets the robot's power supply.
    pub(super) fn supply(&mut self, supplied: Supplied) {
        self.stage.supply(&mut self.robot, supplied);
    }

    /// Makes exchanges with this input for `seconds`. Returns the motion of the body.
    pub(super) fn drive(&mut self, v: f64, omega: f64, seconds: f64) -> Result<Way, String> {
        let from = self.truth();
        for _ in 0..periods::<S>(seconds) {
            self.exchange(&twist(v, omega))?;
        }
        Ok(Way::between(from, self.truth()))
    }

    /// Lets `seconds` pass without an exchange. Returns the motion of the body.
    pub(super) fn left_alone(&mut self, seconds: f64) -> Way {
        let from = self.truth();
        self.stage.left_alone(&mut self.robot, periods::<S>(seconds));
        Way::between(from, self.truth())
    }

    /// Runs the law `name` with these arguments until it is done, and calls `each` in every turn. The frame is that of
    /// a plan that begins with the first exchange. Returns the number of seconds that the law took; `None` if it was
    /// not done within `most` seconds.
    pub(super) fn run(
        &mut self,
        name: &str,
        arguments: &[Argument<'_>],
        most: f64,
        mut each: impl FnMut(&Self) -> Result<(), String>,
    ) -> Result<Option<f64>, Verdict> {
        let control = S::Alphabet::control(name, arguments).ok_or(Verdict::NotOffered)?;
        let began = self.now();
        let mut law = control.begin(&self.y, Begin { now: began, frame: self.frame });
        for _ in 0..periods::<S>(most) {
            if law.completed(&self.y, self.now()) {
                return Ok(Some(self.now().since(began).seconds()));
            }
            let input = law.input(&self.y, self.now());
            self.exchange(&input)?;
            each(self)?;
        }
        Ok(None)
    }

    /// Runs a law as `run` does, and fails if it is not done within `most` seconds.
    pub(super) fn run_until_done(&mut self, name: &str, arguments: &[Argument<'_>], most: f64) -> Result<(), Verdict> {
        match self.run(name, arguments, most, |_| Ok(()))? {
            Some(_) => Ok(()),
            None => Err(Verdict::Broken(format!("`{name}` was not done after {most:.0} s"))),
        }
    }
}

/// Returns the approximate number of periods in this many seconds; at least 1.
fn periods<S: Stage>(seconds: f64) -> u32 {
    libm::round(seconds / S::PERIOD.seconds().max(1e-3)).max(1.0) as u32
}

/// Returns the duration, in seconds, of the whole number of periods that is nearest to `seconds`.
pub(super) fn lasting<S: Stage>(seconds: f64) -> f64 {
    f64::from(periods::<S>(seconds)) * S::PERIOD.seconds()
}
