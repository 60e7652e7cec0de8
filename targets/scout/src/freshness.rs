//! Detects stale data. A Scout's clock has to advance, and the ranges of its sonars have to change while the robot
//! moves. See docs/src/reference/protocols.md, 1.8.
//!
//! A state answers a command and is as recent as the command, unless the controller repeats an old state; the clock in
//! the state reveals this. The state does not contain the times of the pings. However, if the sonars ping, the range of
//! at least one sonar changes while the robot turns, or while it moves towards or away from an object that a sonar
//! detects.

use mdle_runtime::{Nanos, Pose, Radians};

use crate::config::Config;
use crate::fault::Fault;
use crate::state::State;

/// Range that a sonar without an echo reports.
const NOTHING: u8 = 255;
/// Maximum angle, in radians, by which the robot may turn before at least one range must have changed. After this
/// angle, each sonar has the direction that the fourth sonar after it had before.
const TURN: f64 = std::f64::consts::FRAC_PI_2;

/// The last data that differed from the previous data, and the motion of the robot since then.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Freshness {
    /// Time of the robot's clock when it last advanced, and the time at which this was received; `None` before the
    /// first state.
    clock: Option<(u32, Nanos)>,
    sonars: [u8; 16],
    /// Last pose of the robot.
    pose: Pose,
    /// Distance that the robot has driven since a sonar's range last changed, in metres.
    way: f64,
    /// Angle by which the robot has turned since a sonar's range last changed, in radians.
    turn: f64,
}

impl Freshness {
    /// Checks the state `state`, which arrived at the time `at`; `pose` is the pose in this state. Returns the time for
    /// which the robot's clock has not advanced; zero if the configuration sets no limit for it.
    ///
    /// # Errors
    /// Fails if the clock has not advanced, or if the sonars' ranges have not changed, for longer than the
    /// configuration allows.
    pub(crate) fn take(&mut self, state: &State, at: Nanos, pose: Pose, config: &Config) -> Result<Nanos, Fault> {
        let (_, since) =
            *self.clock.insert(self.clock.filter(|(clock, _)| *clock == state.clock).unwrap_or((state.clock, at)));
        let age = if config.stale > 0 { at.since(since) } else { Nanos::ZERO };
        if config.stale > 0 && age >= Nanos(config.stale.saturating_mul(1_000_000)) {
            return Err(Fault::Hung(config.stale));
        }
        let heard = config.sonars.iter().any(|sonar| hears(state, *sonar));
        if !heard || state.sonars != self.sonars {
            (self.sonars, self.pose, self.way, self.turn) = (state.sonars, pose, 0.0, 0.0);
        }
        let was = std::mem::replace(&mut self.pose, pose);
        self.turn += Radians(pose.theta.0 - was.theta.0).wrapped().0.abs();
        // Driving straight does not change the range of an object beside the robot, so only the sonars in front and
        // back count.
        if [0, 8].iter().any(|sonar| config.sonars.contains(sonar) && hears(state, *sonar)) {
            self.way += libm::hypot(pose.x.0 - was.x.0, pose.y.0 - was.y.0);
        }
        let is_old = self.way >= config.frozen || self.turn >= TURN;
        if config.frozen > 0.0 && is_old { Err(Fault::Frozen) } else { Ok(age) }
    }
}

/// Returns `true` if this sonar has received an echo.
fn hears(state: &State, sonar: u8) -> bool {
    state.sonars.get(usize::from(sonar)).is_some_and(|range| *range != NOTHING)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use mdle_runtime::Meters;

    use super::*;
    use crate::config::Configured;

    /// Returns the index of the first of these states, a second apart, that is rejected, and the fault. A state
    /// consists of the range ahead, the range to the left, x in metres, the heading in degrees, and the clock.
    fn refused(states: &[(u8, u8, f64, f64, u32)]) -> Option<(usize, Fault)> {
        let config = Config { stale: 1500, ..Configured::read(None, None).unwrap().config };
        let mut freshness = Freshness::default();
        states.iter().enumerate().find_map(|(number, (ahead, left, x, degrees, clock))| {
            let mut sonars = [NOTHING; 16];
            (sonars[0], sonars[4]) = (*ahead, *left);
            let state = State { sonars, clock: *clock, ..State::read(&[0; 42]).unwrap() };
            let pose = Pose { x: Meters(*x), theta: Radians::from_degrees(*degrees), ..Pose::ORIGIN };
            let at = Nanos(number as u64 * 1_000_000_000);
            freshness.take(&state, at, pose, &config).err().map(|fault| (number, fault))
        })
    }

    #[test]
    fn a_clock_that_stands_makes_a_state_an_old_one() {
        assert_eq!(
            refused(&[(9, 9, 0.0, 0.0, 5), (9, 9, 0.0, 0.0, 5), (9, 9, 0.0, 0.0, 6), (9, 9, 0.0, 0.0, 6)]),
            None
        );
        let stands = [(9, 9, 0.0, 0.0, 5), (8, 9, 0.5, 0.0, 5), (7, 9, 1.0, 0.0, 5)];
        assert_eq!(refused(&stands), Some((2, Fault::Hung(1500))));
    }

    #[test]
    fn sonars_that_say_the_same_where_they_must_not_are_old() {
        let driven = |ahead, left| [0.0, 0.6, 1.2, 1.8].map(|x| (ahead, left, x, 0.0, (x * 10.0) as u32));
        assert_eq!(refused(&driven(70, NOTHING)), Some((2, Fault::Frozen)));
        // The range of a wall beside the robot does not change, and neither does a range without an echo.
        assert_eq!(refused(&driven(NOTHING, 70)), None);
        let turned =
            |left| [0.0, 50.0, 170.0, -170.0, 0.0].map(|degrees| (NOTHING, left, 0.0, degrees, degrees as u32));
        assert_eq!(refused(&turned(70)), Some((2, Fault::Frozen)));
        assert_eq!(refused(&turned(NOTHING)), None);
        // The robot is at rest.
        assert_eq!(refused(&[0, 1, 2, 3].map(|clock| (70, 70, 0.0, 0.0, clock))), None);
    }

    #[test]
    fn one_reading_that_changes_shows_that_all_are_new() {
        let driven =
            [0, 6, 12, 18, 24].map(|tenths| (70, 70 + tenths / 10, f64::from(tenths) / 10.0, 0.0, tenths.into()));
        assert_eq!(refused(&driven), None);
    }
}
