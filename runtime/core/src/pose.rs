//! Poses, velocities and the frames of headings (paper, section IV-C: each landmark has a frame of its own).

use crate::{Meters, MetersPerSecond, Radians, RadiansPerSecond};

/// A place and a heading in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Coordinate along the x axis, in metres.
    pub x: Meters,
    /// Coordinate along the y axis, which points to the left of the x axis, in metres.
    pub y: Meters,
    /// Heading, counter-clockwise from the x axis.
    pub theta: Radians,
}

impl Pose {
    /// The origin, with the heading along the x axis.
    pub const ORIGIN: Self = Self { x: Meters(0.0), y: Meters(0.0), theta: Radians(0.0) };

    /// Returns the distance to the position of `other`.
    #[must_use]
    pub fn distance(&self, other: &Self) -> Meters {
        Meters(libm::hypot(other.x.0 - self.x.0, other.y.0 - self.y.0))
    }

    /// Returns the pose at distance `range` from this position in direction `bearing`, with the heading `bearing`. Both
    /// poses and `bearing` are in the same coordinates.
    #[must_use]
    pub fn towards(&self, bearing: Radians, range: Meters) -> Self {
        let (sin, cos) = libm::sincos(bearing.0);
        Self { x: Meters(self.x.0 + range.0 * cos), y: Meters(self.y.0 + range.0 * sin), theta: bearing }
    }

    /// Returns the pose after an arc of length `way` that turns by `turn`, computed exactly from its chord.
    #[must_use]
    pub fn moved(&self, way: Meters, turn: Radians) -> Self {
        let half = turn.0 / 2.0;
        let chord = if half.abs() < 1e-9 { way.0 } else { way.0 * libm::sin(half) / half };
        let end = self.towards(Radians(self.theta.0 + half), Meters(chord));
        Self { theta: Radians(self.theta.0 + turn.0).wrapped(), ..end }
    }
}

/// The input of a differentially driven robot, `(u_f, u_θ)` in the paper's section IV-A; zero is the null input.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Forward speed.
    pub v: MetersPerSecond,
    /// Turn rate, counter-clockwise positive.
    pub omega: RadiansPerSecond,
}

/// The frame of an atom's headings: the robot's heading by odometry when the outermost plan began, turned by
/// the enclosing `FRAME`s. A frame has no position, as a plan refers only to directions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Frame(pub Radians);

impl Frame {
    /// Returns this frame turned counter-clockwise.
    #[must_use]
    pub fn turned(self, by: Radians) -> Self {
        Self(Radians(self.0.0 + by.0))
    }

    /// Converts an angle of this frame to odometry coordinates.
    #[must_use]
    pub fn outward(&self, angle: Radians) -> Radians {
        Radians(self.0.0 + angle.0).wrapped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_circle_ends_beside_where_it_began() {
        let quarter = core::f64::consts::FRAC_PI_2;
        let pose = Pose::ORIGIN.moved(Meters(2.0 * quarter), Radians(quarter));
        assert_eq!([pose.x.0, pose.y.0, pose.theta.degrees()].map(|it| libm::round(it * 1e9) / 1e9), [2.0, 2.0, 90.0]);
        let back = pose.moved(Meters(-2.0 * quarter), Radians(-quarter));
        assert!(back.distance(&Pose::ORIGIN).0 < 1e-12);
        assert_eq!(Pose::ORIGIN.moved(Meters(3.0), Radians(0.0)), Pose { x: Meters(3.0), ..Pose::ORIGIN });
    }

    #[test]
    fn an_angle_of_a_frame_is_turned_by_its_heading() {
        let degrees = |angle: f64| Radians::from_degrees(angle);
        let frame = Frame(degrees(100.0));
        let outward = |frame: Frame, angle| libm::round(frame.outward(degrees(angle)).degrees() * 1e6) / 1e6;
        assert_eq!([0.0, 45.0, -100.0, 90.0].map(|angle| outward(frame, angle)), [100.0, 145.0, 0.0, -170.0]);
        assert_eq!(outward(frame.turned(degrees(-30.0)), 45.0), 115.0);
        assert_eq!(outward(Frame::default(), 360.0), 0.0);
    }
}
