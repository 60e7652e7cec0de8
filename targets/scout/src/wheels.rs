//! Converts between the speeds of the robot and the speeds of its wheels, in the units of the protocol. See
//! docs/src/reference/protocols.md, 1.5.

use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Twist};

/// Metres in a tenth of an inch.
pub(crate) const UNIT: f64 = 0.00254;
/// Distance that a wheel moves for each degree of a turn on the spot, in inches. The value is the same for a tenth of a
/// degree, in tenths of an inch.
const ROTATION: f64 = 0.118597;
/// Distance between the wheels, in metres, derived from [`ROTATION`].
pub(crate) const WHEEL_BASE: f64 = 0.34519;

/// Returns the speeds of the right and the left wheel for `input`, limited to `fastest`, in m/s. Both speeds are
/// reduced by the same factor, so that the robot stays on its curve. An input that is not finite stops the robot.
pub(crate) fn speeds(input: &Twist, fastest: f64) -> (i16, i16) {
    let along = libm::trunc(input.v.0 / UNIT);
    // Turn rate in tenths of a degree per second.
    let turn = libm::trunc(libm::trunc(input.omega.0 * (1800.0 / std::f64::consts::PI)) * ROTATION);
    let (right, left) = (along + turn, along - turn);
    if !(right.is_finite() && left.is_finite()) {
        return (0, 0);
    }
    let limit = libm::trunc(fastest / UNIT);
    let scale = (limit / right.abs().max(left.abs())).min(1.0);
    let whole = |speed: f64| libm::trunc(speed * scale) as i16;
    (whole(right), whole(left))
}

/// Returns the motion of a robot whose wheels have these speeds.
pub(crate) fn twist(right: i16, left: i16) -> Twist {
    let (right, left) = (f64::from(right) * UNIT, f64::from(left) * UNIT);
    Twist { v: MetersPerSecond((right + left) / 2.0), omega: RadiansPerSecond((right - left) / WHEEL_BASE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(v: f64, omega: f64) -> (i16, i16) {
        speeds(&Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }, 1.0)
    }

    #[test]
    fn the_right_wheel_is_the_faster_one_in_a_left_turn() {
        assert_eq!([of(0.2, 0.0), of(-0.2, 0.0), of(0.0, 0.36)], [(78, 78), (-78, -78), (24, -24)]);
        assert_eq!(of(0.2, 0.36), (102, 54));
    }

    #[test]
    fn what_is_too_fast_stays_on_its_curve() {
        let (right, left) = of(2.0, 2.0);
        assert_eq!(right, 393);
        assert!((f64::from(left) / f64::from(right) - 652.0 / 922.0).abs() < 0.01, "{left}");
        assert_eq!([of(f64::NAN, 0.0), of(0.0, f64::INFINITY)], [(0, 0); 2]);
    }

    #[test]
    fn wheel_speeds_return_as_commanded() {
        let speeds = twist(24, -24);
        assert_eq!((speeds.v.0, libm::round(speeds.omega.0 * 100.0)), (0.0, 35.0));
        assert_eq!(libm::round(twist(78, 78).v.0 * 1000.0), 198.0);
    }
}
