//! The simulated robot: body and sonars in a world, moved on by one period in each exchange.

use std::fmt;
use std::time::Duration;

use mdle_runtime::{Nanos, Pose, Robot, Twist};

use crate::body::Body;
use crate::output::Sensed;
use crate::sonar::Ring;
use crate::start::{self, StartError};
use crate::walls::Walls;
use crate::world::World;

/// A robot in a world.
pub struct Simulated {
    walls: Walls,
    body: Body,
    ring: Ring,
    period: Duration,
    /// Exchanges so far; the first is at time 0.
    exchanges: u64,
}

/// Why an exchange failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The input is not finite: a law has computed nonsense.
    Input,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input => write!(f, "the plan asked for a speed that is not a number"),
        }
    }
}

impl std::error::Error for Fault {}

impl Simulated {
    /// A robot at rest at `start` in `world`, whose odometry begins there. Its sonars are exact, or noisy with a seed.
    ///
    /// # Errors
    /// When it cannot stand there.
    pub fn new(world: &World, start: Pose, seed: Option<u64>, period: Duration) -> Result<Self, StartError> {
        let walls = Walls::of(world);
        start::check(&start, world, &walls)?;
        Ok(Self { walls, body: Body::at(start), ring: Ring::new(seed), period, exchanges: 0 })
    }

    /// Where it is on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.body.pose
    }

    /// The time of the next exchange.
    pub(crate) fn now(&self) -> Nanos {
        let period = u64::try_from(self.period.as_nanos()).unwrap_or(u64::MAX);
        Nanos(self.exchanges.saturating_mul(period))
    }
}

impl Robot for Simulated {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        if !(input.v.0.is_finite() && input.omega.0.is_finite()) {
            return Err(Fault::Input);
        }
        self.body.advance(input, self.period.as_secs_f64(), &self.walls);
        let Body { pose, odometry, .. } = self.body;
        let now = self.now();
        self.ring.ping(&pose, odometry, now, &self.walls);
        self.exchanges = self.exchanges.saturating_add(1);
        Ok(Sensed {
            odometry,
            velocity: self.body.velocity(),
            pressed: self.body.touches(&self.walls),
            pings: self.ring.pings,
        })
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.body.brake(&self.walls);
        Ok(())
    }
}
