//! Format of the file in which `desk` records what a robot senses, for `board`: the shape of the robot's body, and then
//! each turn, followed by its new pings. Numbers are little-endian, in SI units.

use mdle_runtime::capability::Steering;
use mdle_runtime::{
    Meters, MetersPerSecond, Mount, Nanos, Pose, Radians, RadiansPerSecond, Sensed, Shape, SonarId, Supply, Twist,
    Volts,
};

/// Reader of the numbers of a record, in order.
struct Numbers<'r>(&'r [u8]);

impl Numbers<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.0.split_first_chunk() {
            Some((bytes, rest)) => {
                self.0 = rest;
                *bytes
            }
            None => [0; N],
        }
    }

    fn whole(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn real(&mut self) -> f64 {
        f64::from_bits(self.whole())
    }

    fn pose(&mut self) -> Pose {
        Pose { x: Meters(self.real()), y: Meters(self.real()), theta: Radians(self.real()) }
    }
}

/// Size of the record of a body, in bytes.
pub const BEGIN: usize = 56;
/// Size of the record of a turn without its pings, in bytes.
pub const TURN: usize = 80;
/// Size of the record of a ping, in bytes.
pub const PING: usize = 56;

/// The record of a body's shape.
pub type Begin = [u8; BEGIN];
/// The record of a turn: time, pose, velocity, switches, power supply, and number of pings.
pub type Turn = [u8; TURN];
/// The record of a ping: sonar, range (NaN without an echo), time, pose, and mount of the sonar.
pub type Ping = [u8; PING];

/// Returns the shape of a body.
#[must_use]
pub fn shape(record: &Begin) -> Shape {
    let mut numbers = Numbers(record);
    let mut metres = || Meters(numbers.real());
    let (body_radius, half_length, half_width, wheel_base) = (metres(), metres(), metres(), metres());
    let (ring_radius, apart) = (metres(), metres());
    Shape {
        body_radius,
        half_length,
        half_width,
        wheel_base,
        sonars_apart: Some(apart).filter(|apart| apart.0 >= 0.0),
        ring_radius,
        confirmation: numbers.whole() as usize,
        steering: Steering::USUAL,
    }
}

/// Stores a turn in `y`; returns the time of the turn, and the number of pings that follow.
pub fn turn(record: &Turn, y: &mut Sensed) -> (Nanos, u64) {
    let mut numbers = Numbers(record);
    y.at = Nanos(numbers.whole());
    y.odometry = numbers.pose();
    y.velocity = Twist { v: MetersPerSecond(numbers.real()), omega: RadiansPerSecond(numbers.real()) };
    y.switches = numbers.whole() as u32;
    y.supply.battery = Volts(numbers.real());
    let flags = numbers.whole();
    y.supply = Supply { is_low: flags & 1 != 0, is_plugged: flags & 2 != 0, ..y.supply };
    (y.at, numbers.whole())
}

/// Stores a ping in `y`.
pub fn ping(record: &Ping, y: &mut Sensed) {
    let mut numbers = Numbers(record);
    let sonar = SonarId::new(numbers.whole() as u8);
    let range = numbers.real();
    let (at, pose) = (Nanos(numbers.whole()), numbers.pose());
    let mount = Mount { left: f32::from_le_bytes(numbers.take()), turned: f32::from_le_bytes(numbers.take()) };
    let ping = mdle_runtime::Ping { range: (!range.is_nan()).then_some(Meters(range)), at, pose, mount };
    if let Some(pings) = y.pings.get_mut(sonar.number()) {
        pings.push(ping);
    }
}

/// Updates the compass of `y` with all pings of a turn. Called once all of them have been read.
pub fn hear(y: &mut Sensed) {
    let Sensed { compass, pings, odometry, shape, .. } = y;
    compass.take(pings, *odometry, shape);
}
