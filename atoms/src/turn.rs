//! `turn α`: turns by an angle from the heading at which the atom begins. The law is not in the paper; this project has
//! added it beside the paper's `rotate` (section IV-A).

use mdle_runtime::capability::{DiffDrive, Odometry};
use mdle_runtime::{Begin, Completes, Control, Law, Nanos, Radians, Twist};

use crate::heading::{turned, turning};

/// The control `turn`: `u_θ = k(α − angle turned so far)`, `u_f = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    angle: Radians,
}

impl Turn {
    /// Creates the quark `turn angle`. The angle is positive for a counter-clockwise turn, and may exceed a full
    /// circle.
    #[must_use]
    pub const fn new(angle: Radians) -> Self {
        Self { angle }
    }
}

/// The law of [`Turn`], which is done when the robot is at rest and has turned by the angle, within 2°.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    angle: Radians,
    /// The angle turned between the beginning of the atom and the heading `last`. It is added up in each turn of the
    /// machine, because a heading does not distinguish 270° from -90°.
    so_far: Radians,
    /// The heading in the last turn.
    last: Radians,
    /// Time of the previous request for an input; `None` before the first.
    before: Option<Nanos>,
}

impl Turning {
    /// Returns the angle turned since the atom began.
    fn so_far<Y: Odometry>(&self, y: &Y) -> Radians {
        Radians(self.so_far.0 + Radians(y.pose().theta.0 - self.last.0).wrapped().0)
    }

    /// Returns the remaining angle.
    fn left<Y: Odometry>(&self, y: &Y) -> Radians {
        Radians(self.angle.0 - self.so_far(y).0)
    }
}

impl<Y: DiffDrive + Odometry> Control<Y> for Turn {
    type Law = Turning;

    fn begin(&self, y: &Y, _: Begin) -> Turning {
        Turning { angle: self.angle, so_far: Radians(0.0), last: y.pose().theta, before: None }
    }
}

impl<Y: DiffDrive + Odometry> Law<Y> for Turning {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        self.so_far = self.so_far(y);
        self.last = y.pose().theta;
        turning(self.left(y), y.steering().rotate, self.before.replace(t), t)
    }
}

impl<Y: DiffDrive + Odometry> Completes<Y> for Turning {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        turned(self.left(y), y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun, framed, until_completed};

    #[test]
    fn turns_by_its_angle_whatever_the_heading_and_the_frame() {
        for angle in [30.0, -90.0, 180.0, 270.0, -450.0] {
            let mut y = Sensed::heading(100.0);
            let mut law = Turn::new(Radians::from_degrees(angle)).begin(&y, framed(77.0));
            let turned = until_completed(&mut law, &mut y);
            assert!((turned - angle).abs() <= 2.0, "{angle}: {turned}");
        }
    }

    #[test]
    fn nothing_to_turn_is_done_at_once() {
        let y = Sensed::heading(100.0);
        assert!(Turn::new(Radians(0.0)).begin(&y, begun()).completed(&y, Nanos(0)));
    }
}
