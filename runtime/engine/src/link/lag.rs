//! Lag of the frames of a source: frames on a slow line arrive ever later, though each arrives soon after the one
//! before.

use mdle_runtime::Nanos;

/// The clocks of two robots drift apart by at most this part of a second in each second: its reciprocal.
const DRIFT: i128 = 5000;

/// The least time that a frame of a source was on its way, by two clocks that do not agree.
#[derive(Debug, Default)]
pub(super) struct Lag {
    /// Difference of the clocks with that time, and the time of the last arrival.
    least: Option<(i128, Nanos)>,
}

impl Lag {
    /// Returns the time that a frame was on its way, beyond the least such time. The frame was sent at `sent` by the
    /// clock of its sender, and has arrived at `arrival` by the clock of this robot.
    pub(super) fn of(&mut self, sent: Nanos, arrival: Nanos) -> Nanos {
        let way = i128::from(arrival.0) - i128::from(sent.0);
        let least = self.least.map_or(way, |(least, before)| {
            // Where the sender's clock is the slower one, the difference grows though no frame is late.
            let drift = i128::from(arrival.0.saturating_sub(before.0)) / DRIFT;
            way.min(least + drift)
        });
        self.least = Some((least, arrival));
        Nanos(u64::try_from(way - least).unwrap_or(u64::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLISECOND: u64 = 1_000_000;

    /// Returns the lags in milliseconds of frames that are sent and arrive at these times in milliseconds.
    fn lags(frames: impl IntoIterator<Item = (u64, u64)>) -> Vec<u64> {
        let mut lag = Lag::default();
        let of = |(sent, arrival)| lag.of(Nanos(sent * MILLISECOND), Nanos(arrival * MILLISECOND)).0 / MILLISECOND;
        frames.into_iter().map(of).collect()
    }

    #[test]
    fn a_frame_lags_behind_the_fastest() {
        assert_eq!(lags([(900, 50), (1000, 160), (1100, 240), (1200, 350)]), [0, 9, 0, 9]);
        // A line with half the rate that is needed.
        assert_eq!(lags((0..4).map(|number| (100 * number, 5000 + 200 * number))), [0, 99, 199, 299]);
        assert_eq!(lags([(0, 0), (u64::MAX / MILLISECOND, 1), (0, 2)])[1..], [0, u64::MAX / MILLISECOND]);
    }

    #[test]
    fn clocks_may_drift_apart() {
        // The sender's clock loses a second in three hours, and gains one.
        for hour in [3_599_667, 3_600_333] {
            let drifting = (0..3600).map(|second| (10 * second * hour / 3600, 10_000 * second));
            assert!(lags(drifting).iter().all(|lag| *lag <= 1), "{hour} ms an hour");
        }
    }
}
