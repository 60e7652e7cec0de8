//! Sources of sound: white noise, and a signal with the pitch, the syllables and the pauses of speech.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::RATE;

/// Gain at which speech is as loud as white noise, averaged over a long time.
const SPEECH_GAIN: f64 = 13.66;

/// Kind of the sound of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SoundKind {
    /// White noise without pauses.
    White,
    /// A pitch with overtones that fall by 6 dB an octave, in syllables with pauses.
    Speech,
}

/// A source of sound at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoundSource {
    /// Position on the floor, in metres.
    pub at: (f64, f64),
    /// Kind of the sound.
    pub kind: SoundKind,
    /// Level of the sound at a distance of 2 m, in dB relative to the noise of a microphone.
    pub level: f64,
}

/// Stream of random numbers for one purpose.
#[derive(Debug, Clone)]
pub(crate) struct RandomStream(ChaCha8Rng);

impl RandomStream {
    pub(crate) fn new(seed: u64, purpose: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(purpose);
        Self(random)
    }

    /// Returns a random number with a nearly normal distribution of mean 0 and variance 1: the sum of four uniform
    /// random numbers.
    pub(crate) fn noise(&mut self) -> f64 {
        let bits = self.0.next_u64();
        let sum: u64 = (0..4).map(|part| bits >> (16 * part) & 0xffff).sum();
        (sum as f64 / 65_536.0 - 2.0) * 1.732
    }

    /// Returns a random number with a uniform distribution from 0 to 1.
    pub(crate) fn even(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The signal of a source, sample by sample; it has a mean square of 1.
#[derive(Debug, Clone)]
pub(crate) struct SourceSignal {
    kind: SoundKind,
    chance: RandomStream,
    speech: Speech,
}

/// State of speech; times are in samples.
#[derive(Debug, Clone, Default)]
struct Speech {
    /// Time until the next pulse of the pitch.
    pulse: f64,
    /// Time since the syllable began, and its length.
    syllable: (f64, f64),
    /// Length of the pause after the syllable.
    pause: f64,
    /// Output of the low-pass filter.
    low: f64,
}

impl SourceSignal {
    pub(crate) fn new(kind: SoundKind, seed: u64, purpose: u64) -> Self {
        Self { kind, chance: RandomStream::new(seed, purpose), speech: Speech::default() }
    }

    /// Returns the next sample.
    pub(crate) fn sample(&mut self) -> f64 {
        match self.kind {
            SoundKind::White => self.chance.noise(),
            SoundKind::Speech => self.speech.sample(&mut self.chance) * SPEECH_GAIN,
        }
    }
}

impl Speech {
    fn sample(&mut self, chance: &mut RandomStream) -> f64 {
        let rate = f64::from(RATE);
        let (mut since, mut length) = self.syllable;
        if since >= length + self.pause {
            (since, length) = (0.0, rate * (0.12 + 0.18 * chance.even()));
            // Every fifth syllable ends a phrase.
            self.pause =
                rate * if chance.even() < 0.2 { 0.2 + 0.3 * chance.even() } else { 0.02 + 0.06 * chance.even() };
        }
        self.pulse -= 1.0;
        let mut excited = 0.15 * chance.noise();
        if self.pulse <= 0.0 {
            excited += 12.0;
            self.pulse += rate / 120.0 * (1.0 + 0.1 * (chance.even() - 0.5));
        }
        self.syllable = (since + 1.0, length);
        // A parabola over the syllable, and silence after it.
        let part = since / length;
        let envelope = if part < 1.0 { 4.0 * part * (1.0 - part) } else { 0.0 };
        // A low-pass that falls by 6 dB an octave from 500 Hz on: 2π · 500 / 44100.
        self.low += 0.0712 * (excited * envelope - self.low);
        self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_equally_loud() {
        for kind in [SoundKind::White, SoundKind::Speech] {
            let mut signal = SourceSignal::new(kind, 1, 0);
            let square: f64 = (0..30 * RATE).map(|_| signal.sample()).map(|sample| sample * sample).sum();
            let rms = (square / f64::from(30 * RATE)).sqrt();
            assert!((0.9..1.1).contains(&rms), "{kind:?} {rms}");
        }
    }

    #[test]
    fn speech_has_pauses() {
        let mut signal = SourceSignal::new(SoundKind::Speech, 1, 0);
        let loudness = |_| {
            let block = (0..RATE / 20).map(|_| signal.sample().abs()).fold(0.0, f64::max);
            usize::from(block < 0.01)
        };
        let silent: usize = (0..400).map(loudness).sum();
        assert!((20..200).contains(&silent), "{silent} of 400 twentieths of a second");
    }
}
