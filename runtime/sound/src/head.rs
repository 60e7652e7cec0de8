//! Computes impulse responses for the sound at the surface of a hard sphere, by the exact series (Kuhn, "Model for the
//! interaural time differences in the azimuthal plane", 1977).

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::{RATE, SPEED};

/// Length of a response, in samples.
pub(crate) const TAPS: usize = 128;
/// Delay of a response, in samples, which allows the response to begin before the sound reaches the centre of the head.
pub(crate) const LATE: usize = 40;
/// Length, in samples, of the Fourier transform by which a response is computed.
const PERIOD: usize = 256;
/// Maximum number of terms of the series.
const TERMS: usize = 200;
/// Frequencies, in Hz, between which the spectrum of a response falls to zero. This makes the response short.
const FALL: (f64, f64) = (12_000.0, 18_000.0);
/// Number of angles of incidence: one for each degree from 0 to 180.
const ANGLES: usize = 181;

/// A hard spherical head with a microphone at each end of a diameter.
#[derive(Debug, Clone)]
pub struct SphericalHead {
    /// Responses, one for each angle in whole degrees between the direction of the sound and the direction of the
    /// microphone.
    responses: Vec<[f32; TAPS]>,
}

impl SphericalHead {
    /// Creates the head of this radius, in metres.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        let waves: Vec<_> = (1..=PERIOD / 2).map(|bin| Series::new(wave_number(bin, radius))).collect();
        let turns: Vec<_> = (0..PERIOD).map(|place| turn(place as f64 / PERIOD as f64)).collect();
        let responses = (0..ANGLES).map(|degrees| response(&waves, &turns, libm::cos(degrees as f64 * PI / 180.0)));
        Self { responses: responses.collect() }
    }

    /// Returns the response of a microphone to a sound; `cosine` is the cosine of the angle between the directions of
    /// the microphone and of the sound.
    pub(crate) fn response(&self, cosine: f64) -> &[f32; TAPS] {
        const SILENT: [f32; TAPS] = [0.0; TAPS];
        let degrees = libm::round(libm::acos(cosine.clamp(-1.0, 1.0)) * 180.0 / PI);
        // The conversion saturates.
        self.responses.get(degrees as usize).unwrap_or(&SILENT)
    }
}

/// Returns the product of the wave number and the radius at a bin of the transform.
fn wave_number(bin: usize, radius: f64) -> f64 {
    2.0 * PI * frequency(bin) * radius / SPEED
}

/// Returns the frequency of a bin, in Hz.
fn frequency(bin: usize) -> f64 {
    bin as f64 * f64::from(RATE) / PERIOD as f64
}

/// Returns the complex number of modulus 1 whose angle is `part` of a full turn.
fn turn(part: f64) -> Complex64 {
    let (sin, cos) = libm::sincos(2.0 * PI * part);
    Complex64::new(cos, sin)
}

/// Computes the impulse response at one angle of incidence; `waves` contains a series for each frequency.
fn response(waves: &[Series], turns: &[Complex64], cosine: f64) -> [f32; TAPS] {
    let at = |place: usize| turns.get(place % PERIOD).copied().unwrap_or_default();
    let mut spectrum = vec![Complex64::new(1.0, 0.0)];
    for (bin, wave) in (1..).zip(waves) {
        // Delays the response by `LATE` samples.
        spectrum.push(wave.transfer(cosine) * low_pass(frequency(bin)) * at(bin * LATE).conj());
    }
    let mut response = [0.0; TAPS];
    for (sample, value) in response.iter_mut().enumerate() {
        let bins = spectrum.iter().enumerate().skip(1);
        let sum: f64 = bins.map(|(bin, value)| (value * at(bin * sample)).re).sum();
        *value = ((1.0 + 2.0 * sum) / PERIOD as f64) as f32;
    }
    response
}

fn low_pass(frequency: f64) -> f64 {
    let part = ((frequency - FALL.0) / (FALL.1 - FALL.0)).clamp(0.0, 1.0);
    0.5 + 0.5 * libm::cos(PI * part)
}

/// The series at one frequency: the factor of each Legendre polynomial.
struct Series(Vec<Complex64>);

impl Series {
    /// Creates the series for a product `ka` of wave number and radius, which is above 0.
    fn new(ka: f64) -> Self {
        let (sin, cos) = libm::sincos(ka);
        // Spherical Hankel functions of the first kind, of orders 0 and 1; the loop computes the higher orders.
        let mut before = Complex64::new(sin / ka, -cos / ka);
        let mut here = Complex64::new(sin / (ka * ka) - cos / ka, -cos / (ka * ka) - sin / ka);
        let mut factors = vec![factor(0, -here, ka)];
        for order in 1..TERMS {
            let slope = before - here * ((order as f64 + 1.0) / ka);
            let next = factor(order, slope, ka);
            factors.push(next);
            if order as f64 > ka && next.norm_sqr() < 1e-16 {
                break;
            }
            (before, here) = (here, here * ((2.0 * order as f64 + 1.0) / ka) - before);
        }
        Self(factors)
    }

    /// Returns the ratio of the pressure at a point of the sphere to the pressure that the wave would have at the
    /// sphere's centre without the sphere. If the phase is positive, the pressure at the point is ahead.
    fn transfer(&self, cosine: f64) -> Complex64 {
        let (mut before, mut polynomial) = (0.0, 1.0);
        let mut sum = Complex64::new(0.0, 0.0);
        for (order, factor) in self.0.iter().enumerate() {
            sum += factor * polynomial;
            let order = order as f64;
            let next = ((2.0 * order + 1.0) * cosine * polynomial - order * before) / (order + 1.0);
            (before, polynomial) = (polynomial, next);
        }
        sum
    }
}

/// Returns the factor of the Legendre polynomial of this order, given the derivative `slope` of the Hankel function of
/// the same order.
fn factor(order: usize, slope: Complex64, ka: f64) -> Complex64 {
    let power = match order % 4 {
        0 => Complex64::new(0.0, 1.0),
        1 => Complex64::new(1.0, 0.0),
        2 => Complex64::new(0.0, -1.0),
        _ => Complex64::new(-1.0, 0.0),
    };
    // The conjugate is taken because the series uses waves exp(-iωt), and transforms use exp(+iωt).
    (power * (2.0 * order as f64 + 1.0) / (slope * ka * ka)).conj()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the ratio of the actual delay between two microphones at ±90° to the delay by equation 7. The actual
    /// delay is measured from the phases in a frequency band, with equal weights.
    fn over_equation_7(radius: f64, (from, to): (f64, f64), bearing: f64) -> f64 {
        let sin = libm::sin(bearing);
        let [left, right] = [sin, -sin];
        let step = 25.0;
        let bins: Vec<_> = (0..((to - from) / step) as usize).map(|bin| from + bin as f64 * step).collect();
        let cross = |frequency: f64| {
            let series = Series::new(2.0 * PI * frequency * radius / SPEED);
            let cross = series.transfer(left) * series.transfer(right).conj();
            cross / cross.norm_sqr().sqrt()
        };
        let cross: Vec<_> = bins.iter().map(|frequency| cross(*frequency)).collect();
        let correlation = |delay: f64| -> f64 {
            bins.iter().zip(&cross).map(|(frequency, cross)| (cross * turn(-frequency * delay)).re).sum()
        };
        let expected = radius * (bearing + sin) / SPEED;
        let best = (800..1600).max_by(|one, other| {
            let [one, other] = [one, other].map(|part| correlation(f64::from(*part) / 1000.0 * expected));
            one.total_cmp(&other)
        });
        f64::from(best.unwrap()) / 1000.0
    }

    #[test]
    fn equation_7_is_a_law_of_high_frequencies() {
        let ratio = |radius, band| {
            let at = |degrees: f64| over_equation_7(radius, band, degrees.to_radians());
            (at(20.0) + at(45.0) + at(70.0)) / 3.0
        };
        let low = ratio(0.0875, (200.0, 1000.0));
        let high = ratio(0.0875, (1500.0, 8000.0));
        let large = ratio(0.15, (500.0, 4000.0));
        assert!((1.25..1.45).contains(&low), "{low}");
        assert!((1.02..1.08).contains(&high), "{high}");
        assert!((1.03..1.09).contains(&large), "{large}");
    }

    #[test]
    fn a_hard_wall_doubles_the_pressure_and_a_small_head_does_nothing() {
        assert!((Series::new(60.0).transfer(1.0).norm_sqr().sqrt() - 2.0).abs() < 0.05);
        assert!((Series::new(0.001).transfer(-0.5).norm_sqr().sqrt() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_near_ear_leads() {
        let head = SphericalHead::new(0.15);
        let first = |cosine: f64| {
            let response = head.response(cosine);
            let most = response.iter().fold(0.0, |most: f32, value| most.max(value.abs()));
            response.iter().position(|value| value.abs() > 0.5 * most).unwrap()
        };
        let (near, far) = (first(1.0), first(-1.0));
        // 0.15 m · (1 + π/2) / 343 m/s are 50 samples.
        assert!((44..58).contains(&(far - near)), "{near} {far}");
    }
}
