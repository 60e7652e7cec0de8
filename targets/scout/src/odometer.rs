//! Computes the odometry of a Scout, whose positions wrap at 83 m. See docs/src/reference/protocols.md, 1.8.

use mdle_runtime::{Meters, Nanos, Pose, Radians};

use crate::fault::Fault;
use crate::state::State;
use crate::wheels::UNIT;

/// Number of different values in sign-magnitude form, from -32767 to 32767.
const NUMBERS: i32 = 65_535;

/// Distance, in metres, by which a step between two states may exceed the distance that the robot can drive in the time
/// between them. A larger step is a leap.
const LEAP: f64 = 1.0;
/// Maximum ratio of a wheel's speed to its commanded speed.
const FASTER: f64 = 2.0;
/// Maximum difference between the number of leaps and the number of normal steps. If the difference is larger, the
/// positions are unusable.
const LEAPS: u8 = 4;

/// Odometry that adds up the changes of the wrapping positions from state to state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Odometer {
    last: Option<(i16, i16)>,
    at: Nanos,
    x: i64,
    y: i64,
    leaps: u8,
}

impl Odometer {
    /// Returns the robot's pose in the state `state`, which arrived at the time `at`. The commands never exceed the
    /// wheel speed `fastest`, in m/s. A leap does not change the pose. Between two states, the robot must move less
    /// than half of the range at which positions wrap.
    ///
    /// # Errors
    /// Fails if the positions leap repeatedly.
    pub(crate) fn pose(&mut self, state: &State, at: Nanos, fastest: f64) -> Result<Pose, Fault> {
        let (x, y) = self.last.replace((state.x, state.y)).unwrap_or((0, 0));
        let (x, y) = (unwrapped(x, state.x), unwrapped(y, state.y));
        let seconds = at.since(std::mem::replace(&mut self.at, at)).seconds();
        if libm::hypot(x as f64, y as f64) * UNIT > LEAP + FASTER * fastest * seconds {
            self.leaps = self.leaps.saturating_add(1);
        } else {
            self.leaps = self.leaps.saturating_sub(1);
            (self.x, self.y) = (self.x + x, self.y + y);
        }
        if self.leaps > LEAPS {
            return Err(Fault::Leaps);
        }
        let heading = Radians::from_degrees(f64::from(state.heading) / 10.0).wrapped();
        Ok(Pose { x: meters(self.x), y: meters(self.y), theta: heading })
    }
}

/// Returns the difference between two consecutive positions; the second may have overflowed and wrapped around.
fn unwrapped(from: i16, to: i16) -> i64 {
    let way = i32::from(to) - i32::from(from);
    let half = NUMBERS / 2;
    i64::from(match way {
        way if way > half => way - NUMBERS,
        way if way < -half => way + NUMBERS,
        way => way,
    })
}

fn meters(units: i64) -> Meters {
    Meters(units as f64 * UNIT)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn state(x: i16, y: i16) -> State {
        State { x, y, ..State::read(&[0; 42]).unwrap() }
    }

    fn units(pose: Pose) -> [i32; 2] {
        [pose.x, pose.y].map(|meters| libm::round(meters.0 / UNIT) as i32)
    }

    #[test]
    fn the_way_goes_on_where_numbers_wrap() {
        let mut odometer = Odometer::default();
        let mut at = 0;
        let mut units = |x: i16, y: i16| {
            // A maximum speed at which none of these distances is a leap.
            at += 1_000_000_000;
            units(odometer.pose(&state(x, y), Nanos(at), 1000.0).unwrap())
        };
        assert_eq!(units(20_000, -20_000), [20_000, -20_000]);
        assert_eq!(units(32_767, -32_767), [32_767, -32_767]);
        // One unit further, although the transmitted position falls by 83 m.
        assert_eq!(units(-32_767, 32_767), [32_768, -32_768]);
        assert_eq!(units(0, 0), [65_535, -65_535]);
        assert_eq!(units(-20_000, 20_000), [45_535, -45_535]);
    }

    #[test]
    fn leaps_move_the_pose_nowhere_and_many_are_a_fault() {
        let mut odometer = Odometer::default();
        let mut at = 0;
        let mut after = |x: i16| {
            at += 100_000_000;
            odometer.pose(&state(x, 0), Nanos(at), 1.0).map(|pose| units(pose)[0])
        };
        // One wrong position causes two leaps, and neither changes the pose; later positions count from the last one.
        assert_eq!([100, 9000, 110, 120].map(&mut after), [Ok(100), Ok(100), Ok(100), Ok(110)]);
        // Half a metre in 0.1 s is possible if a state was late.
        assert_eq!(after(320), Ok(310));
        let leaps = [1000, 2000, 3000, 4000, 5000, 6000].map(after);
        assert_eq!(leaps.iter().position(|pose| *pose == Err(Fault::Leaps)), Some(4));
    }
}
