//! The robot's output, as it is read: the time and 25 numbers of 64 bits each. Its one path is part of the program.

use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, Paths, Power, SonarRing};
use mdle_runtime::{
    Meters, MetersPerSecond, Nanos, Output, PathStore, Ping, Pings, Pose, Radians, RadiansPerSecond, SONARS, Setpoint,
    SonarId, StoredPath, Supply, Twist, Volts,
};

/// The size of an output in bytes.
const SIZE: usize = 8 * (10 + SONARS);

/// An output as it is read.
pub(crate) type Record = [u8; SIZE];

/// Half a second to the left, faster and faster.
static BEND: [Setpoint; 2] = [
    Setpoint { at: Nanos::ZERO, heading: Radians(0.0), speed: MetersPerSecond(0.1) },
    Setpoint { at: Nanos(500_000_000), heading: Radians(0.1), speed: MetersPerSecond(0.2) },
];
static PATHS: [StoredPath; 1] = [StoredPath { name: "bend", setpoints: &BEND }];

/// The output of one turn.
#[derive(Debug)]
pub struct Sensed {
    pose: Pose,
    velocity: Twist,
    pressed: bool,
    supply: Supply,
    pings: [Pings; SONARS],
}

impl Sensed {
    /// The time and the output that a record holds: nanoseconds, `x`, `y`, `theta`, `v`, `omega`, the bumper, the
    /// battery, whether it is low, the charger, and the ranges; numbers in SI units, negative for a range where no echo came back.
    pub(crate) fn read(record: &Record) -> (Nanos, Self) {
        let (words, _) = record.as_chunks();
        let mut words = words.iter().map(|word| u64::from_le_bytes(*word));
        let t = Nanos(words.next().unwrap_or(0));
        let mut number = || f64::from_bits(words.next().unwrap_or(0));
        let pose = Pose { x: Meters(number()), y: Meters(number()), theta: Radians(number()) };
        let velocity = Twist { v: MetersPerSecond(number()), omega: RadiansPerSecond(number()) };
        let pressed = number() != 0.0;
        let battery = Volts(number());
        let supply = Supply { battery, is_low: number() != 0.0, is_plugged: number() != 0.0 };
        let mut pings = [Pings::default(); SONARS];
        for pings in &mut pings {
            let range = number();
            pings.push(Ping { range: (range >= 0.0).then_some(Meters(range)), at: t, pose });
        }
        (t, Self { pose, velocity, pressed, supply, pings })
    }
}

impl Output for Sensed {
    fn here(&self) -> Pose {
        self.pose
    }
}

impl Odometry for Sensed {
    fn pose(&self) -> Pose {
        self.pose
    }

    fn velocity(&self) -> Twist {
        self.velocity
    }
}

impl Bumpers for Sensed {
    fn pressed(&self) -> bool {
        self.pressed
    }
}

impl DiffDrive for Sensed {
    fn body_radius(&self) -> Meters {
        Meters(0.205)
    }

    fn wheel_base(&self) -> Meters {
        Meters(0.345)
    }
}

impl SonarRing for Sensed {
    #[allow(clippy::indexing_slicing, reason = "numbers of sonars are below 16, which the compiler can see")]
    fn pings(&self, sonar: SonarId) -> &Pings {
        &self.pings[sonar.number()]
    }

    fn ring_radius(&self) -> Meters {
        Meters(0.19)
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
        PathStore::new(&PATHS).path(name)
    }
}
