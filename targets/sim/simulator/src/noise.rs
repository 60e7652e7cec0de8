//! Random numbers of a run. Each purpose has its own stream, so that omitting one purpose does not change the others.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A stream of random numbers. The seed and the purpose determine it.
#[derive(Debug, Clone)]
pub(crate) struct Noise(ChaCha8Rng);

/// Purpose of random numbers. Each purpose has its own stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Errors of the sonars' ranges.
    Ranges = 0,
    /// Random ranges without meaning.
    Outliers = 1,
    /// Random loudness of echoes.
    Fading = 2,
    /// The slip of the wheels.
    Slip = 3,
    /// Start pose of the robot.
    Start = 4,
}

impl Noise {
    pub(crate) fn of(seed: u64, purpose: Purpose) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(purpose as u64);
        Self(random)
    }

    /// Returns a number from the standard normal distribution, by Box and Muller's transform.
    pub(crate) fn normal(&mut self) -> f64 {
        let (one, other) = (self.uniform(), self.uniform());
        // 1 - u is above 0, so the logarithm is finite.
        libm::sqrt(-2.0 * libm::log(1.0 - one)) * libm::cos(TAU * other)
    }

    /// Returns a number from 0 up to, but not including, 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        // The upper 53 bits, which an f64 can represent exactly.
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
