//! Random numbers of a run. Each purpose has its own stream, so that omitting one purpose does not change the others.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Number of random numbers that are drawn at a time: one block of ChaCha.
const NUMBERS: usize = 8;

/// A stream of random numbers, determined by the seed and the purpose: the stream of ChaCha with 8 rounds.
///
/// A generator of `rand_chacha` holds four blocks and its key, which take 320 bytes, and a robot needs four generators.
/// In a crowd, these generators would take as much memory as the pings of the sonars.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    seed: u64,
    purpose: Purpose,
    /// Number of random numbers that have been used.
    used: u64,
    /// The last random numbers that were drawn.
    numbers: [u64; NUMBERS],
}

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
        Self { seed, purpose, used: 0, numbers: [0; NUMBERS] }
    }

    /// Returns the next number of the stream.
    fn next(&mut self) -> u64 {
        let place = (self.used % NUMBERS as u64) as usize;
        if place == 0 {
            self.draw();
        }
        self.used += 1;
        self.numbers[place]
    }

    /// Draws the next numbers of the stream.
    fn draw(&mut self) {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(self.purpose as u64);
        // A number takes two words of the stream.
        random.set_word_pos(2 * u128::from(self.used));
        self.numbers = std::array::from_fn(|_| random.next_u64());
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
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_one_generator() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        random.set_stream(Purpose::Slip as u64);
        let mut noise = Noise::of(7, Purpose::Slip);
        for number in 0..200 {
            assert_eq!(noise.next(), random.next_u64(), "number {number}");
        }
    }
}
