//! The ring of sixteen sonars: each hears the nearest wall in its cone; all ping in every turn.

use std::f64::consts::TAU;

use mdle_runtime::{Meters, Nanos, Ping, Pings, Pose, Radians, SONARS, SonarId};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::walls::Walls;
use crate::world::Place;

/// The distance of the transducers from the centre of the body, in metres; ranges are measured from there.
pub(crate) const RING_RADIUS: f64 = 0.19;
/// The longest range, in metres: 255 inches.
pub(crate) const RANGE_MOST: f64 = 6.477;
/// The rays of a cone, evenly spread.
const RAYS: u8 = 7;
/// From the axis of a cone to its edge.
const HALF_CONE: Radians = Radians::from_degrees(12.5);
/// The spread of the range, in metres, with noise.
const SPREAD: f64 = 0.015;
/// The share of pings, with noise, that bring no echo.
const MISSES: f64 = 0.01;

/// The sonars and their last pings.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    pub(crate) pings: [Pings; SONARS],
    noise: Option<ChaCha8Rng>,
}

impl Ring {
    /// A ring that is exact, or noisy from this seed on.
    pub(crate) fn new(seed: Option<u64>) -> Self {
        Self { pings: [Pings::default(); SONARS], noise: seed.map(ChaCha8Rng::seed_from_u64) }
    }

    /// Pings all sixteen from the robot at `pose`, which is at `odometry` by its own reckoning.
    pub(crate) fn ping(&mut self, pose: &Pose, odometry: Pose, at: Nanos, walls: &Walls) {
        for (number, pings) in (0..).zip(&mut self.pings) {
            let exact = range(pose, SonarId::new(number), walls);
            let heard = match &mut self.noise {
                Some(noise) => noisy(exact, noise),
                None => exact,
            };
            pings.push(Ping { range: heard.filter(|range| *range < RANGE_MOST).map(Meters), at, pose: odometry });
        }
    }
}

/// The distance from a transducer to the nearest wall in its cone, in metres.
pub(crate) fn range(pose: &Pose, sonar: SonarId, walls: &Walls) -> Option<f64> {
    let axis = Radians(pose.theta.0 + sonar.bearing().0);
    let transducer = Place::of(&pose.towards(axis, Meters(RING_RADIUS)));
    let rays = (0..RAYS).map(|ray| {
        let part = f64::from(ray) / f64::from(RAYS - 1);
        Radians(axis.0 + HALF_CONE.0 * (2.0 * part - 1.0))
    });
    let hits = rays.filter_map(|direction| walls.ray(transducer, direction, RANGE_MOST));
    hits.reduce(f64::min)
}

/// What is heard of an exact range. Every ping draws the same number of numbers, whatever it hears.
fn noisy(exact: Option<f64>, noise: &mut ChaCha8Rng) -> Option<f64> {
    let missed = uniform(noise) < MISSES;
    let error = SPREAD * normal(noise);
    exact.filter(|_| !missed).map(|range| (range + error).max(0.0))
}

/// A number from the standard normal distribution, by Box and Muller's transform.
fn normal(noise: &mut ChaCha8Rng) -> f64 {
    let (one, other) = (uniform(noise), uniform(noise));
    // 1 - u lies above 0, where the logarithm is finite.
    libm::sqrt(-2.0 * libm::log(1.0 - one)) * libm::cos(TAU * other)
}

/// A number from 0 up to, not including, 1.
fn uniform(noise: &mut ChaCha8Rng) -> f64 {
    // The upper 53 bits are all that an f64 can hold.
    (noise.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;

    fn walls(text: &str) -> Walls {
        Walls::of(&World::parse("walls", text).expect("good walls"))
    }

    /// The range of the sonar that looks ahead.
    fn ahead(text: &str) -> Option<f64> {
        range(&Pose::ORIGIN, SonarId::new(0), &walls(text))
    }

    #[test]
    fn a_range_begins_at_the_transducer() {
        let front = ahead("[[wall]]\npoints = [[2, -1], [2, 1]]").expect("a wall ahead");
        assert!((front - 1.81).abs() < 1e-12, "{front}");
    }

    #[test]
    fn sonars_count_counter_clockwise_from_the_front() {
        let left = walls("[[wall]]\npoints = [[-1, 2], [1, 2]]");
        let heard: Vec<u8> =
            (0..16).filter(|sonar| range(&Pose::ORIGIN, SonarId::new(*sonar), &left).is_some()).collect();
        assert_eq!(heard, [3, 4, 5]);
    }

    #[test]
    fn a_cone_sees_what_its_axis_does_not() {
        // A post 2 m away, seen at 11 and at 14 degrees off the axis of the cone.
        let post = |degrees: f64| {
            let at = Pose::ORIGIN
                .towards(Radians(0.0), Meters(RING_RADIUS))
                .towards(Radians::from_degrees(degrees), Meters(2.0));
            ahead(&format!("[[box]]\ncentre = [{}, {}]\nsize = [0.1, 0.1]", at.x.0, at.y.0))
        };
        assert!(post(11.0).is_some_and(|range| (1.9..2.0).contains(&range)));
        assert!(post(-11.0).is_some());
        assert_eq!(post(14.5), None);
    }

    #[test]
    fn nothing_within_range_is_no_echo() {
        assert_eq!(ahead("[[wall]]\npoints = [[6.68, -9], [6.68, 9]]"), None);
        assert!(ahead("[[wall]]\npoints = [[6.66, -9], [6.66, 9]]").is_some());
    }

    #[test]
    fn a_seed_makes_the_noise_that_it_says_it_does() {
        let mut ring = Ring::new(Some(5));
        let (mut errors, mut missed) = (Vec::new(), 0);
        for _ in 0..20_000 {
            match noisy(Some(1.81), ring.noise.as_mut().expect("seeded")) {
                Some(range) => errors.push(range - 1.81),
                None => missed += 1,
            }
        }
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let spread = libm::sqrt(errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / count);
        assert!(mean.abs() < 5e-4, "{mean}");
        assert!((spread - SPREAD).abs() < 5e-4, "{spread}");
        assert!((150..250).contains(&missed), "{missed}");
    }
}
