//! Computes the signals of two ears in a room, block by block, at the current pose of the robot.

use microfft::Complex32;
use microfft::complex::cfft_16384;

use crate::head::{LATE, SphericalHead, TAPS};
use crate::room::SoundRoom;
use crate::source::{RandomStream, SoundSource, SourceSignal};
use crate::{RATE, SPEED, WINDOW};

/// Length, in samples, of the Fourier transform that convolves the signals of sources with responses.
const LENGTH: usize = 16_384;
/// Maximum length of a room's response, in samples.
const LONGEST: usize = LENGTH - WINDOW;
/// Number of the stream of random numbers for the microphones' noise. The numbers of the streams for the sources begin
/// at `SOURCES`.
const MICROPHONES: u64 = 0;
const SOURCES: u64 = 1;

/// Position and heading of a head, which has an ear on its left and on its right.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EarPose {
    /// Position on the floor, in metres.
    pub at: (f64, f64),
    /// Heading, in radians.
    pub heading: f64,
}

/// Two ears in a room with sources.
#[derive(Debug, Clone)]
pub struct Ears {
    head: SphericalHead,
    room: SoundRoom,
    sources: Vec<(SoundSource, SourceSignal)>,
    chance: RandomStream,
    /// Loudness of the microphones' own noise.
    noise: f64,
    /// Sound that has left its source but has not reached the ears yet. The real part is the sound for the left ear,
    /// and the imaginary part is the sound for the right ear.
    under_way: Vec<Complex32>,
}

impl Ears {
    /// Returns ears that no sound has reached yet. `seed` determines the noise of the microphones and the signals of
    /// the sources.
    #[must_use]
    pub fn new(head: SphericalHead, room: SoundRoom, sources: &[SoundSource], seed: u64) -> Self {
        let signal = |(purpose, source): (u64, &SoundSource)| (*source, SourceSignal::new(source.kind, seed, purpose));
        let sources = (SOURCES..).zip(sources).map(signal).collect();
        let under_way = vec![Complex32::default(); LENGTH];
        Self { head, room, sources, chance: RandomStream::new(seed, MICROPHONES), noise: 1.0, under_way }
    }

    /// Sets the loudness of the microphones' own noise. The default is 1, to which the levels of sources refer.
    #[must_use]
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// Appends the next `count` samples of the left and the right ear, while the head is at the pose `here`.
    pub fn hear(&mut self, here: &EarPose, count: usize, samples: &mut Vec<[f32; 2]>) {
        let mut left = count;
        while left > 0 {
            let stretch = left.min(WINDOW);
            for number in 0..self.sources.len() {
                self.emit(number, here, stretch);
            }
            let noise = &mut self.chance;
            let loudness = self.noise;
            samples.extend(
                self.under_way
                    .iter()
                    .take(stretch)
                    .map(|heard| [heard.re, heard.im].map(|ear| ear + (loudness * noise.noise()) as f32)),
            );
            self.under_way.drain(..stretch);
            self.under_way.resize(LENGTH, Complex32::default());
            left -= stretch;
        }
    }

    /// Adds the next `stretch` samples of source `number`, as they will arrive at both ears, to the sound that has not
    /// reached the ears yet.
    fn emit(&mut self, number: usize, here: &EarPose, stretch: usize) {
        let Some((source, signal)) = self.sources.get_mut(number) else { return };
        // The level is given at 2 m, where the pressure is half of that at 1 m.
        let loudness = 2.0 * libm::pow(10.0, source.level / 20.0);
        let mut emitted = vec![Complex32::default(); LENGTH];
        for value in emitted.iter_mut().take(stretch) {
            value.re = (loudness * signal.sample()) as f32;
        }
        let at = source.at;
        let mut response = self.response(at, here);
        transform(&mut emitted);
        transform(&mut response);
        let product = emitted.iter().zip(&response).map(|(emitted, response)| emitted * response);
        // The inverse transform, computed by transforming the conjugate.
        let mut heard: Vec<_> = product.map(|bin| bin.conj()).collect();
        transform(&mut heard);
        for (under_way, heard) in self.under_way.iter_mut().zip(&heard) {
            *under_way += heard.conj() / LENGTH as f32;
        }
    }

    /// Returns the impulse response of both ears at the pose `here` to a source at this position. The real part is the
    /// response of the left ear, and the imaginary part is the response of the right ear.
    fn response(&self, source: (f64, f64), here: &EarPose) -> Vec<Complex32> {
        let mut response = vec![Complex32::default(); LENGTH];
        let (sin, cos) = libm::sincos(here.heading);
        self.room.images(source, here.at, |image| {
            // The delay at the centre of the head is rounded, so that the rounding error is the same for both ears.
            let late = libm::round(image.distance / SPEED * f64::from(RATE)) as usize;
            let Some(first) = late.checked_sub(LATE.min(late)).filter(|first| first + TAPS <= LONGEST) else { return };
            let [x, y, _] = image.from;
            let cosine = (y * cos - x * sin) / image.distance;
            let pressure = image.pressure as f32;
            let ears = self.head.response(cosine).iter().zip(self.head.response(-cosine));
            for (sum, (left, right)) in response.iter_mut().skip(first).zip(ears) {
                *sum += Complex32::new(pressure * left, pressure * right);
            }
        });
        response
    }
}

/// Computes the Fourier transform in place.
// If it were inlined three times into `emit`, LLVM would take minutes to optimize its nested loops.
#[inline(never)]
fn transform(values: &mut [Complex32]) {
    if let Ok(values) = values.try_into() {
        let _: &mut [Complex32; LENGTH] = cfft_16384(values);
    }
}
