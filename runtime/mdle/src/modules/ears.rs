//! The module `heading` of a robot with microphones. It publishes the bearing of a sound, computed from the delay
//! between two ears (paper, section III-G).

use std::collections::VecDeque;

use mdle_engine::{Background, Declare, Exchange, Fault, In, Offer, Out};
use mdle_runtime::{Meters, Nanos, Radians};
use mdle_sound::{Localizer, RATE, WINDOW};

use super::audio::Audio;

/// Range that the module publishes for every sound, because two ears cannot measure a range.
const RANGE: Meters = Meters(2.0);
/// Time, in seconds, for which a bearing is published even if no new sound confirms it.
const REMEMBERED: f64 = 5.0;
/// Number of turns whose headings are stored. They are needed to find the heading in the middle of a window.
const TURNS: usize = 200;

/// Time from the middle of a window to its end, in nanoseconds.
const HALF_A_WINDOW: u64 = WINDOW as u64 * 500_000_000 / RATE as u64;

/// The module that publishes the bearing of a sound.
pub(super) struct EarsModule {
    audio: Audio,
    localizer: Localizer,
    theta: In<Radians>,
    bearing: Out<Radians>,
    range: Out<Meters>,
    /// The newest samples of the left and the right ear.
    samples: VecDeque<[f32; 2]>,
    /// Headings by odometry; the newest comes last.
    headings: VecDeque<(Nanos, f64)>,
}

impl EarsModule {
    /// Declares the module, for a head of this radius in metres.
    pub(super) fn declare(declare: &mut Declare, audio: Audio, radius: f64) -> Self {
        let module = Self {
            audio,
            localizer: Localizer::new(radius),
            theta: declare.reads("sensors", "theta"),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
            samples: VecDeque::new(),
            headings: VecDeque::new(),
        };
        declare.doc("Publishes the bearing of a sound by the delay between two ears.");
        declare.describe("bearing", "deg", "Direction to the sound, from where the robot heads.");
        declare.describe("range", "m", "Distance at which the sound is taken to be: 2 m, as ears cannot measure it.");
        module
    }

    /// Processes the sound of the turn that ended with the last turn break. Fails after the end of the sound.
    fn turn(&mut self, offer: &mut Offer<'_>) -> Result<(), Fault> {
        let (Some(Radians(theta)), now) = (offer.get(self.theta), offer.now()) else { return Ok(()) };
        let before = self.headings.back().map_or(now, |(before, _)| *before);
        if self.headings.len() >= TURNS {
            self.headings.pop_front();
        }
        self.headings.push_back((now, theta));
        let heard = self.audio.take(now).map_err(Fault)?;
        let is_new = !heard.is_empty();
        self.samples.extend(heard);
        self.samples.drain(..self.samples.len().saturating_sub(WINDOW));
        if is_new {
            let heading = self.heading_at(Nanos(now.0.saturating_sub(HALF_A_WINDOW)));
            self.localizer.take(self.samples.make_contiguous(), heading, now.since(before).seconds());
        }
        if let Some((bearing, silent)) = self.localizer.bearing()
            && silent <= REMEMBERED
        {
            offer.publish(self.bearing, Radians(bearing - theta).wrapped());
            offer.publish(self.range, RANGE);
        }
        Ok(())
    }

    /// Returns the heading at a time, interpolated between two turns.
    fn heading_at(&self, time: Nanos) -> f64 {
        let mut after = None;
        for (at, theta) in self.headings.iter().rev() {
            match after {
                _ if *at > time => after = Some((*at, *theta)),
                Some((later, next)) => {
                    let part = time.since(*at).seconds() / later.since(*at).seconds();
                    return theta + Radians(next - theta).wrapped().0 * part;
                }
                None => return *theta,
            }
        }
        after.map_or(0.0, |(_, theta)| theta)
    }
}

impl Background for EarsModule {
    fn run(mut self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        while let Ok(turn) = exchange.exchange(|offer| self.turn(offer)) {
            turn?;
        }
        Ok(())
    }
}
