//! The output of a robot with two driven wheels, odometry, bumper switches, sixteen sonars, a battery and a store of
//! paths (`y = h(x)`, paper, Eq. 1): the measured values, and the capability traits that the output implements.

use crate::capability::{Bumpers, DiffDrive, Modules, Odometry, Paths, Power, SonarRing, StateLink, Steering};
use crate::{
    Compass, Links, Meters, Nanos, Output, PathStore, Pings, Pose, Published, PublishedNumber, Radians, SONARS,
    Setpoint, Shape, SonarId, Twist, Volts,
};

/// The output of one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Time of the exchange that brought this output, since the first exchange. Times of pings are on the same
    /// clock.
    pub at: Nanos,
    /// Age of the measurements: the time from the last exchange that brought new measurements to the exchange of this
    /// output; zero if this exchange brought new ones.
    pub data_age: Nanos,
    /// Pose of the robot by its own odometry.
    pub odometry: Pose,
    /// Measured speed and turn rate.
    pub velocity: Twist,
    /// The bumper switches in contact: bit `i` for switch `i`. A simulated Scout has six, counted counter-clockwise
    /// from the front, an ATRV-mini one at the front and one at the back.
    pub switches: u32,
    /// The newest pings of each sonar.
    pub pings: [Pings; SONARS],
    /// Drift of the odometry heading, estimated from walls; the default on a robot whose odometry does not drift.
    pub compass: Compass,
    /// Power supply as the robot reports it; the default on a robot that does not report it.
    pub supply: Supply,
    /// Constants of the body.
    pub shape: Shape,
    /// The paths that the plan can replay; empty on a robot without paths.
    pub paths: PathStore,
    /// Numbers from modules and states of other robots that the plan reads; an engine fills them in.
    pub published: Published,
}

/// Power supply as a robot reports it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Supply {
    /// Voltage of the battery.
    pub battery: Volts,
    /// `true` if the battery has to be charged.
    pub is_low: bool,
    /// `true` if the robot is on its charger.
    pub is_plugged: bool,
}

impl Output for Sensed {
    fn here(&self) -> Pose {
        self.odometry
    }

    fn take_published(&mut self, published: Published) {
        self.published = published.with_links(*self.published.links());
    }

    fn take_links(&mut self, links: Links) {
        self.published = self.published.with_links(links);
    }

    fn velocities(&self) -> Twist {
        self.velocity
    }

    fn oldest_published(&self) -> Nanos {
        self.published.oldest()
    }

    fn data_age(&self) -> Nanos {
        self.data_age
    }
}

impl Odometry for Sensed {
    fn pose(&self) -> Pose {
        self.odometry
    }

    fn velocity(&self) -> Twist {
        self.velocity
    }

    fn drift(&self, axis: Radians) -> Radians {
        self.compass.drift(axis)
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

    fn half_length(&self) -> Meters {
        self.shape.half_length
    }

    fn half_width(&self) -> Meters {
        self.shape.half_width
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
        // `first` is never used, because sonar numbers are below 16.
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

impl Modules for Sensed {
    fn published(&self, module: &str, attribute: &str) -> Option<PublishedNumber> {
        self.published.number(module, attribute)
    }
}

impl StateLink for Sensed {
    fn links(&self) -> &Links {
        self.published.links()
    }
}
