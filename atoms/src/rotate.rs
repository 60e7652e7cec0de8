//! `rotate α`: turns to a heading in the current frame, by the shorter turn (paper, section IV-A).

use mdle_runtime::capability::{DiffDrive, Odometry};
use mdle_runtime::{Begin, Completes, Control, Law, Nanos, Radians, Twist};

use crate::heading::{turned, turning};

/// The control `rotate`: `u_θ = k(α − θ)`, `u_f = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotate {
    heading: Radians,
}

impl Rotate {
    /// Creates the quark `rotate heading`, for a heading in the frame in which the atom begins.
    #[must_use]
    pub const fn new(heading: Radians) -> Self {
        Self { heading }
    }
}

/// The law of [`Rotate`], which is done when the robot is at rest within 2° of the heading.
///
/// A robot that measures the drift of its heading at a wall corrects the final heading by this drift when the atom
/// begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotating {
    /// The final heading by odometry.
    goal: Radians,
    /// Time of the previous request for an input; `None` before the first.
    before: Option<Nanos>,
}

impl Rotating {
    /// Returns the remaining angle, by the shorter turn.
    fn left<Y: Odometry>(&self, y: &Y) -> Radians {
        Radians(self.goal.0 - y.pose().theta.0).wrapped()
    }
}

impl<Y: DiffDrive + Odometry> Control<Y> for Rotate {
    type Law = Rotating;

    fn begin(&self, y: &Y, begin: Begin) -> Rotating {
        let drift = y.drift(begin.frame.outward(Radians(0.0)));
        Rotating { goal: Radians(begin.frame.outward(self.heading).0 + drift.0), before: None }
    }
}

impl<Y: DiffDrive + Odometry> Law<Y> for Rotating {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        turning(self.left(y), y.steering().rotate, self.before.replace(t), t)
    }
}

impl<Y: DiffDrive + Odometry> Completes<Y> for Rotating {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        turned(self.left(y), y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun, framed, until_completed};

    #[test]
    fn turns_the_shortest_way_round() {
        for (from, to, way) in [(170.0, 190.0, 20.0), (-170.0, 170.0, -20.0), (0.0, 270.0, -90.0), (350.0, 10.0, 20.0)]
        {
            let mut y = Sensed::heading(from);
            let mut law = Rotate::new(Radians::from_degrees(to)).begin(&y, begun());
            let turned = until_completed(&mut law, &mut y);
            assert!((turned - way).abs() <= 2.0, "from {from} to {to}: {turned}");
        }
    }

    #[test]
    fn the_heading_is_meant_in_the_frame_of_the_atom() {
        let mut y = Sensed::heading(0.0);
        let mut law = Rotate::new(Radians::from_degrees(90.0)).begin(&y, framed(180.0));
        let turned = until_completed(&mut law, &mut y);
        assert!((turned + 90.0).abs() <= 2.0, "{turned}");
    }

    #[test]
    fn is_not_done_before_it_is_at_rest() {
        let mut y = Sensed::heading(90.0);
        let law = Rotate::new(Radians::from_degrees(90.0)).begin(&y, begun());
        assert!(law.completed(&y, Nanos(0)));
        y.velocity.omega.0 = 0.4;
        assert!(!law.completed(&y, Nanos(0)));
    }
}
