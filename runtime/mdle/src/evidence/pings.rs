//! Collects the pings of a run from the robot's outputs. Each ping is taken once, in the order in which the sonars
//! fired.

use mdle_runtime::{Nanos, Pings, Pose, SONARS, Sensed, SonarId};

use super::grid::GridPing;

/// Converts outputs to pings in grid coordinates; each ping is returned once.
#[derive(Debug)]
pub(crate) struct PingOrder {
    /// Pose, in grid coordinates, at which the robot's odometry was zero.
    origin: Pose,
    /// Time of the last ping that was taken from each sonar.
    last: [Option<Nanos>; SONARS],
}

impl PingOrder {
    /// Creates the state before the first ping of a run. `origin` is the pose, in grid coordinates, at which the
    /// robot's odometry is zero.
    pub(crate) fn new(origin: Pose) -> Self {
        Self { origin, last: [None; SONARS] }
    }

    /// Returns the pings in `y` that no earlier output contained.
    pub(crate) fn take(&mut self, y: &Sensed) -> Vec<GridPing> {
        let radius = y.shape.ring_radius;
        let mut new = Vec::new();
        for ((number, pings), last) in (0..).zip(&y.pings).zip(&mut self.last) {
            let (sonar, before) = (SonarId::new(number), *last);
            for ping in fresh(pings, before) {
                let axis = ping.axis(sonar);
                new.push((ping.at, number, axis.towards(axis.theta, radius), ping.range));
                *last = (*last).max(Some(ping.at));
            }
        }
        new.sort_by_key(|(at, number, ..)| (*at, *number));
        new.into_iter().map(|(.., from, range)| self.placed(&from, range.map(|range| range.0))).collect()
    }

    /// Converts a ping to grid coordinates; `from` is the pose of the transducer in odometry coordinates.
    fn placed(&self, from: &Pose, range: Option<f64>) -> GridPing {
        let (sin, cos) = libm::sincos(self.origin.theta.0);
        let (x, y) = (from.x.0, from.y.0);
        GridPing {
            x: self.origin.x.0 + x * cos - y * sin,
            y: self.origin.y.0 + x * sin + y * cos,
            theta: self.origin.theta.0 + from.theta.0,
            range,
        }
    }
}

/// Returns the pings that were taken after the time `before`; all pings if `before` is `None`.
fn fresh(pings: &Pings, before: Option<Nanos>) -> impl Iterator<Item = &mdle_runtime::Ping> {
    pings.newest_first().take_while(move |ping| before.is_none_or(|before| ping.at > before))
}
