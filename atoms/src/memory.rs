//! Stores the positions of the echoes of the last seconds. On a detour out of a corner, the sonars do not receive
//! echoes from all of the corner at once.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

/// Maximum number of stored positions.
pub(crate) const PLACES: usize = 96;
/// Distance, in metres, below which echoes are treated as one position.
const ONE_PLACE: f64 = 0.1;
/// Time after which a position is forgotten, so that an object that has left does not remain.
const KEPT: Nanos = Nanos(15_000_000_000);
/// Range, in metres, beyond which echoes are not stored.
const NEAR: f64 = 1.2;

/// A position of echoes, in odometry coordinates, with the time of the last echo there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Echo {
    x: f64,
    y: f64,
    at: Nanos,
}

/// Stores positions of echoes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    echoes: [Echo; PLACES],
    /// Number of stored positions, from the first entry on.
    count: usize,
}

impl Memory {
    pub(crate) const EMPTY: Self = Self { echoes: [Echo { x: 0.0, y: 0.0, at: Nanos::ZERO }; PLACES], count: 0 };

    /// Stores the positions of the sonars' newest echoes, except those beyond `NEAR`.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y) {
        for number in 0..SONARS as u8 {
            let sonar = SonarId::new(number);
            let newest = y.pings(sonar).newest_first().next();
            let Some((ping, range)) = newest.and_then(|ping| Some((ping, ping.range?))) else { continue };
            if range.0 < NEAR {
                let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
                let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
                self.keep(Echo { x: place.x.0, y: place.y.0, at: ping.at });
            }
        }
    }

    /// Stores an echo. If a stored position is within 10 cm of it, only the time of that position is updated. Otherwise
    /// the echo takes a free entry, or replaces the oldest one.
    fn keep(&mut self, heard: Echo) {
        let same = |place: &Echo| {
            let (x, y) = (place.x - heard.x, place.y - heard.y);
            // Most places differ enough along one axis alone.
            x.abs() < ONE_PLACE && y.abs() < ONE_PLACE && libm::hypot(x, y) < ONE_PLACE
        };
        if let Some(place) = self.echoes.iter_mut().take(self.count).find(|place| same(place)) {
            place.at = place.at.max(heard.at);
        } else if let Some(free) = self.echoes.get_mut(self.count) {
            *free = heard;
            self.count += 1;
        } else if let Some(oldest) = self.echoes.iter_mut().min_by_key(|place| place.at) {
            *oldest = heard;
        }
    }

    /// Returns the positions that are not forgotten at the time `now`, relative to `here`, along the axes of the
    /// odometry coordinates.
    pub(crate) fn around(&self, here: Pose, now: Nanos) -> impl Iterator<Item = (f64, f64)> {
        let kept = self.echoes.iter().take(self.count).filter(move |place| now.since(place.at) < KEPT);
        kept.map(move |place| (place.x - here.x.0, place.y - here.y.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    /// Returns the number of positions that are stored after the given pings straight ahead. Each ping is given by the
    /// distance of the robot along the first axis and the range.
    fn kept(pings: &[(f64, f64)], now: u64) -> usize {
        let (mut y, mut memory) = (Sensed::default(), Memory::EMPTY);
        for (x, range) in pings {
            y.pose.x = Meters(*x);
            y.ping(SonarId::new(0), Some(*range));
            memory.take(&y);
        }
        memory.around(y.pose, Nanos(now)).count()
    }

    #[test]
    fn one_place_is_kept_once_and_what_is_far_not_at_all() {
        assert_eq!(kept(&[(0.0, 1.0), (0.2, 0.8), (0.4, 0.61)], 0), 1);
        assert_eq!(kept(&[(0.0, 1.0), (0.4, 1.0)], 0), 2);
        assert_eq!(kept(&[(0.0, 1.5)], 0), 0);
    }

    #[test]
    fn what_was_heard_is_forgotten_in_time() {
        assert_eq!(kept(&[(0.0, 1.0)], KEPT.0 - 1), 1);
        assert_eq!(kept(&[(0.0, 1.0)], KEPT.0), 0);
    }

    #[test]
    fn the_oldest_place_makes_room() {
        let mut pings = [(0.0, 1.0); 200];
        for (number, ping) in (0..200_u32).zip(&mut pings) {
            ping.0 = f64::from(number);
        }
        assert_eq!(kept(&pings, 0), PLACES);
    }
}
