//! Computes the turn to a heading, for the laws `rotate` and `turn`: `u_θ = k(α − θ)` (paper, section IV-A).

use mdle_runtime::capability::{DiffDrive, Odometry};
use mdle_runtime::{Nanos, Radians, RadiansPerSecond, Twist};

/// Maximum turn rate, in rad/s.
const FASTEST: f64 = 0.8;
/// Maximum fraction of the remaining angle that one input may cover before the law runs again. With a larger fraction,
/// the robot would overshoot.
const AT_ONCE: f64 = 0.5;
/// Tolerance of the final heading.
const NEAR: Radians = Radians::from_degrees(2.0);
/// Difference of the wheels' speeds, in m/s, below which the robot is treated as no longer turning.
const AT_REST: f64 = 0.02;

/// Returns the input that turns on the spot by the remaining angle `left` with the gain `gain`, which is the `k` of the
/// formula. `before` is the time of the law's previous input; `None` for the first input.
pub(crate) fn turning(left: Radians, gain: f64, before: Option<Nanos>, t: Nanos) -> Twist {
    let period = before.map_or(0.0, |before| t.since(before).seconds());
    let gain = if gain * period > AT_ONCE { AT_ONCE / period } else { gain };
    Twist { omega: RadiansPerSecond((gain * left.0).clamp(-FASTEST, FASTEST)), ..Twist::default() }
}

/// Returns `true` if the remaining angle `left` is within the tolerance and the robot is at rest.
pub(crate) fn turned<Y: DiffDrive + Odometry>(left: Radians, y: &Y) -> bool {
    let wheels_differ = y.velocity().omega.0 * y.wheel_base().0;
    left.0.abs() <= NEAR.0 && wheels_differ.abs() < AT_REST
}
