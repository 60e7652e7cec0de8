//! Measures the pings of a simulated Scout's front sonar that points at a wall or a column.

use std::time::Duration;

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Pose, Radians, Robot, SonarId, Twist};
use mdle_sim::{Body, Make, Simulated, World};

/// Time in which each of the sixteen sonars pings once, in milliseconds.
const RING: u64 = 960;
/// Distance of the transducer from the centre of the body, in metres.
const TRANSDUCER: f64 = 0.19;
/// Number of pings after which a new robot is created, which has another air temperature.
const ONE_RUN: usize = 20;

/// A long wall across the first axis at `{x}`.
pub(crate) const WALL: &str = "[[wall]]\npoints = [[{x}, -60], [{x}, 60]]";
/// A column 60 cm thick on the first axis, whose centre is at `{x}`.
pub(crate) const COLUMN: &str = "[[disc]]\nradius = 0.3\ncentre = [{x}, 0]";

/// Results of a series of pings.
#[derive(Debug, Default)]
pub(crate) struct Heard {
    /// Errors of the measured ranges, in metres; positive if the range is too long.
    pub(crate) errors: Vec<f64>,
    /// Number of pings without an echo.
    pub(crate) silent: usize,
}

impl Heard {
    /// Returns the fraction of pings whose range is within 15 cm of the true one.
    pub(crate) fn share(&self) -> f64 {
        let true_ones = self.errors.iter().filter(|error| error.abs() < 0.15).count();
        true_ones as f64 / (self.errors.len() + self.silent) as f64
    }
}

/// Pings `pings` times at the object `what`, whose surface is `distance` metres from the transducer along the surface's
/// normal. The normal is `degrees` degrees off the sonar's axis.
pub(crate) fn heard(what: &str, distance: f64, degrees: f64, pings: usize) -> Heard {
    let theta = Radians::from_degrees(degrees);
    let (y, ahead) = (TRANSDUCER * libm::sin(theta.0), TRANSDUCER * libm::cos(theta.0));
    let x = ahead + distance + if what == COLUMN { 0.3 } else { 0.0 };
    let text = what.replace("{x}", &x.to_string());
    // The transducer is on the first axis; the body is not.
    let world = World::parse("a test's world", &text).expect("a good world");
    let start = Pose { y: mdle_runtime::Meters(-y), theta, ..Pose::ORIGIN };
    let mut heard = Heard::default();
    for seed in 0..pings.div_ceil(ONE_RUN) as u64 {
        let make = Make { body: Body::Scout, seed: Some(seed), ..Make::default() };
        let mut robot = Simulated::with(&make, &world, start, Duration::from_millis(RING)).expect("a start");
        for _ in 0..ONE_RUN.min(pings - seed as usize * ONE_RUN) {
            let y = robot.exchange(&Twist::default()).expect("finite inputs");
            match y.pings(SonarId::new(0)).newest_first().next().and_then(|ping| ping.range) {
                Some(range) => heard.errors.push(range.0 - distance),
                None => heard.silent += 1,
            }
        }
    }
    heard
}
