//! Where a Scout is by its own reckoning, beyond the 83 m at which its numbers wrap.

use mdle_runtime::{Meters, Pose, Radians};

use crate::state::State;
use crate::wheels::UNIT;

/// How many numbers there are in sign and magnitude: those from -32767 to 32767.
const NUMBERS: i32 = 65_535;

/// Follows the numbers of the line from state to state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Odometer {
    last: Option<(i16, i16)>,
    x: i64,
    y: i64,
}

impl Odometer {
    /// The pose that the robot has now. Between two states it moves less than half of what wraps.
    pub(crate) fn pose(&mut self, state: &State) -> Pose {
        let (x, y) = self.last.unwrap_or((0, 0));
        self.x += unwrapped(x, state.x);
        self.y += unwrapped(y, state.y);
        self.last = Some((state.x, state.y));
        let heading = Radians::from_degrees(f64::from(state.heading) / 10.0).wrapped();
        Pose { x: meters(self.x), y: meters(self.y), theta: heading }
    }
}

/// The way from one number to the next.
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
mod tests {
    use super::*;

    #[test]
    fn the_way_goes_on_where_numbers_wrap() {
        let still = State {
            sonars: [255; 16],
            bumper: 0,
            x: 0,
            y: 0,
            heading: 0,
            right: 0,
            left: 0,
            status: 0,
            clock: 0,
            cpu: 0,
            motor: 0,
        };
        let mut odometer = Odometer::default();
        let mut units = |x: i16, y: i16| {
            let pose = odometer.pose(&State { x, y, ..still });
            [pose.x, pose.y].map(|meters| libm::round(meters.0 / UNIT) as i32)
        };
        assert_eq!(units(20_000, -20_000), [20_000, -20_000]);
        assert_eq!(units(32_767, -32_767), [32_767, -32_767]);
        // One unit on, and 83 m back by the number of the line.
        assert_eq!(units(-32_767, 32_767), [32_768, -32_768]);
        assert_eq!(units(0, 0), [65_535, -65_535]);
        assert_eq!(units(-20_000, 20_000), [45_535, -45_535]);
    }
}
