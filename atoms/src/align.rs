//! `align i j`: turns until two sonars return equal ranges, `u_θ = k(r_i − r_j)` (paper, section IV-A).

use core::f64::consts::TAU;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Begin, Completes, Control, Law, Meters, Nanos, RadiansPerSecond, SONARS, SonarId, Twist};

use crate::gains::Gains;

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
///
/// A sonar that misses an echo now and then is waited for. While one hears nothing for longer, the robot looks for the wall,
/// once round at most: then it stands still and is not done, and what ends the atom is for the plan to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aligning {
    sonars: Align,
    began: Nanos,
    /// When both sonars were last heard.
    heard: Option<Nanos>,
}

impl Aligning {
    /// How much further the first sonar's echo is, by the same confirmation as in `atIsection`; `None` when either
    /// hears nothing.
    fn difference<Y: SonarRing>(&self, y: &Y) -> Option<Meters> {
        let range = |sonar| y.pings(sonar).nearest(y.confirmation());
        Some(Meters(range(self.sonars.first)?.0 - range(self.sonars.second)?.0))
    }

    /// Which way to turn when only one of them hears an echo: towards the one that does.
    fn unheard<Y: DiffDrive + SonarRing>(&self, y: &Y, t: Nanos) -> f64 {
        let Gains { align_waits: waits, align_fastest: fastest, .. } = *Gains::of(y);
        let (since, waits) = self.heard.map_or((self.began, 0.0), |heard| (heard, waits));
        if !(waits..waits + TAU / fastest).contains(&t.since(since).seconds()) {
            return 0.0;
        }
        let heard = |sonar| y.pings(sonar).nearest(y.confirmation()).is_some();
        match (heard(self.sonars.first), heard(self.sonars.second)) {
            (false, true) => fastest,
            (true, false) => -fastest,
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

    fn begin(&self, _: &Y, begin: Begin) -> Aligning {
        Aligning { sonars: *self, began: begin.now, heard: None }
    }
}

impl<Y: DiffDrive + SonarRing> Law<Y> for Aligning {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let rate = match self.difference(y) {
            Some(Meters(difference)) => {
                self.heard = Some(t);
                y.steering().align * difference
            }
            None => self.unheard(y, t),
        };
        let fastest = Gains::of(y).align_fastest;
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
    use crate::gains::fire_in_turn;
    use crate::trial::{Sensed, begun};

    /// Numbers from 0 to 1 that look as if drawn by chance.
    struct Chance(u64);

    impl Chance {
        fn draw(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as f64 / (1_u64 << 31) as f64
        }
    }

    /// A straight wall 0.8 m from the robot, and how well two sonars hear it.
    #[derive(Clone, Copy)]
    struct Wall {
        first: u8,
        second: u8,
        /// Where it is, in degrees.
        at: f64,
        /// The share of pings of the first and of the second sonar that bring nothing.
        misses: [f64; 2],
        /// By how much a range may be too long or too short, in metres.
        error: f64,
        confirmation: usize,
    }

    const EXACT: Wall = Wall { first: 7, second: 9, at: 180.0, misses: [0.0; 2], error: 0.0, confirmation: 3 };

    /// Runs `align` beside the wall, started `off` degrees from square, for three minutes: how far from square it ends, in
    /// degrees, and whether it is done. Where sonars fire in turn, each pings once a second.
    fn ended(wall: Wall, off: f64, seed: u64) -> (f64, bool) {
        let sonars = [SonarId::new(wall.first), SonarId::new(wall.second)];
        let mut y = Sensed { confirmation: wall.confirmation, ..Sensed::heading(off) };
        let mut law = Align::new(sonars[0], sonars[1]).begin(&y, begun());
        let mut chance = Chance(seed);
        for turn in 0..1800 {
            for (number, (sonar, misses)) in sonars.into_iter().zip(wall.misses).enumerate() {
                if fire_in_turn(&y) && (turn + 5 * number) % 10 != 0 {
                    continue;
                }
                let incidence = y.pose.theta.0 + sonar.bearing().0 - wall.at.to_radians();
                let range = 0.8 / libm::cos(incidence) - 0.19 + wall.error * (2.0 * chance.draw() - 1.0);
                let missed = chance.draw() < misses;
                y.ping(sonar, (!missed && (0.0..6.4).contains(&range)).then_some(range));
            }
            let t = Nanos(turn as u64 * 100_000_000);
            if law.completed(&y, t) {
                return (y.pose.theta.wrapped().degrees(), true);
            }
            let input = law.input(&y, t);
            assert_eq!(input.v.0, 0.0);
            y.drive(input);
        }
        (y.pose.theta.wrapped().degrees(), false)
    }

    /// How far from square it ends where nothing goes wrong.
    fn aligned(first: u8, second: u8, at: f64, off: f64, confirmation: usize) -> f64 {
        let (end, done) = ended(Wall { first, second, at, confirmation, ..EXACT }, off, 0);
        assert!(done, "not aligned after three minutes, at {end} degrees");
        end
    }

    #[test]
    fn a_start_off_square_converges() {
        for off in [-40.0, -25.0, -10.0, -5.0, 5.0, 10.0, 25.0, 40.0] {
            for (first, second, wall) in [(7, 9, 180.0), (3, 5, 90.0), (11, 13, 270.0), (15, 1, 0.0)] {
                for confirmation in [3, 2] {
                    let end = aligned(first, second, wall, off, confirmation);
                    // Pings that come once a second are of where it was.
                    let most = if confirmation == 3 { 4.0 } else { 5.0 };
                    assert!(end.abs() < most, "align {first} {second} from {off}: {end}");
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
    fn errors_and_missed_echoes_do_not_keep_it_from_the_wall() {
        for misses in [[0.0; 2], [0.3, 0.0], [0.0, 0.3], [0.2; 2]] {
            for confirmation in [3, 2] {
                for seed in 0..40 {
                    let off = 8.0 * ((seed % 9) as f64 - 4.0);
                    let wall = Wall { misses, error: 0.02, confirmation, ..EXACT };
                    let (end, done) = ended(wall, off, seed + 4);
                    // Two ranges that are 2 cm wrong make 3 degrees, and pings that come once a second are of where it was.
                    let most = if confirmation == 3 { 5.0 } else { 10.0 };
                    assert!(done && end.abs() < most, "from {off}, misses {misses:?}, {confirmation}: {end}, {done}");
                }
            }
        }
    }

    #[test]
    fn beside_a_dead_sonar_it_looks_round_once_and_then_stands_still() {
        for confirmation in [3, 2] {
            let mut y = Sensed { confirmation, ..Sensed::default() };
            let mut law = Align::new(SonarId::new(7), SonarId::new(9)).begin(&y, begun());
            let mut turned = 0.0;
            for turn in 0..1000 {
                y.ping(SonarId::new(7), Some(0.6));
                y.ping(SonarId::new(9), None);
                let t = Nanos(turn * 100_000_000);
                assert!(!law.completed(&y, t));
                let input = law.input(&y, t);
                turned += input.omega.0.to_degrees() * crate::trial::PERIOD;
                y.drive(input);
            }
            assert!((-365.0..=-355.0).contains(&turned), "{turned}");
            assert_eq!(y.velocity, Twist::default());
        }
    }

    #[test]
    fn without_any_echo_it_stands_still_and_is_not_done() {
        let y = Sensed::default();
        let mut law = Align::new(SonarId::new(7), SonarId::new(9)).begin(&y, begun());
        assert_eq!(law.input(&y, Nanos(0)), Twist::default());
        assert!(!law.completed(&y, Nanos(0)));
    }
}
