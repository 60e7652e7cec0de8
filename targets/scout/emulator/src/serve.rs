//! The robot at its line: requests come, answers go, and the world passes on meanwhile.

use std::io;
use std::time::{Duration, Instant};

use crate::port::Port;
use crate::scout::Scout;
use crate::wire::Incoming;

/// A step of the world in real time.
pub const STEP: Duration = Duration::from_millis(10);
/// The longest wait without a look at whether to go on.
const SLICE: Duration = Duration::from_millis(50);

/// How the world passes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// By so much with each request, whatever the clock says.
    Lockstep(Duration),
    /// By the clock, in steps of [`STEP`].
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

/// Serves the robot at this line as long as `goes_on` says so.
///
/// # Errors
/// The line failed, or the world did.
pub fn serve(scout: &mut Scout, port: &Port, pace: Pace, goes_on: &dyn Fn() -> bool) -> io::Result<()> {
    let mut incoming = Incoming::default();
    let mut next = Instant::now() + STEP;
    while goes_on() {
        let limit = match pace {
            Pace::Lockstep(_) => SLICE,
            Pace::Real => next.saturating_duration_since(Instant::now()),
        };
        port.read(limit, &mut |bytes| incoming.push(bytes))?;
        while pace == Pace::Real && next <= Instant::now() {
            scout.pass(STEP).map_err(io::Error::other)?;
            next += STEP;
        }
        while let Some(request) = incoming.next_request() {
            let is_known = scout.obey(&request);
            if let Pace::Lockstep(step) = pace {
                // What it was told holds for the period that follows, and the answer says how that went.
                scout.pass(step).map_err(io::Error::other)?;
            }
            port.write(&scout.answer(&request, is_known))?;
        }
    }
    Ok(())
}
