//! Random numbers of a run. Each purpose has its own stream, so that omitting one purpose does not change the others.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Number of random numbers that are drawn at a time: the four blocks that a generator of `rand_chacha` holds.
const NUMBERS: usize = 32;

/// A stream of random numbers, determined by the seed and the purpose: the stream of ChaCha with 8 rounds.
///
/// A generator of `rand_chacha` takes 320 bytes, and a robot needs four generators. In a crowd, they would take nearly
/// as much memory as the pings of the sonars. Therefore the drawn numbers are kept only during a turn.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    seed: u64,
    purpose: Purpose,
    /// Index of the next number in `numbers`.
    place: u8,
    /// Number of times that numbers were drawn and used up. In 20 years, a robot does not need 32 bits of it.
    drawn: u32,
    /// The numbers that were drawn together with the next one; `None` if they have to be drawn.
    numbers: Option<Box<[u64; NUMBERS]>>,
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
        Self { seed, purpose, place: 0, drawn: 0, numbers: None }
    }

    /// Frees the memory of the drawn numbers. They are drawn again when the next one is needed.
    pub(crate) fn release(&mut self) {
        self.numbers = None;
    }

    /// Returns the next number of the stream.
    fn next(&mut self) -> u64 {
        let Self { seed, purpose, drawn, .. } = *self;
        let numbers = self.numbers.get_or_insert_with(|| Box::new(draw(seed, purpose, drawn)));
        let number = numbers[usize::from(self.place)];
        self.place = (self.place + 1) % NUMBERS as u8;
        if self.place == 0 {
            (self.drawn, self.numbers) = (drawn.wrapping_add(1), None);
        }
        number
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

/// Draws numbers of a stream that begins with `before` times as many others.
fn draw(seed: u64, purpose: Purpose, before: u32) -> [u64; NUMBERS] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(purpose as u64);
    // A number takes two words of the stream.
    random.set_word_pos(2 * NUMBERS as u128 * u128::from(before));
    let mut bytes = [0; 8 * NUMBERS];
    random.fill_bytes(&mut bytes);
    let (numbers, _) = bytes.as_chunks();
    std::array::from_fn(|place| u64::from_le_bytes(numbers[place]))
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
            if number % 7 == 0 {
                noise.release();
            }
        }
    }
}
