//! Estimates the bearing of a source from the signals of two microphones that turn with a robot.

use crate::{Estimator, Histogram, RatioGate};

/// Estimates the bearing of a source over time, in odometry coordinates.
#[derive(Debug, Clone)]
pub struct Localizer {
    estimator: Estimator,
    gate: RatioGate,
    histogram: Histogram,
    /// Time since an estimate was last kept, in seconds; `None` before the first estimate.
    silent: Option<f64>,
}

impl Localizer {
    /// Creates a localizer for a head of this radius, in metres.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        let (estimator, gate, histogram) = (Estimator::new(radius), RatioGate::default(), Histogram::default());
        Self { estimator, gate, histogram, silent: None }
    }

    /// Updates the bearing with the newest samples of the left and the right ear. `heading` is the robot's heading in
    /// the middle of these samples, in radians, and `seconds` is the time since the previous call. Returns the
    /// estimated angle if the estimate was kept.
    pub fn take(&mut self, samples: &[[f32; 2]], heading: f64, seconds: f64) -> Option<f64> {
        self.histogram.pass();
        self.silent = self.silent.map(|silent| silent + seconds);
        let estimate = self.estimator.estimate(samples)?;
        if !self.gate.keeps(&estimate, seconds) {
            return None;
        }
        self.histogram.take(estimate.angle, heading);
        self.silent = Some(0.0);
        Some(estimate.angle)
    }

    /// Returns the most probable bearing, in radians, and the time since an estimate was last kept, in seconds; `None`
    /// before the first estimate.
    #[must_use]
    pub fn bearing(&self) -> Option<(f64, f64)> {
        self.silent.map(|silent| (self.histogram.bearing(), silent))
    }
}
