//! Measures the lag of frames from a source. On a slow line, each frame arrives soon after the previous one, but later
//! and later after it was sent.

use mdle_runtime::Nanos;

/// Reciprocal of the maximum drift between the clocks of two robots; the drift is 1/5000 of a second per second.
const DRIFT: i128 = 5000;

/// Minimum transmission time of frames from a source, measured with two clocks that are not synchronized.
#[derive(Debug, Default)]
pub(super) struct Lag {
    /// Minimum transmission time plus the offset between the clocks, in nanoseconds, and the arrival time of the last
    /// frame; `None` before the first frame.
    least: Option<(i128, Nanos)>,
}

impl Lag {
    /// Returns the transmission time of a frame minus the minimum transmission time of its source. `sent` is the
    /// sending time on the sender's clock, and `arrival` the arrival time on this robot's clock.
    pub(super) fn of(&mut self, sent: Nanos, arrival: Nanos) -> Nanos {
        let way = i128::from(arrival.0) - i128::from(sent.0);
        let least = self.least.map_or(way, |(least, before)| {
            // If the sender's clock is slower, the difference grows although no frame is late.
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

    /// Returns the lag of each frame, in milliseconds. `frames` contains the sending time and the arrival time of each
    /// frame, also in milliseconds.
    fn lags(frames: impl IntoIterator<Item = (u64, u64)>) -> Vec<u64> {
        let mut lag = Lag::default();
        let of = |(sent, arrival)| lag.of(Nanos(sent * MILLISECOND), Nanos(arrival * MILLISECOND)).0 / MILLISECOND;
        frames.into_iter().map(of).collect()
    }

    #[test]
    fn a_frame_lags_behind_the_fastest() {
        assert_eq!(lags([(900, 50), (1000, 160), (1100, 240), (1200, 350)]), [0, 9, 0, 9]);
        // The line has half of the required data rate.
        assert_eq!(lags((0..4).map(|number| (100 * number, 5000 + 200 * number))), [0, 99, 199, 299]);
        assert_eq!(lags([(0, 0), (u64::MAX / MILLISECOND, 1), (0, 2)])[1..], [0, u64::MAX / MILLISECOND]);
    }

    #[test]
    fn clocks_may_drift_apart() {
        // The sender's clock loses or gains a second in three hours.
        for hour in [3_599_667, 3_600_333] {
            let drifting = (0..3600).map(|second| (10 * second * hour / 3600, 10_000 * second));
            assert!(lags(drifting).iter().all(|lag| *lag <= 1), "{hour} ms an hour");
        }
    }
}
