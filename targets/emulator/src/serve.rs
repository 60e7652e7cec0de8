//! A robot at its line: requests come, answers go, and the world passes on meanwhile.

use std::io;
use std::time::{Duration, Instant};

use mdle_simulator::Footprint;

use crate::fault::Ailment;
use crate::port::Port;

/// A step of the world in real time.
pub const STEP: Duration = Duration::from_millis(10);
/// Maximum wait between two checks of the request to stop.
pub(crate) const SLICE: Duration = Duration::from_millis(5);

/// A robot emulator: its language and its body.
pub trait Emulated {
    /// Receives bytes from the line.
    fn push(&mut self, bytes: &[u8]);

    /// Executes the next complete request; `None` if there is no such request. In lockstep a period passes after a
    /// request for which this returns `true`, before the answer is sent.
    fn obey(&mut self) -> Option<bool>;

    /// Lets `time` pass.
    ///
    /// # Errors
    /// The world's sentence about an input that it cannot take; no input here is of this kind.
    fn pass(&mut self, time: Duration) -> Result<(), String>;

    /// Returns the frames that the robot has to send since the last call.
    fn take_frames(&mut self) -> Vec<Vec<u8>>;

    /// Returns `true` if this robot can have this ailment.
    fn can_suffer(ailment: Ailment) -> bool;

    /// Begins this ailment.
    fn suffer(&mut self, ailment: Ailment);
}

/// A robot that others in its world see and touch.
pub trait Embodied {
    /// Returns the area that the robot's body covers.
    fn footprint(&self) -> Footprint;

    /// Moves the other robots to these places.
    fn see(&mut self, others: &[Footprint]);
}

/// Pace of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// The world advances by this step with each command, independent of the clock.
    Lockstep(Duration),
    /// The world advances by the clock, in steps of [`STEP`].
    Real,
}

impl Pace {
    /// The step that the body has to be made for.
    #[must_use]
    pub const fn step(self) -> Duration {
        match self {
            Self::Lockstep(step) => step,
            Self::Real => STEP,
        }
    }
}

/// Serves the robot at this line while `goes_on` returns `true`, and then until it has executed its earlier commands.
///
/// # Errors
/// The line failed, or the world did.
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
                // What it was told holds for the period that follows, and the answer says how that went.
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
