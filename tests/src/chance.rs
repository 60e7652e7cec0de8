//! Random choices that are the same on every machine, because they depend on the seed only.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Returns how often a test repeats something with different random choices: `count` times the number in the variable
/// `MDLE_LONG`.
///
/// Without the variable, returns a quarter of `count`, so that the tests of a change end soon. `.ci/thorough` sets the
/// variable.
///
/// # Panics
///
/// If the variable is not a whole number from 1 on.
#[must_use]
pub fn repeated(count: u64) -> u64 {
    factor().map_or(count.div_ceil(4), |factor| count * factor)
}

/// Returns the size of a test's input: `most` if the variable `MDLE_LONG` is more than 1, `less` if not. Used for
/// inputs for which an unoptimized mdlec takes long.
///
/// # Panics
///
/// If the variable is not a whole number from 1 on.
#[must_use]
pub fn sized<T>(less: T, most: T) -> T {
    if factor().is_some_and(|factor| factor > 1) { most } else { less }
}

/// Returns the number in the variable `MDLE_LONG`, if it is set.
fn factor() -> Option<u64> {
    let factor = std::env::var("MDLE_LONG").ok()?;
    let factor = factor.parse().ok().filter(|factor: &u64| *factor >= 1);
    Some(factor.expect("MDLE_LONG is a whole number from 1 on"))
}

/// A source of random choices.
#[derive(Debug, Clone)]
pub struct Chance(ChaCha8Rng);

impl Chance {
    /// Returns a source of random choices with this seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Returns a random number below `end`, which must not be 0. The result has a slight bias.
    pub fn below(&mut self, end: usize) -> usize {
        (self.0.next_u64() % end as u64) as usize
    }

    /// Returns `true` with this probability, in percent.
    pub fn percent(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// Returns a random element of `choices`.
    pub fn pick<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }
}
