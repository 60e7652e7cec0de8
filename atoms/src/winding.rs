//! Computes the angle by which a robot has turned since an atom began. Wheels that skid make an error in each turn that
//! is about the same fraction of the turn, so the error of the heading by odometry increases with every full circle,
//! and decreases when the robot turns back.

use core::f64::consts::TAU;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Pose, Radians};

use crate::gains::Gains;

/// Angle, in radians, up to which the robot always turns the shorter way.
const SHORT: f64 = core::f64::consts::FRAC_PI_2;

/// Angle, in radians, from which a direction is treated as behind the robot. Such a direction may be to the left of the
/// robot in one turn and to the right in the next.
const BEHIND: f64 = 2.6;
/// Angle, in radians, between two successive outputs above which the robot is treated as turning.
const TURNS: f64 = 0.01;

/// The angle turned, counter-clockwise positive, which may exceed a full circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Winding {
    turned: f64,
    /// Angle turned between the last two outputs, counter-clockwise positive.
    last: f64,
    /// Angle turned from which the robot turns back instead of continuing in the same direction.
    most: f64,
}

impl Winding {
    /// Returns the winding of a body that has not turned yet.
    pub(crate) fn begin<Y: DiffDrive + SonarRing>(y: &Y) -> Self {
        Self { turned: 0.0, last: 0.0, most: Gains::of(y).winds_most }
    }

    /// Adds the turn from one pose to the next.
    pub(crate) fn take(&mut self, before: &Pose, here: &Pose) {
        self.last = Radians(here.theta.0 - before.theta.0).wrapped().0;
        self.turned += self.last;
    }

    /// Returns the angle turned since the law began, counter-clockwise positive.
    pub(crate) fn turned(self) -> Radians {
        Radians(self.turned)
    }

    /// Returns the angle by which the robot has to turn to a direction at the angle `off`, from -π to π. It is the
    /// angle of the longer turn in two cases: `off` is large, and the robot has already turned far in the direction of
    /// `off`; or the direction is behind the robot, and the robot is turning away from `off`.
    pub(crate) fn turn_to(self, Radians(off): Radians) -> Radians {
        let (total, longer) = (self.turned + off, off - TAU.copysign(off));
        let winds = off.abs() > SHORT && total.abs() > self.most && total * off > 0.0;
        let turns_on = off.abs() > BEHIND && self.last * longer > 0.0 && self.last.abs() > TURNS;
        let is_far = (self.turned + longer).abs() > self.most;
        Radians(if winds || turns_on && !is_far { longer } else { off })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, sized};

    /// Returns the angle, in degrees, by which a body has to turn to a direction at the angle `off`, after it has
    /// turned from the heading 0 by these steps.
    fn turn_to(y: &Sensed, steps: &[f64], off: f64) -> f64 {
        let at = |degrees: f64| Pose { theta: Radians::from_degrees(degrees), ..Pose::ORIGIN };
        let (mut winding, mut before) = (Winding::begin(y), at(0.0));
        for step in steps {
            let here = at(before.theta.degrees() + step);
            winding.take(&before, &here);
            before = here;
        }
        libm::round(winding.turn_to(Radians::from_degrees(off)).degrees())
    }

    #[test]
    fn a_body_that_skids_turns_back_after_a_circle() {
        let atrv = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        assert_eq!(turn_to(&atrv, &[90.0], 150.0), 150.0);
        assert_eq!(turn_to(&atrv, &[90.0, 90.0, 90.0], 150.0), -210.0);
        assert_eq!(turn_to(&atrv, &[-170.0, -170.0], -100.0), 260.0);
        assert_eq!(turn_to(&atrv, &[90.0, 90.0, 90.0], 80.0), 80.0, "a small turn is not worth a circle");
        assert_eq!(turn_to(&atrv, &[170.0, 170.0, 170.0], -150.0), -150.0, "it turns back already");
    }

    #[test]
    fn a_robot_turns_on_to_a_direction_behind_it() {
        let scout = Sensed { confirmation: 2, ..Sensed::default() };
        assert_eq!(turn_to(&scout, &[5.0], 175.0), 175.0);
        assert_eq!(turn_to(&scout, &[5.0], -175.0), 185.0, "it would turn to and fro");
        assert_eq!(turn_to(&scout, &[-5.0], 160.0), -200.0);
        assert_eq!(turn_to(&scout, &[5.0], -140.0), -140.0, "the direction is on its right");
        assert_eq!(turn_to(&scout, &[5.0, 0.3], -175.0), -175.0, "it hardly turns");
        let atrv = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        assert_eq!(turn_to(&atrv, &[90.0, 5.0], -175.0), -175.0, "it has turned far");
    }

    #[test]
    fn a_body_that_skids_little_takes_the_shorter_turn() {
        let scout = Sensed { confirmation: 2, ..Sensed::default() };
        assert_eq!(turn_to(&scout, &[170.0, 170.0, 170.0], 150.0), 150.0);
    }
}
