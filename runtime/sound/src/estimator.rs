//! Estimates the angle between straight ahead and the direction of a source, from the delay between two ears (paper,
//! equation 7).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use microfft::Complex32;
use microfft::real::rfft_8192;
use num_complex::Complex64;

use crate::{RATE, SPEED, WINDOW};

/// Length of the Fourier transform, in samples.
const LENGTH: usize = 8192;
/// Bins of the spectrum that the estimator uses: 500 to 4000 Hz.
const BAND: std::ops::RangeInclusive<usize> = 93..=743;
/// Number of delays for each sample at which the correlation is computed.
const FINE: usize = 4;
/// Exponent of the whitening: 0 gives the plain correlation, 1 the phase transform.
const WHITENING: f64 = 0.7;
/// Difference between the radius in equation 7 and the radius of the head, in metres. It is not 0, because the equation
/// is exact only for high frequencies.
const WIDER: f64 = 0.009;
/// Maximum delay that is considered, as a multiple of the maximum delay by equation 7.
const MARGIN: f64 = 1.08;
/// Minimum distance between two maxima of the correlation that belong to different sounds, in steps.
const APART: usize = 12;

/// Estimates the direction of a source, for a head with a given radius.
#[derive(Debug, Clone)]
pub struct Estimator {
    /// Hann window.
    window: Vec<f32>,
    /// Complex numbers of modulus 1, whose angles make up a full turn in `LENGTH * FINE` steps.
    turns: Vec<Complex64>,
    /// Maximum delay that is considered, in steps of the correlation.
    most: usize,
    /// Sum of the angle and its sine in equation 7, in radians, for a delay of one step of the correlation.
    unit: f64,
}

/// An estimated direction of a source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Angle from straight ahead to the left, in radians from -π/2 to π/2.
    pub angle: f64,
    /// Ratio of the maximum of the correlation to its root mean square.
    pub ratio: f64,
    /// Ratio of the second highest local maximum of the correlation to its maximum; 0 if there is only one.
    pub rival: f64,
}

impl Estimator {
    /// Creates the estimator for a head of this radius, in metres.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        let steps = f64::from(RATE) * FINE as f64;
        let most = MARGIN * (radius + WIDER) / SPEED * (1.0 + FRAC_PI_2) * steps;
        let part = |place: usize, of: usize| TAU * place as f64 / of as f64;
        let turn = |place| {
            let (sin, cos) = libm::sincos(part(place, LENGTH * FINE));
            Complex64::new(cos, sin)
        };
        Self {
            window: (0..WINDOW).map(|place| (0.5 - 0.5 * libm::cos(part(place, WINDOW))) as f32).collect(),
            turns: (0..LENGTH * FINE).map(turn).collect(),
            most: (libm::ceil(most) as usize).clamp(1, LENGTH),
            unit: SPEED / ((radius + WIDER) * steps),
        }
    }

    /// Estimates the angle from the last [`WINDOW`] samples of the left and the right ear; returns `None` if there are
    /// fewer samples, or if one of the ears is silent.
    #[must_use]
    pub fn estimate(&self, samples: &[[f32; 2]]) -> Option<Estimate> {
        let newest = samples.get(samples.len().checked_sub(WINDOW)?..)?;
        let [left, right] = [0, 1].map(|ear| self.spectrum(newest, ear));
        let weighted: Vec<Complex64> =
            left.iter().zip(&right).map(|(left, right)| weight(left * right.conj())).collect();
        let square: f64 = weighted.iter().map(Complex64::norm_sqr).sum();
        if !square.is_finite() || square <= 0.0 {
            return None;
        }
        let correlation = self.correlation(&weighted);
        let greater = |best: usize, place: usize| {
            if correlation.get(place) > correlation.get(best) { place } else { best }
        };
        let best = (0..correlation.len()).fold(0, greater);
        let at = |place: Option<usize>| place.and_then(|place| correlation.get(place)).copied();
        let peak = at(Some(best))?;
        // Fits a parabola through the greatest value and its neighbours.
        let vertex = match (at(best.checked_sub(1)), at(best.checked_add(1))) {
            (Some(before), Some(after)) if before + after < 2.0 * peak => {
                0.5 * (before - after) / (before - 2.0 * peak + after)
            }
            _ => 0.0,
        };
        let delay = best as f64 + vertex - self.most as f64;
        Some(Estimate {
            angle: angle(delay * self.unit),
            ratio: 2.0 * peak / libm::sqrt(2.0 * square),
            rival: rival(&correlation, best) / peak,
        })
    }

    /// Returns one ear's spectrum in the band that the estimator uses.
    fn spectrum(&self, samples: &[[f32; 2]], ear: usize) -> Vec<Complex64> {
        let mut windowed = Box::new([0.0; LENGTH]);
        for ((value, sample), window) in windowed.iter_mut().zip(samples).zip(&self.window) {
            *value = sample.get(ear).copied().unwrap_or_default() * window;
        }
        let spectrum: &[Complex32] = rfft_8192(&mut windowed);
        let band = spectrum.get(BAND).unwrap_or_default();
        band.iter().map(|bin| Complex64::new(f64::from(bin.re), f64::from(bin.im))).collect()
    }

    /// Returns half of the correlation, for delays of the left ear from `-most` to `most` steps. The negative
    /// frequencies would contribute the other half, and are omitted.
    fn correlation(&self, weighted: &[Complex64]) -> Vec<f64> {
        let mut both = vec![0.0; 2 * self.most + 1];
        for step in 0..=self.most {
            let (mut even, mut odd) = (0.0, 0.0);
            for (bin, value) in BAND.zip(weighted) {
                let turn = self.turns.get(bin * step % (LENGTH * FINE)).copied().unwrap_or_default();
                even += value.re * turn.re;
                odd += value.im * turn.im;
            }
            // If the left ear leads, the phase of the product increases with frequency.
            for (place, value) in [(self.most + step, even + odd), (self.most - step, even - odd)] {
                if let Some(there) = both.get_mut(place) {
                    *there = value;
                }
            }
        }
        both
    }
}

/// Returns the highest local maximum of the correlation that is apart from its maximum, which is at `best`; 0 if there
/// is none.
fn rival(correlation: &[f64], best: usize) -> f64 {
    let triples = (1_usize..).zip(correlation.windows(3)).filter(|(place, _)| place.abs_diff(best) > APART);
    let maximum = |(_, triple): (usize, &[f64])| match triple {
        [before, here, after] if here >= before && here >= after => Some(*here),
        [..] => None,
    };
    triples.filter_map(maximum).fold(0.0, f64::max)
}

/// Returns the value of a bin of the cross spectrum after whitening.
fn weight(cross: Complex64) -> Complex64 {
    let square = cross.norm_sqr();
    if square > 0.0 { cross * libm::pow(square, -WHITENING / 2.0) } else { cross }
}

/// Returns the angle by equation 7, given the sum `delay` of the angle and its sine.
fn angle(delay: f64) -> f64 {
    if delay.abs() >= 1.0 + FRAC_PI_2 {
        return FRAC_PI_2.copysign(delay);
    }
    let mut angle = delay / 2.0;
    for _ in 0..8 {
        let (sin, cos) = libm::sincos(angle);
        angle -= (angle + sin - delay) / (1.0 + cos);
    }
    angle.clamp(-PI / 2.0, PI / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::RandomStream;

    /// Returns noise in both ears, which reaches the right ear `late` samples after the left ear.
    fn delayed(late: usize) -> Vec<[f32; 2]> {
        let mut chance = RandomStream::new(3, 0);
        let noise: Vec<_> = (0..WINDOW + late).map(|_| chance.noise() as f32).collect();
        noise.iter().zip(noise.iter().skip(late)).map(|(right, left)| [*left, *right]).collect()
    }

    #[test]
    fn a_delay_becomes_the_angle_of_equation_7() {
        let radius = 0.15;
        for late in [0, 7, 20, 35] {
            let Estimate { angle, ratio, .. } = Estimator::new(radius).estimate(&delayed(late)).unwrap();
            let delay = (radius + WIDER) * (angle + libm::sin(angle)) / SPEED * f64::from(RATE);
            assert!((delay - late as f64).abs() < 0.05 && ratio > 20.0, "{late}: {delay} {ratio}");
        }
    }

    /// Returns the sum of two sounds, which the right ear hears later than the left ear by these numbers of samples.
    /// The second sound has this multiple of the first one's amplitude.
    fn two_sounds(late: [usize; 2], louder: f32) -> Vec<[f32; 2]> {
        let [one, other] = late.map(delayed);
        // The second sound is read backwards, so that its signal is not that of the first one.
        let other = other.iter().rev().map(|[left, right]| [*right, *left]);
        one.iter().zip(other).map(|(one, other)| [0, 1].map(|ear| one[ear] + louder * other[ear])).collect()
    }

    #[test]
    fn another_sound_is_a_rival() {
        let estimator = Estimator::new(0.15);
        let rivals = [0.0, 0.5, 0.95].map(|louder| estimator.estimate(&two_sounds([5, 30], louder)).unwrap().rival);
        assert!(rivals[0] < 0.3 && rivals[0] < rivals[1] && rivals[1] < rivals[2] && rivals[2] > 0.6, "{rivals:?}");
    }

    #[test]
    fn the_leading_ear_is_nearer() {
        let left = delayed(20);
        let right: Vec<_> = left.iter().map(|[left, right]| [*right, *left]).collect();
        let [left, right] = [left, right].map(|ears| Estimator::new(0.15).estimate(&ears).unwrap().angle);
        assert!(left > 0.4 && (left + right).abs() < 1e-3, "{left} {right}");
    }

    #[test]
    fn silence_and_a_short_signal_have_no_angle() {
        let estimator = Estimator::new(0.15);
        assert_eq!(estimator.estimate(&vec![[0.0; 2]; WINDOW]), None);
        assert_eq!(estimator.estimate(&delayed(0)[1..]), None);
        let one_ear: Vec<_> = delayed(0).iter().map(|[left, _]| [*left, 0.0]).collect();
        assert_eq!(estimator.estimate(&one_ear), None);
    }

    #[test]
    fn every_delay_has_an_angle() {
        for hundredth in -300..=300 {
            let delay = f64::from(hundredth) / 100.0;
            let angle = angle(delay);
            let back = angle + libm::sin(angle);
            assert!((back - delay.clamp(-1.0 - FRAC_PI_2, 1.0 + FRAC_PI_2)).abs() < 1e-6, "{delay} {angle}");
        }
    }
}
