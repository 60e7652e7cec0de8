//! Stores the last pings of a robot's sonars in less memory than an output needs, because pings take most of the memory
//! of a large crowd.

use mdle_runtime::{Meters, Nanos, PINGS_KEPT, Ping, Pings, Pose, SONARS};

use crate::model::Hearing;

/// The last pings of all sonars, newest first.
#[derive(Debug, Clone)]
pub(super) struct KeptPings {
    pings: [[KeptPing; PINGS_KEPT]; SONARS],
    /// Numbers of the transducers that received the echoes; [`NONE`] without an echo.
    transducers: [[u8; PINGS_KEPT]; SONARS],
    /// Number of pings of each sonar that are kept.
    counts: [u8; SONARS],
}

/// A ping without its transducer.
#[derive(Debug, Clone, Copy)]
struct KeptPing {
    /// Range from the transducer; undefined without an echo.
    range: Meters,
    at: Nanos,
    pose: Pose,
}

/// Number that means that no transducer received an echo.
const NONE: u8 = u8::MAX;

impl KeptPings {
    pub(super) const EMPTY: Self = Self {
        pings: [[KeptPing { range: Meters(0.0), at: Nanos::ZERO, pose: Pose::ORIGIN }; PINGS_KEPT]; SONARS],
        transducers: [[NONE; PINGS_KEPT]; SONARS],
        counts: [0; SONARS],
    };

    /// Adds a ping of a sonar, taken at `at` with the pose `pose` by odometry, and removes the oldest. `echo` contains
    /// the range of the ping's echo, and the number of the transducer that received the echo.
    pub(super) fn push(&mut self, sonar: usize, echo: Option<(f64, usize)>, at: Nanos, pose: Pose) {
        let Self { pings, transducers, counts } = self;
        let (range, transducer) = echo.map_or((0.0, NONE), |(range, number)| (range, number as u8));
        pings[sonar].rotate_right(1);
        pings[sonar][0] = KeptPing { range: Meters(range), at, pose };
        transducers[sonar].rotate_right(1);
        transducers[sonar][0] = transducer;
        counts[sonar] = (counts[sonar] + 1).min(PINGS_KEPT as u8);
    }

    /// Returns the pings of all sonars, as an output has them.
    pub(super) fn pings(&self, hearing: &Hearing) -> [Pings; SONARS] {
        std::array::from_fn(|sonar| {
            let mut pings = Pings::default();
            let count = usize::from(self.counts[sonar]);
            let kept = self.pings[sonar].iter().zip(self.transducers[sonar]).take(count);
            for (KeptPing { range, at, pose }, transducer) in kept.rev() {
                let heard_by = (transducer != NONE).then(|| &hearing.transducers[usize::from(transducer)]);
                let mount = heard_by.and_then(|transducer| transducer.mount).unwrap_or_default();
                pings.push(Ping { range: heard_by.map(|_| *range), at: *at, pose: *pose, mount });
            }
            pings
        })
    }
}
