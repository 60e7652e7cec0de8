//! Detects a robot that does not move as commanded, but faster or in the opposite direction. See
//! docs/src/reference/protocols.md, 3.
//!
//! A robot that moves less than commanded, because an obstacle blocks it or one of its sides is stuck, does not
//! disobey. The measured speeds of both sides must stay within a band, which the previous commands determine. The band
//! always contains zero and the last two commands. After an earlier command, it narrows only as fast as the robot
//! brakes.

use std::time::Duration;

use mdle_runtime::Nanos;

/// Fraction of the commanded deceleration that a robot must achieve.
const PART: f64 = 0.5;
/// Tolerated distance, in m/s, of a side's speed from the band.
const ERROR: f64 = 0.05;
/// Tolerated distance of a side's speed from the band, as a fraction of the highest speed in the band.
const ERROR_PART: f64 = 0.2;
/// Maximum time that a robot may need to stop.
const LONGEST: Duration = Duration::from_secs(5);
/// Maximum time until a robot begins to brake.
const REACTION: Duration = Duration::from_millis(100);

/// Compares the measured speeds with the commands, turn by turn.
#[derive(Debug, Clone)]
pub struct Obedience {
    /// Maximum time for which the speeds may be outside the band; zero for no limit.
    limit: Nanos,
    /// Band of the common speed of both sides.
    forward: Band,
    /// Band of half the difference between the speeds of both sides.
    turning: Band,
    last: Option<Nanos>,
    /// Speed of the faster side at the last measurement, in m/s.
    measured: f64,
    /// Time at which the speeds left the band; `None` while they are within the band.
    since: Option<Nanos>,
}

/// Range of speeds that the commands allow, in m/s.
#[derive(Debug, Clone, Copy)]
struct Band {
    /// Lower end of the band, at most zero.
    low: f64,
    /// Upper end of the band, at least zero.
    high: f64,
    /// Last commanded speed, in m/s.
    command: f64,
    /// Rate at which the band narrows, in m/s².
    brakes: f64,
}

impl Obedience {
    /// Creates the state of a robot at rest. Its sides brake with `forward` m/s² when they move in the same direction,
    /// and with `turning` m/s² when they move in opposite directions. The robot may disobey for less than the time
    /// `limit`; zero means no limit.
    #[must_use]
    pub const fn new(forward: f64, turning: f64, limit: Duration) -> Self {
        Self {
            limit: Nanos(limit.as_millis() as u64 * 1_000_000),
            forward: Band::new(forward * PART),
            turning: Band::new(turning * PART),
            last: None,
            measured: 0.0,
            since: None,
        }
    }

    /// Records the measured speeds of the right and the left side at the time `at`, in m/s, and the command of this
    /// turn. Returns `true` if the robot has disobeyed for the whole time limit.
    pub fn is_broken(&mut self, at: Nanos, command: [f64; 2], measured: [f64; 2]) -> bool {
        let seconds = at.since(self.last.replace(at).unwrap_or(at)).seconds();
        let [right, left] = command;
        self.forward.tell((right + left) / 2.0, seconds);
        self.turning.tell((right - left) / 2.0, seconds);
        let [right, left] = measured;
        self.measured = right.abs().max(left.abs());
        let (forward, turning) = (self.forward, self.turning);
        let error = ERROR + ERROR_PART * (forward.fastest() + turning.fastest());
        let obeys = (forward.low + turning.low - error..=forward.high + turning.high + error).contains(&right)
            && (forward.low - turning.high - error..=forward.high - turning.low + error).contains(&left);
        let since = if obeys { None } else { Some(self.since.unwrap_or(at)) };
        self.since = since;
        self.limit > Nanos::ZERO && since.is_some_and(|since| at.since(since) >= self.limit)
    }

    /// Returns an upper bound on the time that the robot needs to stop: a reaction time of 100 ms plus twice the time
    /// to brake from the highest possible speed at the commanded deceleration. The result is at least `least` and at
    /// most five seconds.
    #[must_use]
    pub fn time_to_stand(&self, least: Duration) -> Duration {
        let time = |band: &Band| band.fastest().max(self.measured) / band.brakes;
        let seconds = time(&self.forward).max(if self.turning.fastest() > 0.0 { time(&self.turning) } else { 0.0 });
        // NaN becomes the longest time.
        let braking = Duration::try_from_secs_f64(seconds).unwrap_or(LONGEST);
        (braking + REACTION).clamp(least.min(LONGEST), LONGEST)
    }
}

impl Band {
    const fn new(brakes: f64) -> Self {
        Self { low: 0.0, high: 0.0, command: 0.0, brakes }
    }

    /// Narrows the band as far as the robot can brake in `seconds` seconds. The band still contains `command` and the
    /// previous command.
    fn tell(&mut self, command: f64, seconds: f64) {
        let before = std::mem::replace(&mut self.command, command);
        let by = self.brakes * seconds;
        self.high = (self.high - by).max(before).max(command).max(0.0);
        self.low = (self.low + by).min(before).min(command).min(0.0);
    }

    fn fastest(&self) -> f64 {
        self.high.max(-self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the turn, of 100 ms each, in which a robot that brakes with 1 m/s² is found to disobey for half a
    /// second.
    fn broken(turns: &[([f64; 2], [f64; 2])]) -> Option<usize> {
        let mut obedience = Obedience::new(1.0, 1.0, Duration::from_millis(500));
        turns.iter().enumerate().find_map(|(turn, (command, measured))| {
            obedience.is_broken(Nanos(turn as u64 * 100_000_000), *command, *measured).then_some(turn)
        })
    }

    const AHEAD: [f64; 2] = [0.2, 0.2];
    const NONE: [f64; 2] = [0.0, 0.0];

    #[test]
    fn a_robot_that_moves_less_obeys() {
        for held in [NONE, [0.0, 0.2], [0.2, 0.0], [0.1, 0.1], [0.24, -0.05]] {
            assert_eq!(broken(&[(AHEAD, held); 50]), None, "{held:?}");
        }
        // Against a wall, the wheels turn in opposite directions.
        assert_eq!(broken(&[([0.475, 0.025], [0.225, -0.225]); 50]), None);
    }

    #[test]
    fn a_robot_that_goes_on_disobeys() {
        let goes_on = |command| [[(AHEAD, AHEAD); 10], [(command, AHEAD); 10], [(command, AHEAD); 10]].concat();
        // From the third turn of braking on, the robot is too fast, and it is reported half a second later.
        for command in [NONE, [-0.2, -0.2], [0.1, 0.1]] {
            assert_eq!(broken(&goes_on(command)), Some(17), "{command:?}");
        }
        assert_eq!(broken(&goes_on([0.18, 0.18])), None);
        let spins = [[([0.2, -0.2], [-0.2, 0.2]); 10]].concat();
        assert_eq!(broken(&spins), Some(5));
    }

    #[test]
    fn a_robot_that_brakes_half_as_hard_obeys() {
        let braking = (0..40).map(|turn| (NONE, [0.5 - 0.05 * f64::from(turn); 2].map(|speed: f64| speed.max(0.0))));
        let turns: Vec<_> = [([0.5; 2], [0.5; 2]); 10].into_iter().chain(braking).collect();
        assert_eq!(broken(&turns), None);
        // A jerk that is shorter than the limit is tolerated.
        let jerk = [[(NONE, NONE); 5], [(NONE, AHEAD); 5], [(NONE, NONE); 5], [(NONE, AHEAD); 5]].concat();
        assert_eq!(broken(&jerk), None);
    }

    #[test]
    fn a_limit_of_zero_is_none() {
        let mut obedience = Obedience::new(1.0, 1.0, Duration::ZERO);
        assert!((0..100).all(|turn| !obedience.is_broken(Nanos(turn * 100_000_000), NONE, AHEAD)));
    }

    #[test]
    fn a_fast_robot_has_longer_to_stand() {
        let least = Duration::from_millis(600);
        let after = |command: [f64; 2], measured| {
            let mut obedience = Obedience::new(1.0, 1.0, Duration::ZERO);
            obedience.is_broken(Nanos::ZERO, command, measured);
            obedience.time_to_stand(least).as_millis()
        };
        assert_eq!([after(AHEAD, NONE), after([1.0; 2], NONE), after(NONE, [1.0; 2])], [600, 2100, 2100]);
        assert_eq!([after([1.0, -1.0], NONE), after([100.0; 2], NONE)], [2100, 5000]);
    }
}
