//! A histogram of bearings in odometry coordinates. In it, the true direction of a source prevails over the direction
//! that is its mirror image at the axis of the ears.

use std::f64::consts::{PI, TAU};

/// Number of bins, each of 5°.
const BINS: usize = 72;
/// Fraction of a bin's probability that spreads to each neighbouring bin in a turn, because the source may move.
const SPREAD: f64 = 0.02;
/// Fraction of all probabilities that is replaced by a uniform distribution in a turn.
const FORGOTTEN: f64 = 0.02;
/// Standard deviation of an estimate, in radians: 8°.
const DEVIATION: f64 = 8.0 * PI / 180.0;
/// Parameters of the likelihood of an estimate: the height of the bell curve, and the constant that is added to it.
const LIKELY: (f64, f64) = (0.85, 0.015);

/// Probabilities of the bearing of a source.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    bins: [f64; BINS],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { bins: [1.0 / BINS as f64; BINS] }
    }
}

impl Histogram {
    /// Updates the probabilities for a turn in which the source may have moved.
    pub fn pass(&mut self) {
        let before = self.bins;
        let at = |place: usize| before.get(place % BINS).copied().unwrap_or_default();
        for (place, bin) in self.bins.iter_mut().enumerate() {
            let spread = (1.0 - 2.0 * SPREAD) * at(place) + SPREAD * (at(place + 1) + at(place + BINS - 1));
            *bin = (1.0 - FORGOTTEN) * spread + FORGOTTEN / BINS as f64;
        }
    }

    /// Updates the probabilities with an estimate, made at this heading, of the angle from straight ahead to the left,
    /// in radians. The angle is from -90° to 90°, because a head cannot distinguish front from back.
    pub fn take(&mut self, angle: f64, heading: f64) {
        for (place, bin) in self.bins.iter_mut().enumerate() {
            let off = (libm::asin(libm::sin(centre(place) - heading)) - angle) / DEVIATION;
            *bin *= LIKELY.0 * libm::exp(-off * off / 2.0) + LIKELY.1;
        }
        let sum: f64 = self.bins.iter().sum();
        self.bins.iter_mut().for_each(|bin| *bin /= sum);
    }

    /// Returns the most probable bearing, in radians: the weighted mean of the bin with the highest probability and its
    /// neighbours.
    #[must_use]
    pub fn bearing(&self) -> f64 {
        let at = |place: usize| self.bins.get(place % BINS).copied().unwrap_or_default();
        let greater = |best: usize, place: usize| if at(place) > at(best) { place } else { best };
        let best = (0..BINS).fold(0, greater);
        let (left, right) = (at(best + 1), at(best + BINS - 1));
        centre(best) + (left - right) / (left + right + at(best)) * TAU / BINS as f64
    }
}

/// Returns the bearing of the centre of a bin.
fn centre(place: usize) -> f64 {
    place as f64 * TAU / BINS as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees_off(histogram: &Histogram, degrees: f64) -> f64 {
        let off = (histogram.bearing() - degrees.to_radians()).rem_euclid(TAU).to_degrees();
        off.min(360.0 - off)
    }

    #[test]
    fn turning_tells_front_from_back() {
        let mut histogram = Histogram::default();
        // A source at 170°, behind on the left, and a robot that turns from 0° to 60°.
        for turn in 0..20 {
            let heading = f64::from(turn) * 3.0_f64.to_radians();
            histogram.pass();
            histogram.take(libm::asin(libm::sin(170.0_f64.to_radians() - heading)), heading);
        }
        assert!(degrees_off(&histogram, 170.0) < 2.0, "{}", histogram.bearing().to_degrees());
    }

    #[test]
    fn a_source_that_moves_is_followed() {
        let mut histogram = Histogram::default();
        (0..200).for_each(|_| {
            histogram.pass();
            histogram.take(0.0, 0.0);
        });
        for _ in 0..15 {
            histogram.pass();
            histogram.take(50.0_f64.to_radians(), 0.0);
        }
        assert!(degrees_off(&histogram, 50.0).min(degrees_off(&histogram, 130.0)) < 3.0, "{}", histogram.bearing());
    }
}
