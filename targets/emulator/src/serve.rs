//! Serves an emulated robot at its line. It executes requests, sends answers, and advances the world.

use std::io;
use std::time::{Duration, Instant};

use mdle_simulator::Footprint;

use crate::fault::Ailment;
use crate::port::Port;

/// Time by which the emulated world advances in one step, and interval between two steps in real time.
pub const STEP: Duration = Duration::from_millis(10);
/// Interval at which the emulator checks whether it has been asked to stop.
pub(crate) const SLICE: Duration = Duration::from_millis(5);

/// An emulated robot, which consists of its protocol and its body.
pub trait Emulated {
    /// Receives bytes from the line.
    fn push(&mut self, bytes: &[u8]);

    /// Executes the next complete request. Returns `None` if no request is complete. If the result is `true`, a
    /// lockstep period passes before the answer is sent.
    fn obey(&mut self) -> Option<bool>;

    /// Advances the robot's world by `time`.
    ///
    /// # Errors
    /// Fails if the simulated body rejects its input, which it never does for the commands of a robot.
    fn pass(&mut self, time: Duration) -> Result<(), String>;

    /// Removes and returns the frames that the robot has sent since the last call.
    fn take_frames(&mut self) -> Vec<Vec<u8>>;

    /// Returns `true` if this kind of robot can have the fault `ailment`.
    fn can_suffer(ailment: Ailment) -> bool;

    /// Begins the fault `ailment` of the robot's body.
    fn suffer(&mut self, ailment: Ailment);
}

/// A robot that other robots in its world can detect and touch.
pub trait Embodied {
    /// Returns the area that the robot's body covers.
    fn footprint(&self) -> Footprint;

    /// Sets the footprints of the other robots.
    fn see(&mut self, others: &[Footprint]);
}

/// Pace at which the world advances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// The world advances by this step with each command, independent of the clock.
    Lockstep(Duration),
    /// The world advances in real time, in steps of [`STEP`].
    Real,
}

impl Pace {
    /// Returns the time step of the robot's body at this pace.
    #[must_use]
    pub const fn step(self) -> Duration {
        match self {
            Self::Lockstep(step) => step,
            Self::Real => STEP,
        }
    }
}

/// Serves the robot at this line while `goes_on` returns `true`. Afterwards, executes the commands that have already
/// been received.
///
/// # Errors
/// Fails if the line or the robot's world failed.
pub fn serve<R: Emulated>(robot: &mut R, port: &Port, pace: Pace, goes_on: &dyn Fn() -> bool) -> io::Result<()> {
    let mut next = Instant::now() + STEP;
    loop {
        let ends = !goes_on();
        let limit = match pace {
            _ if ends => Duration::ZERO,
            Pace::Lockstep(_) => SLICE,
            Pace::Real => next.saturating_duration_since(Instant::now()),
        };
        let has_input = port.read(limit, &mut |bytes| robot.push(bytes))?;
        if ends && !has_input {
            return Ok(());
        }
        while pace == Pace::Real && next <= Instant::now() {
            robot.pass(STEP).map_err(io::Error::other)?;
            next += STEP;
        }
        while let Some(passes) = robot.obey() {
            if let Pace::Lockstep(step) = pace
                && passes
            {
                // The command applies to the following period, and the answer reports the state at its end.
                robot.pass(step).map_err(io::Error::other)?;
            }
            say(robot, port)?;
        }
        say(robot, port)?;
    }
}

pub(crate) fn say<R: Emulated>(robot: &mut R, port: &Port) -> io::Result<()> {
    robot.take_frames().iter().try_for_each(|bytes| port.write(bytes))
}
