//! Random start poses near a given one: `--start-noise` limits the deviation, and the seed selects the pose.

use mdle_quantity::Quantity;
use mdle_runtime::{Meters, Pose, Radians};

use crate::footprint::Form;
use crate::noise::{Noise, Purpose};
use crate::start::{self, StartError};
use crate::walls::Walls;
use crate::world::World;

/// Number of poses tried before the search fails.
const TRIES: u32 = 1000;
/// Maximum values of `--start-noise`, in metres and degrees.
const MOST: [f64; 2] = [100.0, 180.0];

/// Maximum deviation of a start pose along each axis and in heading, to either side, with a uniform distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartNoise {
    metres: f64,
    degrees: f64,
}

impl StartNoise {
    /// Parses `metres,degrees`.
    ///
    /// # Errors
    /// Fails if the text is not a length and an angle within their limits; the message contains the correction.
    pub fn read(text: &str) -> Result<Self, String> {
        let sentence = "expected metres,degrees: up to 100 and 180, as in `0.1,5`";
        let (metres, degrees) = text.split_once(',').ok_or(sentence)?;
        let metres = Quantity::Length.read(metres.trim(), "m")?;
        let degrees = Quantity::Angle.read(degrees.trim(), "deg")?;
        let is_within = (0.0..=MOST[0]).contains(&metres) && (0.0..=MOST[1]).contains(&degrees);
        is_within.then_some(Self { metres, degrees }).ok_or_else(|| sentence.to_owned())
    }

    /// Returns the start pose for `seed`: the first random pose around `start` at which a robot of this form can start.
    ///
    /// # Errors
    /// Returns the reason why the robot cannot start at the last pose tried.
    pub fn pose(self, start: &Pose, seed: u64, form: Form, world: &World, walls: &Walls) -> Result<Pose, StartError> {
        let mut noise = Noise::of(seed, Purpose::Start);
        let mut pose = self.drawn(start, &mut noise);
        for _ in 1..TRIES {
            if start::check(&pose, form, world, walls).is_ok() {
                return Ok(pose);
            }
            pose = self.drawn(start, &mut noise);
        }
        start::check(&pose, form, world, walls).map(|()| pose)
    }

    fn drawn(self, start: &Pose, noise: &mut Noise) -> Pose {
        let mut within = |most: f64| most * (2.0 * noise.uniform() - 1.0);
        let (x, y) = (Meters(start.x.0 + within(self.metres)), Meters(start.y.0 + within(self.metres)));
        Pose { x, y, theta: Radians(start.theta.0 + Radians::from_degrees(within(self.degrees)).0).wrapped() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_and_nothing_else() {
        for text in ["0.1, 5", "10cm,5deg"] {
            assert_eq!(StartNoise::read(text), Ok(StartNoise { metres: 0.1, degrees: 5.0 }));
        }
        for text in ["", "1", "1,2,3", "-0.1,5", "0.1,181", "nan,1", "0.1,inf", "0.1,5cm", "101,0"] {
            assert!(StartNoise::read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn starts_are_spread_over_what_was_asked_for_and_stand_clear_of_walls() {
        let world = World::office().expect("our own floor");
        let walls = Walls::of(&world);
        let noise = StartNoise { metres: 1.0, degrees: 30.0 };
        let poses: Vec<Pose> = (0..200)
            .map(|seed| noise.pose(&world.start, seed, Form::SCOUT, &world, &walls).expect("there is room"))
            .collect();
        let greatest = |of: fn(&Pose) -> f64| poses.iter().map(|pose| of(pose).abs()).fold(0.0, f64::max);
        // The wall is 0.75 m away, and the body's radius is 0.205 m.
        assert!((0.5..=0.545).contains(&greatest(|pose| pose.x.0.min(0.0))));
        assert!((0.9..=1.0).contains(&greatest(|pose| pose.y.0)));
        assert!((28.0..=30.0).contains(&greatest(|pose| pose.theta.degrees())));
        assert_eq!(noise.pose(&world.start, 7, Form::SCOUT, &world, &walls), Ok(poses[7]));
        let wall = Pose { x: Meters(-0.75), ..Pose::ORIGIN };
        let stuck = StartNoise { metres: 0.0, degrees: 1.0 }.pose(&wall, 1, Form::SCOUT, &world, &walls);
        assert_eq!(stuck, Err(StartError::Overlaps(Form::SCOUT, "A west".into())));
    }
}
