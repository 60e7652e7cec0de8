//! The bearing of a source from the signals of two microphones that turn with a robot.

use crate::{Estimator, Histogram, RatioGate};

/// Estimates of the bearing of a source over time, in the axes of odometry.
#[derive(Debug, Clone)]
pub struct Localizer {
    estimator: Estimator,
    gate: RatioGate,
    histogram: Histogram,
    /// Seconds since an estimate was kept; `None` before the first.
    silent: Option<f64>,
}

impl Localizer {
    /// Returns a localizer for a head of this radius, in metres.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        let (estimator, gate, histogram) = (Estimator::new(radius), RatioGate::default(), Histogram::default());
        Self { estimator, gate, histogram, silent: None }
    }

    /// Takes the newest samples of the left and the right ear, in the middle of which the robot had this heading, in
    /// radians; `seconds` have passed since the previous call. Returns the estimated angle, if it was kept.
    pub fn take(&mut self, samples: &[[f32; 2]], heading: f64, seconds: f64) -> Option<f64> {
        self.histogram.pass();
        self.silent = self.silent.map(|silent| silent + seconds);
        let estimate = self.estimator.estimate(samples)?;
        if !self.gate.keeps(estimate.ratio, seconds) {
            return None;
        }
        self.histogram.take(estimate.angle, heading);
        self.silent = Some(0.0);
        Some(estimate.angle)
    }

    /// Returns the most probable bearing, in radians, and the seconds since it was last confirmed; `None` before
    /// anything was heard.
    #[must_use]
    pub fn bearing(&self) -> Option<(f64, f64)> {
        self.silent.map(|silent| (self.histogram.bearing(), silent))
    }
}
