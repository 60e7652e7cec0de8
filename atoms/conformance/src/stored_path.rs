//! The path that every robot is given before its first exchange.

use mdle_runtime::{MetersPerSecond, Nanos, PathStore, Radians, Setpoint, StoredPath};

/// The path that every robot is given: 1 s straight ahead, a quarter of a circle to the left in 2 s, and 1 s straight
/// ahead.
pub(super) static STORED: PathStore = PathStore::new(&[StoredPath { name: NAME, setpoints: &BEND }]);
/// Name of the path.
pub(super) const NAME: &str = "bend.csv";
/// Setpoints of the path.
pub(super) static BEND: [Setpoint; 4] =
    [setpoint(0, 0.0, SPEED), setpoint(1, 0.0, SPEED), setpoint(3, 90.0, SPEED), setpoint(4, 90.0, SPEED)];
/// Speed along the path, in metres per second.
pub(super) const SPEED: f64 = 0.2;

const fn setpoint(seconds: u64, degrees: f64, speed: f64) -> Setpoint {
    let at = Nanos(seconds * 1_000_000_000);
    Setpoint { at, heading: Radians::from_degrees(degrees), speed: MetersPerSecond(speed) }
}
