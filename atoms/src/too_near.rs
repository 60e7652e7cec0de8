//! The obstacles around a body that its sonars detect, but are too near to measure: such an obstacle may be at any
//! distance below the minimum range.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Nanos, Pose, SONARS, SonarId};

use crate::gains::Gains;

/// Maximum age of a ping. Each sonar of a Scout pings about twice in this time, because the second ping may miss a jamb
/// beside the body: at this distance, the cones of the sonars leave most of it unseen.
const LASTS: Nanos = Nanos(2_000_000_000);
/// Distance, in metres, that is assumed between the ring of the sonars and the obstacle.
const ASSUMED: f64 = 0.05;

/// The assumed places of these obstacles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TooNear {
    places: [Option<(f64, f64)>; SONARS],
}

impl TooNear {
    /// Returns the obstacles around the body of `y` at `here`.
    pub(crate) fn of<Y: DiffDrive + SonarRing>(y: &Y, here: Pose) -> Self {
        let gains = Gains::of(y);
        let least = gains.least_range.max(gains.saturates);
        let (sin, cos) = libm::sincos(here.theta.0);
        let mut sonars = (0..SONARS as u8).map(SonarId::new);
        let places = [(); SONARS].map(|()| {
            let sonar = sonars.next()?;
            let is_too_near = |range: Meters| range.0 < least;
            let ping = y.pings(sonar).newest_first().find(|ping| ping.range.is_some_and(is_too_near))?;
            if y.now().since(ping.at) > LASTS {
                return None;
            }
            let centre = ping.axis(sonar);
            let place = centre.towards(centre.theta, Meters(y.ring_radius().0 + ASSUMED));
            let (x, y) = (place.x.0 - here.x.0, place.y.0 - here.y.0);
            Some((x * cos + y * sin, y * cos - x * sin))
        });
        Self { places }
    }

    /// Returns the places relative to the body: the distances ahead of its centre and to the left of it, in metres.
    pub(crate) fn places(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.places.iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    /// Returns the number of obstacles for a body with these halves, `seconds` after a ping of the front sonar with
    /// this range. After it, another ping receives no echo.
    fn count(halves: [f64; 2], range: f64, seconds: u64) -> usize {
        let mut y = Sensed { confirmation: 2, halves, now: Nanos(5_000_000_000), ..Sensed::default() };
        y.ping_at(SonarId::new(0), Some(range), y.now);
        y.ping_at(SonarId::new(0), None, Nanos(y.now.0 + 1));
        y.now = Nanos(y.now.0 + 1_000_000_000 * seconds);
        TooNear::of(&y, Pose::ORIGIN).places().count()
    }

    #[test]
    fn an_echo_at_the_minimum_range_is_an_obstacle_for_two_seconds() {
        let scout = |range, seconds| count([0.205; 2], range, seconds);
        assert_eq!([scout(0.15, 0), scout(0.15, 2), scout(0.15, 3), scout(0.2, 0)], [1, 1, 0, 0]);
    }

    /// The transducers of an ATRV-mini are not on its ring.
    #[test]
    fn the_minimum_range_is_that_of_the_body() {
        assert_eq!([[0.205; 2], [0.315, 0.27]].map(|halves| count(halves, 0.17, 0)), [0, 1]);
    }
}
