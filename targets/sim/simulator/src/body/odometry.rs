//! Odometry: the motion that the wheels measure, and the errors of this measurement.

use mdle_runtime::{Meters, Pose, Radians};

use crate::model::Slip;
use crate::noise::{Noise, Purpose};
use crate::point::Point;

/// Pose that the robot computes from the motion of its wheels, relative to the start pose.
#[derive(Debug, Clone)]
pub(crate) struct Odometry {
    pub(crate) pose: Pose,
    /// Errors of odometry in this run; `None` for exact odometry.
    errors: Option<OdometryErrors>,
}

#[derive(Debug, Clone)]
struct OdometryErrors {
    noise: Noise,
    /// Factor by which the measured distance differs from the true distance.
    way: f64,
    /// Factor by which the measured turn differs from the true turn.
    turn: f64,
    /// Error of the heading, in radians per metre.
    bend: f64,
    /// Standard deviation of the heading's random error after a metre, in radians.
    wander: f64,
}

impl Odometry {
    pub(crate) fn new(slip: Option<Slip>, seed: Option<u64>) -> Self {
        let errors = slip.zip(seed).map(|(slip, seed)| {
            let mut noise = Noise::of(seed, Purpose::Slip);
            let way = 1.0 + slip.way * noise.normal();
            let turn = 1.0 + slip.turn * noise.normal();
            let bend = slip.bend * noise.normal();
            noise.release();
            OdometryErrors { noise, way, turn, bend, wander: slip.wander }
        });
        Self { pose: Pose::ORIGIN, errors }
    }

    /// Frees memory that is needed only during a turn.
    pub(crate) fn release(&mut self) {
        if let Some(errors) = &mut self.errors {
            errors.noise.release();
        }
    }

    /// Records that the wheels have rolled along an arc with the length `way` and the angle `turn`.
    pub(crate) fn rolled(&mut self, way: f64, turn: f64) {
        let (mut measured, mut turned) = (way, turn);
        if let Some(errors) = self.errors.as_mut().filter(|_| way != 0.0 || turn != 0.0) {
            measured = way * errors.way;
            let wander = errors.wander * libm::sqrt(way.abs()) * errors.noise.normal();
            turned = turn * errors.turn + way.abs() * errors.bend + wander;
        }
        self.pose = self.pose.moved(Meters(measured), Radians(turned));
    }

    /// Records that a body with the true heading `heading` was moved by `way` and turned by `turn`.
    pub(crate) fn carried(&mut self, heading: Radians, way: Point, turn: f64) {
        let (sin, cos) = libm::sincos(self.pose.theta.0 - heading.0);
        self.pose = Pose {
            x: Meters(self.pose.x.0 + (way.x * cos - way.y * sin)),
            y: Meters(self.pose.y.0 + (way.x * sin + way.y * cos)),
            theta: Radians(self.pose.theta.0 + turn).wrapped(),
        };
    }
}
