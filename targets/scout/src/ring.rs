//! Converts the ranges of the sixteen sonars to pings. Determines which pings are new, and how old the others are. See
//! docs/src/reference/protocols.md, 1.6.

use mdle_runtime::{Meters, Mount, Nanos, Ping, Pings, Pose, SONARS};

/// Metres in an inch.
const INCH: f64 = 0.0254;
/// Tolerance for a late round of pings, as a number of gaps. It is better to miss a ping than to report a ping that did
/// not happen.
const SLACK: usize = 2;
/// Range that a sonar without an echo reports.
const NOTHING: u8 = 255;

/// Pings of the ring of sonars.
///
/// The robot does not report when a sonar pinged. If the range of a sonar has changed, the sonar has pinged since the
/// last state. If the range stays the same, the sonar is assumed to ping once per round of the ring plus a tolerance.
#[derive(Debug, Clone)]
pub(crate) struct Ring {
    pings: [Pings; SONARS],
    last: [Option<(u8, Nanos)>; SONARS],
    /// `true` for each sonar that pings.
    active: [bool; SONARS],
    /// Duration of one round, in which each active sonar pings once.
    around: Nanos,
    /// Time after which an unchanged range is treated as a new ping.
    again: Nanos,
    /// Interval between two pings.
    gap: Nanos,
}

impl Ring {
    /// Creates a ring of the sonars in `order`, which ping one after another at the interval `gap`.
    pub(crate) fn new(order: &[u8], gap: Nanos) -> Self {
        let (pings, last, active) = ([Pings::default(); SONARS], [None; SONARS], [false; SONARS]);
        let mut ring = Self { pings, last, active, around: Nanos::ZERO, again: Nanos::ZERO, gap };
        ring.reorder(order);
        ring
    }

    /// Sets the sonars that ping from now on, one after another. Earlier pings are kept.
    pub(crate) fn reorder(&mut self, order: &[u8]) {
        self.active = std::array::from_fn(|sonar| order.iter().any(|number| usize::from(*number) == sonar));
        let times = |count: usize| Nanos(self.gap.0.saturating_mul(count as u64));
        (self.around, self.again) = (times(order.len()), times(order.len() + SLACK));
    }

    /// Returns the duration of one round, in which each sonar pings once.
    pub(crate) fn around(&self) -> Nanos {
        self.around
    }

    /// Stores the sonar ranges that were received at the time `at`; `pose` is the pose by odometry. Returns the pings
    /// of each sonar.
    pub(crate) fn take_in(&mut self, sonars: &[u8; SONARS], at: Nanos, pose: Pose) -> [Pings; SONARS] {
        let all = self.pings.iter_mut().zip(&mut self.last).zip(sonars).zip(&self.active);
        for (((pings, last), heard), _) in all.filter(|(_, active)| **active) {
            let is_old = last.is_some_and(|(byte, since)| byte == *heard && at.since(since) < self.again);
            if !is_old {
                let range = (*heard != NOTHING).then(|| Meters(f64::from(*heard) * INCH));
                pings.push(Ping { range, at, pose, mount: Mount::default() });
                *last = Some((*heard, at));
            }
        }
        self.pings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: Nanos = Nanos(60_000_000);

    #[test]
    fn a_number_that_changes_is_a_new_ping_and_one_that_stays_is_one_a_round() {
        let mut ring = Ring::new(&[0, 2, 1], GAP);
        let mut heard = |byte, at: u64| {
            let mut sonars = [NOTHING; SONARS];
            sonars[2] = byte;
            let pings = ring.take_in(&sonars, Nanos(at * 1_000_000), Pose::ORIGIN)[2];
            pings
                .newest_first()
                .map(|ping| (ping.range.map(|range| range.0), ping.at.0 / 1_000_000))
                .collect::<Vec<_>>()
        };
        let (one, two) = (Some(100.0 * INCH), Some(101.0 * INCH));
        assert_eq!(heard(100, 0), [(one, 0)]);
        assert_eq!(heard(100, 100), [(one, 0)]);
        assert_eq!(heard(101, 150), [(two, 150), (one, 0)]);
        assert_eq!(heard(101, 449), [(two, 150), (one, 0)]);
        assert_eq!(heard(101, 450), [(two, 450), (two, 150), (one, 0)]);
        assert_eq!(heard(NOTHING, 451), [(None, 451), (two, 450), (two, 150)]);
    }

    #[test]
    fn a_new_order_keeps_the_pings_so_far() {
        let mut ring = Ring::new(&[2, 3], GAP);
        ring.take_in(&[7; SONARS], Nanos::ZERO, Pose::ORIGIN);
        ring.reorder(&[3]);
        assert_eq!(ring.around(), GAP);
        let pings = ring.take_in(&[9; SONARS], Nanos(1), Pose::ORIGIN);
        let counts = [2, 3, 4].map(|sonar: usize| pings[sonar].newest_first().count());
        assert_eq!(counts, [1, 2, 0]);
    }

    #[test]
    fn a_sonar_that_does_not_ping_says_nothing() {
        let mut ring = Ring::new(&[3], GAP);
        let pings = ring.take_in(&[7; SONARS], Nanos::ZERO, Pose::ORIGIN);
        assert_eq!(pings.map(|pings| pings.newest_first().count()).iter().sum::<usize>(), 1);
        assert_eq!(pings[3].nearest(1), Some(Meters(7.0 * INCH)));
    }
}
