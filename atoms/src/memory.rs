//! Stores the positions of the echoes of the last seconds. On a detour out of a corner, the sonars do not receive
//! echoes from all of the corner at once.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

/// Maximum number of stored positions.
pub(crate) const PLACES: usize = 96;
/// Distance, in metres, below which echoes count as one place.
const ONE_PLACE: f32 = 0.1;
/// Time, in milliseconds, after which a place is forgotten, so that an object that has left does not remain.
const KEPT: i32 = 15_000;
/// Range, in metres, beyond which echoes are not kept.
const NEAR: f64 = 1.2;

/// The position of an echo, in odometry coordinates, with the time of the last echo there.
///
/// In single precision a place 1 km away is exact to 0.03 mm, far below the resolution of a sonar, and the places take
/// half of the memory.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Echo {
    x: f32,
    y: f32,
    at: Millis,
}

/// A time in whole milliseconds, which begins again at 0 after 49 days.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Millis(u32);

impl Millis {
    fn of(time: Nanos) -> Self {
        // The upper bits are dropped.
        Self((time.0 / 1_000_000) as u32)
    }

    /// Returns the time since `earlier`, which is at most 24 days ago; 0 if `earlier` is later.
    fn since(self, earlier: Self) -> i32 {
        (self.0.wrapping_sub(earlier.0) as i32).max(0)
    }
}

/// Stores positions of echoes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    echoes: [Echo; PLACES],
    /// Number of stored positions, from the first entry on.
    count: usize,
    /// For each sonar, time of its last ping that was read; [`Nanos::MAX`] before the first one.
    read: [Nanos; SONARS],
}

impl Memory {
    pub(crate) const EMPTY: Self =
        Self { echoes: [Echo { x: 0.0, y: 0.0, at: Millis(0) }; PLACES], count: 0, read: [Nanos::MAX; SONARS] };

    /// Stores the positions of the sonars' newest echoes that have not been read before, except those beyond `NEAR`.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y) {
        for number in 0..SONARS as u8 {
            let sonar = SonarId::new(number);
            let Some(ping) = y.pings(sonar).newest_first().next() else { continue };
            // A ping may arrive some turns late, so the time of the turn does not tell which pings are new.
            let is_new =
                self.read.get_mut(sonar.number()).is_some_and(|read| core::mem::replace(read, ping.at) != ping.at);
            if let Some(range) = ping.range.filter(|range| is_new && range.0 < NEAR) {
                let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
                let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
                self.keep(Echo { x: place.x.0 as f32, y: place.y.0 as f32, at: Millis::of(ping.at) });
            }
        }
    }

    /// Stores an echo. If a stored position is within 10 cm of it, only the time of that position is updated. Otherwise
    /// the echo takes a free entry, or replaces the oldest one.
    fn keep(&mut self, heard: Echo) {
        let same = |place: &Echo| {
            let (x, y) = (place.x - heard.x, place.y - heard.y);
            // Most places differ enough along one axis alone.
            x.abs() < ONE_PLACE && y.abs() < ONE_PLACE && libm::hypotf(x, y) < ONE_PLACE
        };
        if let Some(place) = self.echoes.iter_mut().take(self.count).find(|place| same(place)) {
            if heard.at.since(place.at) > 0 {
                place.at = heard.at;
            }
        } else if let Some(free) = self.echoes.get_mut(self.count) {
            *free = heard;
            self.count += 1;
        } else if let Some(oldest) = self.echoes.iter_mut().min_by_key(|place| -heard.at.since(place.at)) {
            *oldest = heard;
        }
    }

    /// Returns the positions that are not forgotten at the time `now`, relative to `here`, along the axes of the
    /// odometry coordinates.
    pub(crate) fn around(&self, here: Pose, now: Nanos) -> impl Iterator<Item = (f64, f64)> {
        let now = Millis::of(now);
        let kept = self.echoes.iter().take(self.count).filter(move |place| now.since(place.at) < KEPT);
        kept.map(move |place| (f64::from(place.x) - here.x.0, f64::from(place.y) - here.y.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    /// Returns the number of positions that are kept `later` milliseconds after the last of `pings`. The pings are
    /// straight ahead, one millisecond apart; each contains the robot's distance along the x axis, and the range.
    fn kept(pings: &[(f64, f64)], later: u64) -> usize {
        let (mut y, mut memory) = (Sensed::default(), Memory::EMPTY);
        for (x, range) in pings {
            y.now = Nanos(y.now.0 + MILLI);
            y.pose.x = Meters(*x);
            y.ping_at(SonarId::new(0), Some(*range), y.now);
            memory.take(&y);
        }
        memory.around(y.pose, Nanos(y.now.0 + MILLI * later)).count()
    }

    /// A millisecond.
    const MILLI: u64 = 1_000_000;

    #[test]
    fn one_place_is_kept_once_and_what_is_far_not_at_all() {
        assert_eq!(kept(&[(0.0, 1.0), (0.2, 0.8), (0.4, 0.61)], 0), 1);
        assert_eq!(kept(&[(0.0, 1.0), (0.4, 1.0)], 0), 2);
        assert_eq!(kept(&[(0.0, 1.5)], 0), 0);
    }

    #[test]
    fn what_was_heard_is_forgotten_in_time() {
        assert_eq!(kept(&[(0.0, 1.0)], 14_999), 1);
        assert_eq!(kept(&[(0.0, 1.0)], 15_000), 0);
    }

    #[test]
    fn the_oldest_place_makes_room() {
        let mut pings = [(0.0, 1.0); 200];
        for (number, ping) in (0..200_u32).zip(&mut pings) {
            ping.0 = f64::from(number);
        }
        assert_eq!(kept(&pings, 0), PLACES);
        assert_eq!(kept(&pings, 14_999), 1, "the newest is kept");
    }

    #[test]
    fn times_begin_again_after_49_days() {
        let before = Millis::of(Nanos(u64::from(u32::MAX) * MILLI));
        let after = Millis::of(Nanos((u64::from(u32::MAX) + 3) * MILLI));
        assert_eq!((after.since(before), before.since(after)), (3, 0));
    }
}
