//! `align i j`: turns until two sonars return equal ranges, `u_θ = k(r_i − r_j)` (paper, section IV-A).

use core::f64::consts::TAU;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Begin, Completes, Control, Law, Nanos, Ping, Radians, RadiansPerSecond, SONARS, SonarId, Twist};

use crate::gains::{Gains, fire_in_turn};

/// Minimum turn rate, in rad/s: a lower one does not move the wheels.
const SLOWEST: f64 = 0.08;
/// Differences of opposite sign that lie no further apart than this, in metres, have equal ranges between them; further
/// apart, one of the sonars looks past an edge, or has strayed.
const CONTINUOUS: f64 = 0.1;
/// Number of changes of the difference's sign without equal ranges after which no heading with equal ranges is
/// expected.
const CHANGES: u8 = 5;
/// A full circle at the slowest turn, in seconds: by then every heading has been tried.
const LONGEST: f64 = TAU / SLOWEST;
/// Largest distance from the final heading at which the robot is brought to rest.
const NEAR: Radians = Radians::from_degrees(1.0);

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

/// The law of [`Align`]: done when the ranges are equal, and where every turn brings a ping, when it stands at that
/// heading.
///
/// Beside a jamb, a corner or a door no heading may have equal ranges: one side of it the first range is longer, the
/// other side the second one. Then the law is done at the heading at which the ranges differed least, and the
/// difference that is left is that of the signals `r` of the two sonars.
///
/// A sonar that misses an echo now and then is waited for. While one sonar hears nothing for longer, the robot looks
/// for the wall, once round at most. If it has heard none by the time of a slow full circle, it is done where it
/// stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aligning {
    sonars: Align,
    began: Nanos,
    /// Time at which both sonars last heard an echo.
    heard: Option<Nanos>,
    last: Option<Sample>,
    /// Last sample with the least difference.
    best: Option<Sample>,
    /// Number of times that the sign of the difference has changed.
    changes: u8,
    end: Option<End>,
}

/// The difference of the ranges of both sonars, and the heading to which it belongs.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    /// Range of the first sonar minus that of the second, in metres.
    difference: f64,
    /// Mean of the headings at which the sonars pinged: where the ranges change evenly, they have this difference at
    /// this heading.
    heading: Radians,
}

/// The heading at which the law ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    heading: Radians,
    /// `true` if the law's last input stopped the robot at this heading.
    stands: bool,
}

impl Aligning {
    /// Returns the sample of the newest echoes, confirmed as in `atIsection`; `None` if either sonar hears nothing.
    fn sample<Y: SonarRing>(&self, y: &Y) -> Option<Sample> {
        let Align { first, second } = self.sonars;
        let ((first, near), (second, far)) = (nearest(y, first)?, nearest(y, second)?);
        let (from, to) = (first.pose.theta, second.pose.theta);
        Some(Sample { difference: near - far, heading: between(from, to, 0.5) })
    }

    /// The range that both sonars heard, if their ranges are equal.
    fn equal<Y: DiffDrive + SonarRing>(&self, y: &Y) -> Option<Sample> {
        self.sample(y).filter(|sample| sample.difference.abs() <= Gains::of(y).align_equal)
    }

    /// Takes a measurement in, which ends the law at equal ranges that it has passed.
    ///
    /// Pings that come in turn are of headings that lie degrees apart, and err by an inch: there a change of sign alone
    /// has no equal ranges in it.
    fn take(&mut self, sample: Sample, in_turn: bool) {
        let Some(last) = self.last.replace(sample).filter(|last| *last != sample) else {
            self.best = self.best.or(Some(sample));
            return;
        };
        if self.best.is_none_or(|best| sample.difference.abs() <= best.difference.abs()) {
            self.best = Some(sample);
        }
        if last.difference * sample.difference >= 0.0 {
            return;
        }
        self.changes = self.changes.saturating_add(1);
        let apart = (last.difference - sample.difference).abs();
        if apart <= CONTINUOUS && !in_turn {
            self.ends_at(between(last.heading, sample.heading, last.difference.abs() / apart));
        }
    }

    fn ends_at(&mut self, heading: Radians) {
        self.end = self.end.or(Some(End { heading, stands: false }));
    }

    /// Returns the turn rate, in rad/s, while only one sonar hears an echo: towards the sonar that hears it.
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
            // Nothing to align with; both heard is the business of `sample`.
            (false, false) | (true, true) => 0.0,
        }
    }

    /// Returns the turn rate towards equal ranges while the heading with equal ranges is not known yet.
    fn towards<Y: DiffDrive + SonarRing>(&self, y: &Y, sample: Option<Sample>, t: Nanos) -> f64 {
        let rate = sample.map_or_else(|| self.unheard(y, t), |sample| y.steering().align * sample.difference);
        self.sense() * bounded(rate, Gains::of(y).align_fastest)
    }

    /// 1 when the second sonar lies counter-clockwise of the first, as in all of the paper's plans; else -1, since the
    /// paper's formula would then turn away from equal ranges.
    fn sense(&self) -> f64 {
        let way = (SONARS + self.sonars.second.number() - self.sonars.first.number()) % SONARS;
        if way <= SONARS / 2 { 1.0 } else { -1.0 }
    }
}

/// The ping of least range among those that confirm each other, and its range in metres.
fn nearest<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<(&Ping, f64)> {
    let pings = y.pings(sonar).newest_first().take(y.confirmation());
    let heard = pings.filter_map(|ping| ping.range.map(|range| (ping, range.0)));
    heard.reduce(|one, other| if other.1 < one.1 { other } else { one })
}

/// The heading this part of the shorter way from one to another.
fn between(from: Radians, to: Radians, part: f64) -> Radians {
    Radians(from.0 + part * Radians(to.0 - from.0).wrapped().0)
}

/// A turn rate that gets the wheels moving, and is not too fast; nothing stays nothing.
fn bounded(rate: f64, fastest: f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate.abs().clamp(SLOWEST, fastest) * rate.signum() }
}

impl<Y: DiffDrive + SonarRing> Control<Y> for Align {
    type Law = Aligning;

    fn begin(&self, _: &Y, begin: Begin) -> Aligning {
        Aligning { sonars: *self, began: begin.now, heard: None, last: None, best: None, changes: 0, end: None }
    }
}

impl<Y: DiffDrive + SonarRing> Law<Y> for Aligning {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let sample = self.sample(y);
        if let Some(sample) = sample {
            self.heard = Some(t);
            self.take(sample, fire_in_turn(y));
        }
        if let Some(sample) = self.equal(y) {
            self.ends_at(sample.heading);
        }
        let is_late = t.since(self.began).seconds() > LONGEST;
        if self.changes >= CHANGES || is_late {
            let best = self.best.map(|best| best.heading);
            if let Some(heading) = best.or(is_late.then_some(y.here().theta)) {
                self.ends_at(heading);
            }
        }
        let Some(end) = &mut self.end else {
            let omega = RadiansPerSecond(self.towards(y, sample, t));
            return Twist { omega, ..Twist::default() };
        };
        let left = Radians(end.heading.0 - y.here().theta.0).wrapped();
        end.stands = left.0.abs() <= NEAR.0;
        let rate = if end.stands { 0.0 } else { bounded(y.steering().rotate * left.0, Gains::of(y).align_fastest) };
        Twist { omega: RadiansPerSecond(rate), ..Twist::default() }
    }
}

impl<Y: DiffDrive + SonarRing> Completes<Y> for Aligning {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        let is_near = |heading: Radians| Radians(heading.0 - y.here().theta.0).wrapped().0.abs() <= NEAR.0;
        self.end.is_some_and(|end| end.stands)
            || self.equal(y).is_some_and(|sample| fire_in_turn(y) || self.end.is_none() && is_near(sample.heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        /// Direction of the wall, in degrees.
        at: f64,
        /// The share of pings of the first and of the second sonar that bring nothing.
        misses: [f64; 2],
        /// Maximum error of a range, in metres.
        error: f64,
        confirmation: usize,
    }

    const EXACT: Wall = Wall { first: 7, second: 9, at: 180.0, misses: [0.0; 2], error: 0.0, confirmation: 3 };

    /// Runs `align` beside the wall for at most three minutes, started `off` degrees from square. Returns the final
    /// heading, in degrees from square, and `true` if the law is done. Where sonars fire in turn, each pings once a
    /// second.
    fn ended(wall: Wall, off: f64, seed: u64) -> (f64, bool) {
        let sonars = [SonarId::new(wall.first), SonarId::new(wall.second)];
        let mut y = Sensed { confirmation: wall.confirmation, ..Sensed::heading(off) };
        let mut law = Align::new(sonars[0], sonars[1]).begin(&y, begun());
        let mut chance = Chance(seed);
        for turn in 0..1800 {
            let t = Nanos(turn as u64 * 100_000_000);
            for (number, (sonar, misses)) in sonars.into_iter().zip(wall.misses).enumerate() {
                if fire_in_turn(&y) && (turn + 5 * number) % 10 != 0 {
                    continue;
                }
                let incidence = y.pose.theta.0 + sonar.bearing().0 - wall.at.to_radians();
                let range = 0.8 / libm::cos(incidence) - 0.19 + wall.error * (2.0 * chance.draw() - 1.0);
                let missed = chance.draw() < misses;
                y.ping_at(sonar, (!missed && (0.0..6.4).contains(&range)).then_some(range), t);
            }
            if law.completed(&y, t) {
                return (y.pose.theta.wrapped().degrees(), true);
            }
            let input = law.input(&y, t);
            assert_eq!(input.v.0, 0.0);
            y.drive(input);
        }
        (y.pose.theta.wrapped().degrees(), false)
    }

    /// Returns the final heading, in degrees from square, of a run without errors; panics if the law is not done.
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
                    let most = if confirmation == 3 { 2.0 } else { 5.0 };
                    assert!(end.abs() < most, "align {first} {second} from {off}: {end}");
                }
            }
        }
    }

    #[test]
    fn the_order_of_the_sonars_does_not_matter() {
        assert!(aligned(9, 7, 180.0, 20.0, 3).abs() < 2.0);
    }

    #[test]
    fn turns_towards_the_sonar_that_hears_the_wall() {
        // 75 degrees off, sonar 7 looks past the wall.
        assert!(aligned(7, 9, 180.0, -75.0, 3).abs() < 2.0);
        assert!(aligned(7, 9, 180.0, 75.0, 3).abs() < 2.0);
    }

    #[test]
    fn errors_and_missed_echoes_do_not_keep_it_from_the_wall() {
        for misses in [[0.0; 2], [0.3, 0.0], [0.0, 0.3], [0.2; 2]] {
            for confirmation in [3, 2] {
                for seed in 0..40 {
                    let off = 8.0 * ((seed % 9) as f64 - 4.0);
                    let wall = Wall { misses, error: 0.02, confirmation, ..EXACT };
                    let (end, done) = ended(wall, off, seed + 4);
                    // Two ranges that are 2 cm wrong make 3 degrees, and pings that come once a second are of where it
                    // was.
                    let most = if confirmation == 3 { 5.0 } else { 10.0 };
                    assert!(done && end.abs() < most, "from {off}, misses {misses:?}, {confirmation}: {end}, {done}");
                }
            }
        }
    }

    #[test]
    fn beside_a_dead_sonar_it_looks_round_once_and_is_done() {
        for confirmation in [3, 2] {
            let mut y = Sensed { confirmation, ..Sensed::default() };
            let mut law = Align::new(SonarId::new(7), SonarId::new(9)).begin(&y, begun());
            let mut turned = 0.0;
            for turn in 0..1000 {
                y.ping(SonarId::new(7), Some(0.6));
                y.ping(SonarId::new(9), None);
                let t = Nanos(turn * 100_000_000);
                // 79 s are a full circle at the slowest turn.
                assert_eq!(law.completed(&y, t), turn > 786, "{}", t.seconds());
                let input = law.input(&y, t);
                turned += input.omega.0.to_degrees() * crate::trial::PERIOD;
                y.drive(input);
            }
            assert!((-365.0..=-355.0).contains(&turned), "{turned}");
            assert_eq!(y.velocity, Twist::default());
        }
    }

    /// Runs `align` by the ranges that its two sonars return at a heading in degrees, for three minutes: when it is
    /// done, in seconds, and at which heading.
    fn done(sonars: [u8; 2], off: f64, ranges: impl Fn(f64) -> [f64; 2]) -> Option<(u64, f64)> {
        let sonars = sonars.map(SonarId::new);
        let mut y = Sensed::heading(off);
        let mut law = Align::new(sonars[0], sonars[1]).begin(&y, begun());
        for turn in 0..1800 {
            let t = Nanos(turn * 100_000_000);
            let heading = y.pose.theta.wrapped().degrees();
            for (sonar, range) in sonars.into_iter().zip(ranges(heading)) {
                y.ping_at(sonar, Some(range), t);
            }
            if law.completed(&y, t) {
                assert_eq!(y.velocity, Twist::default(), "it stands");
                return Some((turn / 10, heading));
            }
            let input = law.input(&y, t);
            y.drive(input);
        }
        None
    }

    #[test]
    fn beside_an_edge_it_ends_where_ranges_differ_least() {
        // Up to one degree the second sonar hears a jamb, beyond it the wall of the room behind. A jamb is believed for
        // three pings, while the robot turns on.
        for off in [-20.0, 0.0, 3.0, 20.0] {
            let (seconds, heading) =
                done([7, 9], off, |heading| [0.9, if heading < 1.0 { 0.6 } else { 2.0 }]).expect("an end");
            assert!(seconds < 30 && (-3.0..=5.0).contains(&heading), "from {off}: {heading} after {seconds} s");
        }
    }

    #[test]
    fn where_one_range_is_always_longer_it_ends_too() {
        let longer = |heading: f64| [1.0 + 0.3 * libm::cos((heading - 50.0).to_radians()), 0.6];
        let (seconds, heading) = done([7, 9], 0.0, longer).expect("an end");
        assert!(seconds < 120 && (heading + 130.0).abs() < 5.0, "{heading} after {seconds} s");
    }

    #[test]
    fn one_sonar_twice_is_equal_and_opposite_ones_end() {
        assert_eq!(done([7, 7], 10.0, |_| [0.5, 0.5]), Some((0, 10.0)));
        assert!(done([4, 12], 10.0, |_| [0.5, 0.9]).is_some());
    }

    #[test]
    fn without_any_echo_it_stands_still_and_ends_in_time() {
        let y = Sensed::default();
        let mut law = Align::new(SonarId::new(7), SonarId::new(9)).begin(&y, begun());
        for (seconds, is_done) in [(0, false), (60, false), (80, true)] {
            let t = Nanos(seconds * 1_000_000_000);
            assert_eq!(law.input(&y, t), Twist::default());
            assert_eq!(law.completed(&y, t), is_done, "after {seconds} s");
        }
    }
}
