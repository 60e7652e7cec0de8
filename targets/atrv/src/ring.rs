//! Converts the reports of the sonar boards to pings in the sixteen directions. See docs/src/reference/protocols.md,
//! 2.6.

use mdle_runtime::{Meters, Mount, Nanos, PINGS_KEPT, Ping, Pings, Pose, SONARS};

use crate::config::Config;
use crate::layout::{MOST, Transducer, transducers};

/// Time without a ping after which a direction is treated as defective. A sweep of all sonars takes a fifth of this
/// time.
const DEAF: Nanos = Nanos(1_000_000_000);

/// State of the sonars, and their pings.
///
/// A direction gets a new ping when all its sonars have reported since its last ping. It also gets one when a sonar
/// reports for the second time before another sonar has reported, because a report may have been lost.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    transducers: [Option<Transducer>; MOST],
    /// Last range of each sonar, measured from the ring, in metres; `None` if there was no echo.
    ranges: [Option<f64>; MOST],
    pub(crate) pings: [Pings; SONARS],
    /// Sonars that have reported since the last ping of each direction: bit `i` for sonar `i`.
    reported: [u32; SONARS],
    counts_per_metre: f64,
    reach: f64,
}

impl Ring {
    /// Creates the state before the first report.
    pub(crate) fn new(config: &Config) -> Self {
        Self {
            transducers: transducers(config.sonars),
            ranges: [None; MOST],
            pings: [Pings::default(); SONARS],
            reported: [0; SONARS],
            counts_per_metre: config.counts_per_metre,
            reach: config.reach,
        }
    }

    /// Stores the echo of the sonar with this id; `pose` is the pose by odometry. Ignores ids of unused channels.
    pub(crate) fn take(&mut self, id: u8, counts: u16, at: Nanos, pose: Pose) {
        let found = self.transducers.iter().zip(0..).find(|(sonar, _)| sonar.is_some_and(|sonar| sonar.id == id));
        let Some((Some(sonar), number)) = found else { return };
        let sonar = *sonar;
        let range = f64::from(counts) / self.counts_per_metre;
        // An unused channel reports 0; a sonar without an echo reports a value beyond its range.
        let range = (counts > 0 && range < self.reach).then(|| sonar.on_the_ring(range));
        for direction in (0..SONARS).filter(|direction| sonar.directions & (1 << direction) != 0) {
            if self.reported(direction) & (1 << number) != 0 {
                self.ping(direction, at, pose);
            }
            if let Some(reported) = self.reported.get_mut(direction) {
                *reported |= 1 << number;
            }
        }
        if let Some(heard) = self.ranges.get_mut(number as usize) {
            *heard = range;
        }
        for direction in (0..SONARS).filter(|direction| sonar.directions & (1 << direction) != 0) {
            if self.reported(direction) == self.members(direction) {
                self.ping(direction, at, pose);
            }
        }
    }

    /// Returns the lowest direction that has fewer pings than an output keeps; `None` if there is no such direction.
    pub(crate) fn unheard(&self) -> Option<u8> {
        let all = (0..).zip(&self.pings);
        all.filter(|(_, pings)| pings.newest_first().count() < PINGS_KEPT).map(|(direction, _)| direction).next()
    }

    /// Returns the lowest direction whose last ping is missing or too old; `None` if there is no such direction.
    pub(crate) fn deaf(&self, now: Nanos) -> Option<u8> {
        let all = (0..).zip(&self.pings);
        let is_old = |pings: &Pings| pings.newest_first().next().is_none_or(|ping| now.since(ping.at) > DEAF);
        all.filter(|(_, pings)| is_old(pings)).map(|(direction, _)| direction).next()
    }

    fn reported(&self, direction: usize) -> u32 {
        self.reported.get(direction).copied().unwrap_or(0)
    }

    /// Returns the sonars that are used for this direction: bit `i` for sonar `i`.
    fn members(&self, direction: usize) -> u32 {
        let all = (0..).zip(&self.transducers);
        let speaks = |sonar: &Option<Transducer>| sonar.is_some_and(|sonar| sonar.directions & (1 << direction) != 0);
        all.filter(|(_, sonar)| speaks(sonar)).fold(0, |bits, (number, _): (u32, _)| bits | 1 << number)
    }

    /// Stores a ping of this direction. The range is the smallest range of the direction's sonars.
    fn ping(&mut self, direction: usize, at: Nanos, pose: Pose) {
        let (Some(reported), Some(pings)) = (self.reported.get_mut(direction), self.pings.get_mut(direction)) else {
            return;
        };
        let all = (0_u32..).zip(self.transducers.iter().zip(&self.ranges));
        let heard = all.filter(|(number, _)| *reported & (1 << number) != 0);
        let heard = heard.filter_map(|(_, (transducer, range))| Some(((*transducer)?, (*range)?)));
        let nearest = heard.reduce(|one, other| if other.1 < one.1 { other } else { one });
        let mount = nearest.map_or(Mount::default(), |(transducer, _)| transducer.mount(direction));
        pings.push(Ping { range: nearest.map(|(_, range)| Meters(range)), at, pose, mount });
        *reported = 0;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use crate::config::Configured;

    fn ring(sonars: u8) -> Ring {
        Ring::new(&Config { sonars, ..Configured::read(None, None).unwrap().config })
    }

    /// Returns the pings of a direction, newest first: the time, and the range in millimetres.
    fn heard(ring: &Ring, direction: usize) -> Vec<(u64, Option<i32>)> {
        let millimetres = |range: Meters| libm::round(range.0 * 1000.0) as i32;
        ring.pings[direction].newest_first().map(|ping| (ping.at.0, ping.range.map(millimetres))).collect()
    }

    #[test]
    fn a_direction_pings_when_all_of_its_sonars_have_reported() {
        let mut ring = ring(24);
        let mut take = |id, counts, at| ring.take(id, counts, Nanos(at), Pose::ORIGIN);
        // One sonar serves direction 1, two sonars (at 36° and 54°) serve direction 2, and sonar 9 does not exist.
        take(1, 1550, 1);
        take(2, 1550, 1);
        take(9, 1550, 1);
        take(3, 775, 2);
        assert_eq!(heard(&ring, 1), [(1, Some(1007))]);
        assert_eq!(heard(&ring, 2), [(2, Some(515))]);
        assert_eq!(heard(&ring, 3), []);
        // A report without an echo, and one from an unused channel.
        ring.take(1, 32_766, Nanos(3), Pose::ORIGIN);
        ring.take(1, 0, Nanos(4), Pose::ORIGIN);
        assert_eq!(heard(&ring, 1), [(4, None), (3, None), (1, Some(1007))]);
    }

    #[test]
    fn a_report_that_is_lost_delays_a_ping_and_no_more() {
        let mut ring = ring(24);
        for at in 1..5 {
            ring.take(2, 1550, Nanos(at), Pose::ORIGIN);
        }
        assert_eq!(heard(&ring, 2).iter().map(|(at, _)| *at).collect::<Vec<_>>(), [4, 3, 2]);
        // The other sonar reports again.
        ring.take(3, 1550, Nanos(5), Pose::ORIGIN);
        assert_eq!(heard(&ring, 2)[0].0, 5);
    }

    #[test]
    fn a_sonar_may_speak_for_several_directions() {
        let mut ring = ring(16);
        ring.take(7, 1550, Nanos(1), Pose::ORIGIN);
        assert_eq!([5, 6].map(|direction| heard(&ring, direction)), [[(1, Some(950))], [(1, Some(950))]]);
        assert_eq!(heard(&ring, 4), []);
        ring.take(5, 1240, Nanos(2), Pose::ORIGIN);
        assert_eq!([3, 4].map(|direction| heard(&ring, direction)), [[(2, Some(756))], [(2, Some(756))]]);
    }

    #[test]
    fn what_was_never_heard_or_not_for_long_is_known() {
        for (sonars, ids) in [(24, 0..54), (16, 0..24)] {
            let mut ring = ring(sonars);
            assert_eq!((ring.unheard(), ring.deaf(Nanos::ZERO)), (Some(0), Some(0)));
            for at in 0..3 {
                for id in ids.clone().filter(|id| *id != 1) {
                    ring.take(id, 1550, Nanos(at), Pose::ORIGIN);
                }
            }
            assert_eq!((ring.unheard(), ring.deaf(Nanos(3))), (Some(1), Some(1)));
            for at in 3..6 {
                ring.take(1, 1550, Nanos(at), Pose::ORIGIN);
            }
            assert_eq!((ring.unheard(), ring.deaf(Nanos(DEAF.0 + 2))), (None, None));
            assert_eq!(ring.deaf(Nanos(DEAF.0 + 3)), Some(0));
        }
    }
}
