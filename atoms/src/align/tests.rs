//! Tests `align` beside walls, with errors of the sonars, and in places where no heading has equal ranges.

use super::*;
use crate::trial::{Sensed, begun};

/// Pseudo-random numbers from 0 to 1.
struct Chance(u64);

impl Chance {
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }
}

/// A straight wall 0.8 m from the robot, with the quality of its echoes for two sonars.
#[derive(Clone, Copy)]
struct Wall {
    first: u8,
    second: u8,
    /// Direction of the wall, in degrees.
    at: f64,
    /// Fractions of pings without an echo, for the first and the second sonar.
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
                // Pings that come once a second were heard at an earlier heading.
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
                // Two range errors of 2 cm cause an error of 3 degrees, and pings that come once a second were heard at
                // an earlier heading.
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
            // A full circle at the minimum turn rate takes 79 s.
            assert_eq!(law.completed(&y, t), turn > 786, "{}", t.seconds());
            let input = law.input(&y, t);
            turned += input.omega.0.to_degrees() * crate::trial::PERIOD;
            y.drive(input);
        }
        assert!((-365.0..=-355.0).contains(&turned), "{turned}");
        assert_eq!(y.velocity, Twist::default());
    }
}

/// Runs `align` for three minutes, with the ranges that its two sonars return at a heading in degrees. Returns
/// the time at which the law is done, in seconds, and the heading; `None` if it is not done.
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
    // Up to one degree the second sonar hears a jamb, beyond it the wall of the room behind. The echo of the jamb
    // counts for three pings, while the robot keeps turning.
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
