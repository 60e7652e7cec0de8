//! Stores the positions of the echoes of the last seconds. On a detour out of a corner, the sonars do not receive
//! echoes from all of the corner at once.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

/// Maximum number of stored positions.
pub(crate) const PLACES: usize = 64;
/// Distance, in millimetres, below which echoes count as one place.
const ONE_PLACE: u32 = 100;
/// Time, in eighths of a second, after which a place is forgotten, so that an object that has left does not remain.
const KEPT: u8 = 15 * 8;
/// An eighth of a second, in nanoseconds.
const EIGHTH: u64 = 125_000_000;
/// Difference of two times, in eighths of a second, from which the first is treated as the earlier one.
const LATER: u8 = u8::MAX - 7;
/// Range, in metres, beyond which echoes are not kept.
const NEAR: f64 = 1.2;

/// The position of an echo, in odometry coordinates, with the time of the last echo there. It has the size of its five
/// bytes, because there are many.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Echo {
    x: Millimetres,
    y: Millimetres,
    at: Eighths,
}

/// A coordinate in whole millimetres, far below the resolution of a sonar. It begins again at 0 after 65 m, which is
/// further than a robot drives while a place is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Millimetres([u8; 2]);

impl Millimetres {
    fn of(metres: f64) -> Self {
        // The upper bits are dropped.
        Self((whole(metres) as u16).to_le_bytes())
    }

    /// Returns the number of millimetres from the coordinate `from` to this one, which is less than 32 m away.
    fn ahead_of(self, from: i32) -> i32 {
        i32::from(u16::from_le_bytes(self.0).wrapping_sub(from as u16) as i16)
    }

    /// Returns the coordinate, in metres, relative to `origin`, which is less than 32 m away.
    fn relative_to(self, origin: f64) -> f64 {
        let near = whole(origin);
        f64::from(near.saturating_add(self.ahead_of(near))) / 1000.0 - origin
    }
}

/// Returns the whole number of millimetres that is nearest to a length in metres.
fn whole(metres: f64) -> i32 {
    libm::round(1000.0 * metres) as i32
}

/// A time in eighths of a second, which begins again at 0 after 32 s. Places are forgotten long before.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Eighths(u8);

impl Eighths {
    fn of(time: Nanos) -> Self {
        // The upper bits are dropped.
        Self((time.0 / EIGHTH) as u8)
    }

    /// Returns the time since `earlier`; 0 if `earlier` is later by at most a second.
    fn since(self, earlier: Self) -> u8 {
        match self.0.wrapping_sub(earlier.0) {
            0..LATER => self.0.wrapping_sub(earlier.0),
            LATER.. => 0,
        }
    }
}

/// Returns `true` if a place is forgotten at the time `now` whose last echo was at the time `at`.
fn is_forgotten(at: Nanos, now: Nanos) -> bool {
    now.since(at).0 >= u64::from(KEPT) * EIGHTH
}

/// Stores positions of echoes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    echoes: [Echo; PLACES],
    /// Number of stored positions, from the first entry on.
    count: u8,
    /// For each sonar, the lower bits of the time of its last ping that was read, in milliseconds. A ping at another
    /// time is a new one.
    read: [u16; SONARS],
    /// Time of the last turn.
    turn: Nanos,
}

impl Memory {
    pub(crate) const EMPTY: Self = Self {
        echoes: [Echo { x: Millimetres([0; 2]), y: Millimetres([0; 2]), at: Eighths(0) }; PLACES],
        count: 0,
        read: [u16::MAX; SONARS],
        turn: Nanos::ZERO,
    };

    /// Stores the positions of the sonars' newest echoes that have not been read before, except those beyond `NEAR`.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y) {
        self.forget(y.now());
        for number in 0..SONARS as u8 {
            let sonar = SonarId::new(number);
            let Some(ping) = y.pings(sonar).newest_first().next() else { continue };
            let at = (ping.at.0 / 1_000_000) as u16;
            // A ping may arrive some turns late, so the time of the turn does not tell which pings are new.
            let is_new = self.read.get_mut(sonar.number()).is_some_and(|read| core::mem::replace(read, at) != at);
            let is_kept = is_new && !is_forgotten(ping.at, y.now());
            if let Some(range) = ping.range.filter(|range| is_kept && range.0 < NEAR) {
                let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
                let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
                self.keep(Echo {
                    x: Millimetres::of(place.x.0),
                    y: Millimetres::of(place.y.0),
                    at: Eighths::of(ping.at),
                });
            }
        }
    }

    /// Removes the positions that are forgotten at the time `now`, before their times begin again.
    fn forget(&mut self, now: Nanos) {
        let is_long = is_forgotten(self.turn, now);
        self.turn = now;
        let mut kept = 0;
        for number in 0..self.count.into() {
            let Some(place) = self.echoes.get(number).copied() else { break };
            if !is_long
                && Eighths::of(now).since(place.at) < KEPT
                && let Some(free) = self.echoes.get_mut(usize::from(kept))
            {
                *free = place;
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Stores an echo. If a stored position is within 10 cm of it, only the time of that position is updated. Otherwise
    /// the echo takes a free entry, or replaces the oldest one.
    fn keep(&mut self, heard: Echo) {
        let [x, y] = [heard.x, heard.y].map(|at| u16::from_le_bytes(at.0).into());
        let same = |place: &Echo| {
            let [x, y] = [place.x.ahead_of(x), place.y.ahead_of(y)].map(i32::unsigned_abs);
            x * x + y * y < ONE_PLACE * ONE_PLACE
        };
        if let Some(place) = self.echoes.iter_mut().take(self.count.into()).find(|place| same(place)) {
            if heard.at.since(place.at) > 0 {
                place.at = heard.at;
            }
        } else if let Some(free) = self.echoes.get_mut(usize::from(self.count)) {
            *free = heard;
            self.count += 1;
        } else if let Some(oldest) = self.echoes.iter_mut().max_by_key(|place| heard.at.since(place.at)) {
            *oldest = heard;
        }
    }

    /// Returns the positions that are not forgotten at the time `now`, relative to `here`, along the axes of the
    /// odometry coordinates.
    pub(crate) fn around(&self, here: Pose, now: Nanos) -> impl Iterator<Item = (f64, f64)> {
        let now = Eighths::of(now);
        let kept = self.echoes.iter().take(self.count.into()).filter(move |place| now.since(place.at) < KEPT);
        kept.map(move |place| (place.x.relative_to(here.x.0), place.y.relative_to(here.y.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    /// Returns the number of positions that are kept `later` milliseconds after the last of `pings`. The pings are
    /// straight ahead, an eighth of a second apart; each contains the robot's distance along the x axis, and the range.
    fn kept(pings: &[(f64, f64)], later: u64) -> usize {
        let (mut y, mut memory) = (Sensed::default(), Memory::EMPTY);
        for (x, range) in pings {
            y.now = Nanos(y.now.0 + EIGHTH);
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
    fn a_place_takes_five_bytes() {
        assert_eq!(size_of::<Echo>(), 5);
    }

    #[test]
    fn times_begin_again_after_32_seconds() {
        let before = Eighths::of(Nanos(255 * EIGHTH));
        let after = Eighths::of(Nanos(258 * EIGHTH));
        assert_eq!((after.since(before), before.since(after)), (3, 0));
        assert_eq!((before.since(Eighths(8)), before.since(Eighths(7))), (247, 0));
    }

    #[test]
    fn a_place_is_forgotten_before_its_time_begins_again() {
        let (mut y, mut memory) = (Sensed::default(), Memory::EMPTY);
        y.ping_at(SonarId::new(0), Some(1.0), y.now);
        y.now = Nanos(32_000 * MILLI);
        memory.take(&y);
        assert_eq!(memory.around(y.pose, y.now).count(), 0, "the sonar is silent since long ago");
        for pauses in [&[14_000, 14_000, 4_000][..], &[32_000]] {
            let (mut y, mut memory) = (Sensed::default(), Memory::EMPTY);
            y.ping_at(SonarId::new(0), Some(1.0), y.now);
            memory.take(&y);
            assert_eq!(memory.around(y.pose, y.now).count(), 1);
            for pause in pauses {
                y.now = Nanos(y.now.0 + MILLI * pause);
                memory.take(&y);
            }
            assert_eq!(memory.around(y.pose, y.now).count(), 0, "after {pauses:?} ms");
        }
    }

    #[test]
    fn places_are_exact_to_half_a_millimetre_far_from_the_origin() {
        for origin in [0.0, -16.384, 32.7675, 65.536, -98_765.432] {
            for ahead in [-30.0, -0.0004, 1.2344, 30.0] {
                let at = Millimetres::of(origin + ahead).relative_to(origin);
                assert!((at - ahead).abs() < 0.000_501, "{at} instead of {ahead} from {origin}");
            }
        }
    }
}
