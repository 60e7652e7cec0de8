//! Converts speeds between m/s or rad/s and the controller's units, and computes odometry from the positions of the
//! axes. See docs/src/reference/protocols.md, 2.5.

use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, Twist};

use crate::command::{Axis, AxisMotion, Command};
use crate::config::Config;

/// Maximum distance between two reported positions, in metres; a larger distance is rejected as a leap.
const LEAP: f64 = 1.0;
/// Maximum difference between the number of leaps and the number of normal steps. If the difference is larger, the
/// positions are unusable.
const LEAPS: u8 = 4;

/// Returns the commands for `input`; the translation comes first. If a side would exceed its maximum speed, both speeds
/// are reduced by the same factor, so that the robot stays on its curve. An input that is not a number stops the robot.
pub(crate) fn commands(input: &Twist, config: &Config) -> [Command; 2] {
    let side = input.v.0.abs() + input.omega.0.abs() * (config.wheel_base / 2.0);
    let scale = if side.is_finite() { (config.fastest / side).min(1.0) } else { 0.0 };
    let units = |speed: f64, per: f64| if scale > 0.0 { libm::trunc(speed * scale * per) as i32 } else { 0 };
    let along = match units(input.v.0, config.units_per_metre) {
        // Some controllers keep the previous speed when they receive a speed of 0.
        0 if config.zero_as_one => 1,
        along => along,
    };
    let translation = AxisMotion {
        velocity: along,
        acceleration: libm::trunc(config.acceleration * config.units_per_metre) as u32,
        torque: config.translation_torque,
    };
    let rotation = AxisMotion {
        velocity: units(input.omega.0, config.units_per_radian),
        acceleration: config.rotation_acceleration,
        torque: config.rotation_torque,
    };
    [Command::Move(Axis::Translation, translation), Command::Move(Axis::Rotation, rotation)]
}

/// Odometry of the robot, computed from the positions of its axes. The origin is the position in the first report.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Odometer {
    last: Option<(i32, i32)>,
    pub(crate) pose: Pose,
    leaps: u8,
}

impl Odometer {
    /// Updates the pose with the current positions of the axes, which wrap at 32 bits.
    pub(crate) fn take(&mut self, along: i32, round: i32, config: &Config) {
        let (was_along, was_round) = self.last.replace((along, round)).unwrap_or((along, round));
        let way = f64::from(along.wrapping_sub(was_along)) / config.units_per_metre;
        let turn = f64::from(round.wrapping_sub(was_round)) / config.units_per_radian;
        if way.abs() <= LEAP && turn.abs() <= std::f64::consts::PI {
            self.pose = self.pose.moved(Meters(way), Radians(turn));
            self.leaps = self.leaps.saturating_sub(1);
        } else {
            self.leaps = self.leaps.saturating_add(1);
        }
    }

    /// Returns `true` if the positions leap so often that they are unusable.
    pub(crate) fn leaps(&self) -> bool {
        self.leaps > LEAPS
    }
}

/// Returns the speeds of the robot's right and left side for `motion`, in m/s.
pub(crate) fn sides(motion: &Twist, config: &Config) -> [f64; 2] {
    let across = motion.omega.0 * (config.wheel_base / 2.0);
    [motion.v.0 + across, motion.v.0 - across]
}

/// Returns the speeds of the right and left side that `commands` request, in m/s.
pub(crate) fn asked(commands: &[Command; 2], config: &Config) -> [f64; 2] {
    let velocity = |command: &Command| if let Command::Move(_, motion) = command { motion.velocity } else { 0 };
    let [along, round] = commands;
    sides(&twist(velocity(along), velocity(round), config), config)
}

/// Returns two decelerations of the sides, in m/s²: the first while both sides move in the same direction, and the
/// second while they move in opposite directions.
pub(crate) fn brakes(config: &Config) -> [f64; 2] {
    let turning = f64::from(config.rotation_acceleration) / config.units_per_radian;
    [config.acceleration, turning * (config.wheel_base / 2.0)]
}

/// Returns the motion of a robot whose axes have these velocities.
pub(crate) fn twist(along: i32, round: i32, config: &Config) -> Twist {
    Twist {
        v: MetersPerSecond(f64::from(along) / config.units_per_metre),
        omega: RadiansPerSecond(f64::from(round) / config.units_per_radian),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use crate::config::Configured;

    fn config() -> Config {
        Configured::read(None, None).unwrap().config
    }

    fn velocities(v: f64, omega: f64, config: &Config) -> [i32; 2] {
        let input = Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) };
        commands(&input, config).map(|command| {
            let Command::Move(_, motion) = command else { panic!("{command:?}") };
            motion.velocity
        })
    }

    #[test]
    fn speeds_are_in_units_and_a_zero_is_one() {
        let config = config();
        assert_eq!(velocities(0.2, 0.0, &config), [27_930, 0]);
        assert_eq!(velocities(-0.2, 0.36, &config), [-27_930, 17_922]);
        assert_eq!(velocities(0.0, -0.36, &config), [1, -17_922]);
        assert_eq!(velocities(0.0, 0.0, &Config { zero_as_one: false, ..config }), [0, 0]);
    }

    #[test]
    fn what_is_too_fast_stays_on_its_curve() {
        let config = config();
        let [along, round] = velocities(2.0, 4.0, &config);
        let (v, omega) = (f64::from(along) / config.units_per_metre, f64::from(round) / config.units_per_radian);
        assert!((v + 0.2 * omega - 1.2).abs() < 1e-4 && (omega / v - 2.0).abs() < 1e-3, "{v} {omega}");
        for (v, omega) in [(f64::NAN, 0.0), (0.0, f64::INFINITY), (f64::NEG_INFINITY, 1.0)] {
            assert_eq!(velocities(v, omega, &config), [1, 0]);
        }
    }

    #[test]
    fn the_way_begins_at_the_first_report_and_goes_on_where_numbers_end() {
        let config = Config { units_per_metre: 1000.0, units_per_radian: 1000.0, ..config() };
        let mut odometer = Odometer::default();
        let mut at = |along: i32, round: i32| {
            odometer.take(along, round, &config);
            let Pose { x, y, theta } = odometer.pose;
            [x.0, y.0, theta.0].map(|number| libm::round(number * 1000.0) as i32)
        };
        assert_eq!(at(i32::MAX - 200, i32::MIN + 100), [0, 0, 0]);
        assert_eq!(at(i32::MAX, i32::MIN + 100), [200, 0, 0]);
        assert_eq!(at(i32::MIN + 299, i32::MIN + 100), [500, 0, 0]);
        // A quarter turn on the spot, during which the position wraps, then half a metre ahead.
        assert_eq!(at(i32::MIN + 299, i32::MAX - 1470), [500, 0, -1571]);
        assert_eq!(at(i32::MIN + 799, i32::MAX - 1470), [500, -500, -1571]);
        // A leap does not change the pose; later positions count from the position after the leap.
        assert_eq!(at(9000, 0), [500, -500, -1571]);
        assert_eq!(at(9100, 0), [500, -600, -1571]);
    }

    #[test]
    fn leaps_again_and_again_mean_nothing() {
        let config = Config { units_per_metre: 1000.0, ..config() };
        // The first `leaps` reports are each 3 m from the previous one, the others 1 mm.
        let leaps = |leaps: i32, steps: i32| {
            let mut odometer = Odometer::default();
            let positions = (0..=leaps).map(|leap| leap * 3000).chain((1..=steps).map(|step| leaps * 3000 + step));
            positions.for_each(|position| odometer.take(position, 0, &config));
            odometer.leaps()
        };
        assert_eq!([leaps(4, 0), leaps(5, 0), leaps(5, 1), leaps(7, 2)], [false, true, false, true]);
    }
}
