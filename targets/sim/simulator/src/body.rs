//! The body: a disc or a rectangle on driven wheels (`dx/dt = f(x) + G(x) u`, paper, Eq. 1). Its motors have limits,
//! and the body slides along walls.

mod contact;
mod odometry;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, Twist};

use crate::footprint::{Contact, Footprint};
use crate::model::Drive;
use crate::point::Point;
use crate::walls::Walls;
use contact::{slid, turned};
use odometry::Odometry;

/// Maximum step of the integration, in seconds. In one step the robot moves about a centimetre, less than the thickness
/// of any wall.
pub(crate) const STEP: f64 = 0.01;
/// Maximum distance, in metres, at which the bumper detects a wall.
const FEELS: f64 = 0.001;
/// Minimum fraction of the forward speed that must remain at a wall so that the wheels keep turning. It is the fraction
/// that remains at an angle of 45° to the wall.
const GLANCES: f64 = 0.5;
/// Range of the search for walls, in metres from the body's edge. The body can move through the space that the search
/// has found free before the next search is needed.
const LOOKS: f64 = 0.6;

/// The pose and the motion of the body.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    /// Pose on the floor.
    pub(crate) pose: Pose,
    /// Wheels and outline, which all robots with the same body share.
    drive: Arc<Drive>,
    odometry: Odometry,
    /// The speed of the left wheel, in m/s.
    left: f64,
    /// The speed of the right wheel, in m/s.
    right: f64,
    /// Distance that the body can move in any direction before it may touch a fixed obstacle, in metres.
    clear: f64,
}

/// Obstacle that the body has hit in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Obstacle {
    Nothing,
    /// A wall, which allows only this forward speed, in m/s. If `turns` is `false`, the wall also prevents turning.
    Wall {
        forward: f64,
        turns: bool,
    },
}

impl Body {
    /// Returns a body at rest at `pose`, with the odometry errors of `seed`, or without errors.
    pub(crate) fn new(drive: impl Into<Arc<Drive>>, pose: Pose, seed: Option<u64>) -> Self {
        let drive = drive.into();
        let odometry = Odometry::new(drive.slip, seed);
        Self { pose, drive, odometry, left: 0.0, right: 0.0, clear: 0.0 }
    }

    /// Creates another body of the same kind, at rest at `pose`.
    pub(crate) fn another(&self, pose: Pose, seed: Option<u64>) -> Self {
        Self::new(Arc::clone(&self.drive), pose, seed)
    }

    /// Returns the maximum distance, in metres, that any point of the body moves in a time of `seconds`.
    pub(crate) fn goes_most(&self, seconds: f64) -> f64 {
        let way = self.drive.fastest * seconds;
        let turn = Radians(2.0 * self.drive.fastest / self.drive.wheel_base * seconds);
        // A contact pushes a rectangle away by at most twice the distance that its corners move in a turn.
        way + 3.0 * (self.drive.form.moved(way, turn) - way) + FEELS
    }

    /// Returns the area that the body covers.
    pub(crate) fn footprint(&self) -> Footprint {
        Footprint { pose: self.pose, form: self.drive.form }
    }

    /// Returns the pose by odometry, relative to the start pose.
    pub(crate) fn odometry(&self) -> Pose {
        self.odometry.pose
    }

    /// Returns the forward speed and the turn rate that result from the speeds of the wheels.
    pub(crate) fn velocity(&self) -> Twist {
        Twist {
            v: MetersPerSecond((self.left + self.right) / 2.0),
            omega: RadiansPerSecond((self.right - self.left) / self.drive.wheel_base),
        }
    }

    /// Returns the mean of the absolute speeds of the wheels, in metres per second.
    pub(crate) fn wheels(&self) -> f64 {
        (self.left.abs() + self.right.abs()) / 2.0
    }

    /// Returns the bumper switches in contact: bit `i` for switch `i` of `switches`, counted counter-clockwise
    /// from the front.
    pub(crate) fn pressed(&self, switches: u8, walls: &Walls) -> u32 {
        let body = self.footprint();
        if self.clear > FEELS && walls.moving_gap(&body) >= FEELS {
            return 0;
        }
        let (mut pressed, at) = (0, body.at());
        walls.contacts(&body, FEELS, |Contact { gap, place, .. }| {
            if gap < FEELS {
                let bearing = libm::atan2(place.y - at.y, place.x - at.x) - self.pose.theta.0;
                let bearing = bearing / std::f64::consts::TAU;
                let number = libm::round(bearing * f64::from(switches)).rem_euclid(f64::from(switches));
                pressed |= 1 << (number as u32);
            }
        });
        pressed
    }

    /// Moves the body for a time of `seconds` with this input, which must be finite.
    pub(crate) fn advance(&mut self, input: &Twist, seconds: f64, walls: &Walls) {
        let (left, right) = self.drive.commanded(input);
        let acceleration = self.drive.acceleration;
        let steps = libm::ceil(seconds / STEP).max(1.0);
        let step = seconds / steps;
        // A period is at most a minute, so the number fits.
        for _ in 0..steps as u32 {
            let across = self.right - self.left;
            self.left = approached(self.left, left, acceleration * step);
            self.right = approached(self.right, right, acceleration * step);
            if let Obstacle::Wall { forward, turns } = self.step(step, walls) {
                // The wall limits the forward speed; only the difference of the wheel speeds still approaches the
                // commanded one.
                let across = if turns { approached(across, right - left, 2.0 * acceleration * step) } else { 0.0 };
                (self.left, self.right) = (forward - across / 2.0, forward + across / 2.0);
            }
        }
    }

    /// Frees memory that is needed only during a turn.
    pub(crate) fn release(&mut self) {
        self.odometry.release();
    }

    /// Brakes until the wheels are at rest.
    pub(crate) fn brake(&mut self, walls: &Walls) {
        self.advance(&Twist::default(), self.drive.fastest / self.drive.acceleration + STEP, walls);
    }

    /// Makes one step of the integration, which is `step` seconds long. Returns the obstacle that the body has hit.
    fn step(&mut self, step: f64, walls: &Walls) -> Obstacle {
        let Twist { v, omega } = self.velocity();
        let (way, turn) = (v.0 * step, omega.0 * step);
        let there = self.pose.moved(Meters(way), Radians(turn));
        let moved = self.drive.form.moved(way, Radians(turn));
        if moved == 0.0 || self.is_free(&there, moved, walls) {
            self.pose = there;
            self.odometry.rolled(way, turn);
            return Obstacle::Nothing;
        }
        let here = Point::of(&self.pose);
        let straight = Point { x: there.x.0 - here.x, y: there.y.0 - here.y };
        let body = turned(&self.footprint(), Radians(turn), walls);
        let turns = body.pose.theta != self.pose.theta || turn == 0.0;
        let turn = if turns { turn } else { 0.0 };
        let slid = slid(&body, straight, walls);
        let slid = Point { x: body.pose.x.0 - here.x + slid.x, y: body.pose.y.0 - here.y + slid.y };
        let (sin, cos) = libm::sincos(self.pose.theta.0 + turn / 2.0);
        let forward = slid.x * cos + slid.y * sin;
        match self.drive.slip {
            Some(_) => self.odometry.rolled(forward, turn),
            None => self.odometry.carried(self.pose.theta, slid, turn),
        }
        self.pose = Pose { x: Meters(here.x + slid.x), y: Meters(here.y + slid.y), theta: body.pose.theta.wrapped() };
        self.clear = 0.0;
        let forward = forward / step;
        if turns && (v.0 == 0.0 || forward / v.0 >= GLANCES) {
            return Obstacle::Nothing;
        }
        // The contact must not increase or reverse the speed.
        let forward = if v.0 > 0.0 { forward.clamp(0.0, v.0) } else { forward.clamp(v.0, 0.0) };
        Obstacle::Wall { forward, turns }
    }

    /// Returns `true` if the body at `there` overlaps no obstacle. To get there, each point of the body has moved by at
    /// most `way` metres.
    fn is_free(&mut self, there: &Pose, way: f64, walls: &Walls) -> bool {
        let body = Footprint { pose: *there, form: self.drive.form };
        if walls.moving_gap(&body) < 0.0 {
            return false;
        }
        self.clear -= way;
        if self.clear <= 0.0 {
            self.clear = walls.standing_gap(&body, LOOKS);
        }
        self.clear >= 0.0
    }
}

impl Drive {
    /// Returns the wheel speeds for an input. If a wheel would be too fast, both speeds are reduced by the same factor,
    /// so that the robot stays on its curve. Then both speeds are truncated.
    fn commanded(&self, input: &Twist) -> (f64, f64) {
        let across = input.omega.0 * (self.wheel_base / 2.0);
        let (left, right) = (input.v.0 - across, input.v.0 + across);
        let scale = (left.abs().max(right.abs()) / self.fastest).max(1.0);
        let truncated = |speed: f64| libm::trunc(speed / scale / self.unit) * self.unit;
        (truncated(left), truncated(right))
    }
}

/// Returns `speed` after it has changed towards `commanded` by at most `most`.
fn approached(speed: f64, commanded: f64, most: f64) -> f64 {
    speed + (commanded - speed).clamp(-most, most)
}
