//! `align i j`: turns until two sonars return equal ranges, `u_θ = k(r_i − r_j)` (paper, section IV-A).

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Begin, Completes, Control, Law, Meters, Nanos, RadiansPerSecond, SONARS, SonarId, Twist};

/// `k`, in rad/s for each metre of difference.
const GAIN: f64 = 2.0;
/// The fastest turn, in rad/s, where every turn brings a ping of each sonar.
const FASTEST: f64 = 0.3;
/// The fastest turn where sonars fire one after the other: the ranges are older.
const FASTEST_IN_TURN: f64 = 0.12;
/// The slowest turn, in rad/s: less would not get the wheels moving.
const SLOWEST: f64 = 0.08;
/// Ranges that differ by this much or less are equal: one inch, the resolution of the paper's sonars.
const EQUAL: Meters = Meters(0.026);

/// `u_θ = k(r_i − r_j)`, `u_f = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Align {
    first: SonarId,
    second: SonarId,
}

impl Align {
    /// The quark `align first second`.
    #[must_use]
    pub const fn new(first: SonarId, second: SonarId) -> Self {
        Self { first, second }
    }
}

/// The law of [`Align`]: done when both sonars hear an echo and their ranges are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aligning {
    sonars: Align,
}

impl Aligning {
    /// How much further the first sonar's echo is, by the same confirmation as in `atIsection`; `None` when either
    /// hears nothing.
    fn difference<Y: SonarRing>(&self, y: &Y) -> Option<Meters> {
        let range = |sonar| y.pings(sonar).nearest(y.confirmation());
        Some(Meters(range(self.sonars.first)?.0 - range(self.sonars.second)?.0))
    }

    /// Which way to turn when only one of them hears an echo: towards the one that does.
    fn unheard<Y: SonarRing>(&self, y: &Y) -> f64 {
        let heard = |sonar| y.pings(sonar).nearest(y.confirmation()).is_some();
        match (heard(self.sonars.first), heard(self.sonars.second)) {
            (false, true) => FASTEST,
            (true, false) => -FASTEST,
            // Nothing to align with; both heard is the business of `difference`.
            (false, false) | (true, true) => 0.0,
        }
    }

    /// 1 when the second sonar lies counter-clockwise of the first, as in all of the paper's plans; else -1, since the
    /// paper's formula would then turn away from equal ranges.
    fn sense(&self) -> f64 {
        let way = (SONARS + self.sonars.second.number() - self.sonars.first.number()) % SONARS;
        if way <= SONARS / 2 { 1.0 } else { -1.0 }
    }
}

impl<Y: DiffDrive + SonarRing> Control<Y> for Align {
    type Law = Aligning;

    fn begin(&self, _: &Y, _: Begin) -> Aligning {
        Aligning { sonars: *self }
    }
}

impl<Y: DiffDrive + SonarRing> Law<Y> for Aligning {
    type Input = Twist;

    fn input(&mut self, y: &Y, _: Nanos) -> Twist {
        let rate = match self.difference(y) {
            Some(Meters(difference)) => GAIN * difference,
            None => self.unheard(y),
        };
        let fastest = if y.confirmation() < 3 { FASTEST_IN_TURN } else { FASTEST };
        let omega = match rate.abs() {
            0.0 => 0.0,
            size => self.sense() * size.clamp(SLOWEST, fastest) * rate.signum(),
        };
        Twist { omega: RadiansPerSecond(omega), ..Twist::default() }
    }
}

impl<Y: DiffDrive + SonarRing> Completes<Y> for Aligning {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        self.difference(y).is_some_and(|difference| difference.0.abs() <= EQUAL.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun};

    /// Runs `align first second` beside a straight wall 0.8 m away in direction `wall` (degrees), started `off`
    /// degrees from square; how far from square it ends, in degrees.
    fn aligned(first: u8, second: u8, wall: f64, off: f64, confirmation: usize) -> f64 {
        let sonars = [SonarId::new(first), SonarId::new(second)];
        let mut y = Sensed { confirmation, ..Sensed::heading(off) };
        let mut law = Align::new(sonars[0], sonars[1]).begin(&y, begun());
        for _ in 0..600 {
            for sonar in sonars {
                let incidence = y.pose.theta.0 + sonar.bearing().0 - wall.to_radians();
                let range = 0.8 / libm::cos(incidence) - 0.19;
                y.ping(sonar, (0.0..6.4).contains(&range).then_some(range));
            }
            if law.completed(&y, Nanos(0)) {
                return y.pose.theta.degrees();
            }
            let input = law.input(&y, Nanos(0));
            assert_eq!(input.v.0, 0.0);
            y.drive(input);
        }
        panic!("not aligned after a minute, at {} degrees", y.pose.theta.degrees());
    }

    #[test]
    fn a_start_off_square_converges() {
        for off in [-40.0, -25.0, -10.0, -5.0, 5.0, 10.0, 25.0, 40.0] {
            for (first, second, wall) in [(7, 9, 180.0), (3, 5, 90.0), (11, 13, 270.0), (15, 1, 0.0)] {
                for confirmation in [3, 2] {
                    let end = aligned(first, second, wall, off, confirmation);
                    assert!(end.abs() < 4.0, "align {first} {second} from {off}: {end}");
                }
            }
        }
    }

    #[test]
    fn the_order_of_the_sonars_does_not_matter() {
        assert!(aligned(9, 7, 180.0, 20.0, 3).abs() < 4.0);
    }

    #[test]
    fn turns_towards_the_sonar_that_hears_the_wall() {
        // 75 degrees off, sonar 7 looks past the wall.
        assert!(aligned(7, 9, 180.0, -75.0, 3).abs() < 4.0);
        assert!(aligned(7, 9, 180.0, 75.0, 3).abs() < 4.0);
    }

    #[test]
    fn without_any_echo_it_stands_still_and_is_not_done() {
        let y = Sensed::default();
        let mut law = Align::new(SonarId::new(7), SonarId::new(9)).begin(&y, begun());
        assert_eq!(law.input(&y, Nanos(0)), Twist::default());
        assert!(!law.completed(&y, Nanos(0)));
    }
}
