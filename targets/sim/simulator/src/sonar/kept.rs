//! Stores the last pings of a robot's sonars in less memory than an output needs, because pings take most of the memory
//! of a large crowd.

use mdle_runtime::{Meters, Nanos, PINGS_KEPT, Ping, Pings, Pose, Radians, SONARS};

use crate::model::Hearing;

/// A value for each stored ping of each sonar, newest first.
type Kept<T> = [[T; PINGS_KEPT]; SONARS];

/// The last pings of all sonars.
#[derive(Debug, Clone)]
pub(super) struct KeptPings {
    poses: Kept<KeptPose>,
    /// Times of the newest pings, in ticks. A tick takes at least 100 µs, so the ticks of five days can be
    /// counted.
    newest: [u32; SONARS],
    /// Ticks between each ping and the ping before it. A sonar that did not ping for longer counts as having pinged
    /// 65,535 ticks earlier.
    apart: [[u16; PINGS_KEPT - 1]; SONARS],
    ranges: KeptRanges,
    /// Numbers of the transducers that received the echoes; [`NONE`] without an echo.
    transducers: Kept<u8>,
    /// Number of pings of each sonar that are kept.
    counts: [u8; SONARS],
}

/// A pose by odometry. In single precision a place 1 km away is exact to 0.03 mm, far below the resolution of a sonar.
#[derive(Debug, Clone, Copy)]
struct KeptPose {
    x: f32,
    y: f32,
    theta: f32,
}

impl KeptPose {
    const ORIGIN: Self = Self { x: 0.0, y: 0.0, theta: 0.0 };

    fn of(Pose { x, y, theta }: Pose) -> Self {
        Self { x: x.0 as f32, y: y.0 as f32, theta: theta.0 as f32 }
    }

    fn pose(self) -> Pose {
        let Self { x, y, theta } = self;
        Pose { x: Meters(x.into()), y: Meters(y.into()), theta: Radians(theta.into()) }
    }
}

/// Ranges from the transducers; undefined without an echo.
#[derive(Debug, Clone)]
enum KeptRanges {
    /// Whole numbers of steps, for sonars that round ranges down to a step.
    Steps(Kept<u16>),
    /// Ranges in metres, for sonars that do not round. They are on the heap, so that they do not take memory on other
    /// robots.
    Exact(Box<Kept<f64>>),
}

/// Number that means that no transducer received an echo.
const NONE: u8 = u8::MAX;

/// Adds the newest value for a sonar, and removes the oldest.
fn push<T>(kept: &mut [T], newest: T) {
    kept.rotate_right(1);
    kept[0] = newest;
}

impl KeptPings {
    /// Returns a store without pings. `step` is the resolution of the ranges, in metres; 0 means exact ranges.
    pub(super) fn empty(step: f64) -> Self {
        Self {
            poses: [[KeptPose::ORIGIN; PINGS_KEPT]; SONARS],
            newest: [0; SONARS],
            apart: [[0; PINGS_KEPT - 1]; SONARS],
            ranges: if step > 0.0 { KeptRanges::Steps(Kept::default()) } else { KeptRanges::Exact(Box::default()) },
            transducers: [[NONE; PINGS_KEPT]; SONARS],
            counts: [0; SONARS],
        }
    }

    /// Adds a ping of a sonar, taken at the tick `at` with the pose `pose` by odometry, and removes the oldest. `echo`
    /// contains the range of the ping's echo from the transducer that received it, and the number of this transducer.
    /// `step` is the resolution of the ranges.
    pub(super) fn push(&mut self, sonar: usize, echo: Option<(f64, usize)>, at: u32, pose: Pose, step: f64) {
        let (range, transducer) = echo.map_or((0.0, NONE), |(range, number)| (range, number as u8));
        push(&mut self.poses[sonar], KeptPose::of(pose));
        let before = std::mem::replace(&mut self.newest[sonar], at);
        push(&mut self.apart[sonar], u16::try_from(at.saturating_sub(before)).unwrap_or(u16::MAX));
        match &mut self.ranges {
            KeptRanges::Steps(steps) => push(&mut steps[sonar], libm::round(range / step) as u16),
            KeptRanges::Exact(ranges) => push(&mut ranges[sonar], range),
        }
        push(&mut self.transducers[sonar], transducer);
        self.counts[sonar] = (self.counts[sonar] + 1).min(PINGS_KEPT as u8);
    }

    /// Returns the pings of all sonars, as an output has them. `tick` is the duration of a tick.
    pub(super) fn pings(&self, hearing: &Hearing, tick: Nanos) -> [Pings; SONARS] {
        std::array::from_fn(|sonar| {
            let mut pings = Pings::default();
            for place in (0..usize::from(self.counts[sonar])).rev() {
                let number = usize::from(self.transducers[sonar][place]);
                // No transducer has the number `NONE`.
                let heard_by = hearing.transducers.get(number);
                let range = heard_by.map(|_| Meters(hearing.of_ring(self.range(sonar, place, hearing.step), number)));
                let at = Nanos(u64::from(self.ticks(sonar, place)).saturating_mul(tick.0));
                let mount = heard_by.and_then(|transducer| transducer.mount).unwrap_or_default();
                pings.push(Ping { range, at, pose: self.poses[sonar][place].pose(), mount });
            }
            pings
        })
    }

    /// Returns the time of a ping, in ticks.
    fn ticks(&self, sonar: usize, place: usize) -> u32 {
        let later: u32 = self.apart[sonar].iter().take(place).map(|apart| u32::from(*apart)).sum();
        self.newest[sonar].saturating_sub(later)
    }

    fn range(&self, sonar: usize, place: usize, step: f64) -> f64 {
        match &self.ranges {
            // The measurement has multiplied the step by the same whole number, so the product is equal to the bit.
            KeptRanges::Steps(steps) => f64::from(steps[sonar][place]) * step,
            KeptRanges::Exact(ranges) => ranges[sonar][place],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Body, Model};

    /// Asserts that the sonars of this body keep exactly the pings that were pushed; the range of each ping is a whole
    /// number of steps.
    fn assert_kept(body: Body, tick: Nanos) {
        let hearing = Model::of(body, &[]).hearing;
        let mut kept = KeptPings::empty(hearing.step);
        let mut pushed = [Pings::default(); SONARS];
        for number in 0..100_u32 {
            let transducer = number as usize % hearing.transducers.len();
            let sonar = hearing.transducers[transducer].sonar.number();
            let unit = if hearing.step > 0.0 { hearing.step } else { 0.01 / 3.0 };
            let echo = (number % 3 > 0).then(|| (f64::from(2 * number + 9) * unit, transducer));
            // A robot far from its origin, at a place that single precision can represent.
            let pose = Pose { x: Meters(1000.0 + f64::from(number) / 4.0), theta: Radians(0.125), ..Pose::ORIGIN };
            kept.push(sonar, echo, number / 16, pose, hearing.step);
            let mount = echo.and_then(|(_, number)| hearing.transducers[number].mount).unwrap_or_default();
            let range = echo.map(|(range, number)| Meters(hearing.of_ring(range, number)));
            pushed[sonar].push(Ping { range, at: Nanos(u64::from(number / 16) * tick.0), pose, mount });
        }
        assert_eq!(kept.pings(&hearing, tick), pushed, "{body}");
    }

    #[test]
    fn a_long_pause_does_not_change_the_newest_time() {
        let hearing = Model::of(Body::Scout, &[]).hearing;
        let mut kept = KeptPings::empty(hearing.step);
        for at in [7, 100_000] {
            kept.push(0, None, at, Pose::ORIGIN, hearing.step);
        }
        let times: Vec<_> = kept.pings(&hearing, Nanos(10))[0].newest_first().map(|ping| ping.at.0).collect();
        assert_eq!(times, [1_000_000, 10 * (100_000 - 65_535)]);
    }

    #[test]
    fn the_pings_of_a_robot_take_less_than_a_kilobyte() {
        assert!(size_of::<KeptPings>() < 1000, "{} bytes", size_of::<KeptPings>());
    }

    #[test]
    fn ranges_and_times_are_kept_to_the_bit() {
        for body in [Body::Ideal, Body::Scout, Body::Atrv] {
            assert_kept(body, Nanos(33_333_333));
        }
    }
}
