//! The output of a robot on two driven wheels with odometry, bumper switches, sixteen sonars, a battery and a store of paths: each
//! value as it is kept, and the capabilities that it comes to (`y = h(x)`, paper, Eq. 1).

use crate::capability::{Bumpers, DiffDrive, Odometry, Paths, Power, SonarRing, Steering};
use crate::{Meters, Nanos, Output, PathStore, Pings, Pose, SONARS, Setpoint, SonarId, Twist, Volts};

/// The output of one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// The time of the exchange that brought it, counted from the first, as that of its pings.
    pub at: Nanos,
    /// Where the robot is by its own reckoning.
    pub odometry: Pose,
    /// How fast it moves, measured.
    pub velocity: Twist,
    /// The bumper switches in contact: bit `i` for switch `i`. A simulated Scout has six, counted counter-clockwise from
    /// the front, an ATRV-mini one before and one behind.
    pub switches: u32,
    /// The last pings of each sonar.
    pub pings: [Pings; SONARS],
    /// What the robot says of its power; the default on one that says nothing of it.
    pub supply: Supply,
    /// What never changes.
    pub shape: Shape,
    /// The paths that the plan can replay; empty on a robot that is given none.
    pub paths: PathStore,
}

/// What a robot says of its power.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Supply {
    /// The voltage of its battery.
    pub battery: Volts,
    /// Whether the battery has to be charged.
    pub is_low: bool,
    /// Whether the robot is on its charger.
    pub is_plugged: bool,
}

/// What laws must know of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// The radius of the smallest circle around it.
    pub body_radius: Meters,
    /// The distance between its wheels.
    pub wheel_base: Meters,
    /// The distance of the sonars from its centre.
    pub ring_radius: Meters,
    /// How many pings must agree that a way is free.
    pub confirmation: usize,
    /// How hard laws steer it.
    pub steering: Steering,
}

impl Output for Sensed {
    fn here(&self) -> Pose {
        self.odometry
    }
}

impl Odometry for Sensed {
    fn pose(&self) -> Pose {
        self.odometry
    }

    fn velocity(&self) -> Twist {
        self.velocity
    }
}

impl Bumpers for Sensed {
    fn pressed(&self) -> bool {
        self.switches != 0
    }
}

impl DiffDrive for Sensed {
    fn body_radius(&self) -> Meters {
        self.shape.body_radius
    }

    fn wheel_base(&self) -> Meters {
        self.shape.wheel_base
    }

    fn steering(&self) -> Steering {
        self.shape.steering
    }
}

impl SonarRing for Sensed {
    fn pings(&self, sonar: SonarId) -> &Pings {
        let [first, ..] = &self.pings;
        // Numbers of sonars are below 16.
        self.pings.get(sonar.number()).unwrap_or(first)
    }

    fn now(&self) -> Nanos {
        self.at
    }

    fn ring_radius(&self) -> Meters {
        self.shape.ring_radius
    }

    fn confirmation(&self) -> usize {
        self.shape.confirmation
    }
}

impl Power for Sensed {
    fn battery(&self) -> Volts {
        self.supply.battery
    }

    fn is_low(&self) -> bool {
        self.supply.is_low
    }

    fn is_plugged(&self) -> bool {
        self.supply.is_plugged
    }
}

impl Paths for Sensed {
    fn path(&self, name: &str) -> Option<&[Setpoint]> {
        self.paths.path(name)
    }
}
