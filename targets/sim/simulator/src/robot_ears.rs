//! The ears of a simulated robot: two microphones at its centre, which receive the sound sources of its world.

use mdle_runtime::{Nanos, Pose, Radians};
use mdle_sound::{EarPose, Ears, RATE, SoundRoom, SphericalHead};

use crate::world::World;

/// The ears of a robot.
pub struct RobotEars {
    ears: Ears,
    /// Pose at the previous exchange, and number of samples up to this exchange; `None` before the first exchange.
    before: Option<(Pose, u64)>,
}

impl RobotEars {
    /// Creates the ears of a robot with a head of this radius, in metres; `None` if the world has no sound source.
    #[must_use]
    pub fn new(world: &World, radius: f64, seed: u64) -> Option<Self> {
        if world.sounds.is_empty() {
            return None;
        }
        let ears = Ears::new(SphericalHead::new(radius), room(world), &world.sounds, seed);
        Some(Self { ears, before: None })
    }

    /// Returns the samples of the left and the right ear since the previous exchange; `here` is the robot's pose at
    /// this exchange.
    pub fn heard(&mut self, here: &Pose, now: Nanos) -> Vec<[f32; 2]> {
        let until = (u128::from(now.0) * u128::from(RATE) / 1_000_000_000).try_into().unwrap_or(u64::MAX);
        let (before, since) = self.before.replace((*here, until)).unwrap_or((*here, until));
        let middle = |from: f64, to: f64| (from + to) / 2.0;
        let turned = Radians(here.theta.0 - before.theta.0).wrapped().0;
        let at = (middle(before.x.0, here.x.0), middle(before.y.0, here.y.0));
        let ears = EarPose { at, heading: before.theta.0 + turned / 2.0 };
        let mut samples = Vec::new();
        // A period is at most a second.
        let count = usize::try_from(until.saturating_sub(since).min(u64::from(RATE))).unwrap_or_default();
        self.ears.hear(&ears, count, &mut samples);
        samples
    }
}

/// Returns the acoustic room of a world, which is the rectangle around its walls.
pub(crate) fn room(world: &World) -> SoundRoom {
    let mut places = world.segments().flat_map(|(_, from, to)| [from, to]);
    let Some(first) = places.next() else { return SoundRoom::open() };
    let (min, max) = places.fold((first, first), |(mut min, mut max), place| {
        (min.x, min.y) = (min.x.min(place.x), min.y.min(place.y));
        (max.x, max.y) = (max.x.max(place.x), max.y.max(place.y));
        (min, max)
    });
    SoundRoom::new((min.x, min.y), (max.x, max.y), world.t60)
}
