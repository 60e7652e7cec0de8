//! The state of a Scout: 42 bytes in a fixed order, with which the robot answers almost every command. See
//! docs/src/reference/protocols.md, 1.4.

use mdle_runtime::Volts;

use crate::number;

/// Length of the state, in bytes.
pub(crate) const LENGTH: usize = 42;

/// Full scale of the processor's supply voltage, in volts.
const CPU_RANGE: f64 = 12.0;
/// Full scale of the motors' supply voltage, in volts.
const MOTOR_RANGE: f64 = 12.85;

/// State of a Scout, in the units of the protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// Last range of each sonar, in inches; 255 if the sonar received no echo.
    pub sonars: [u8; 16],
    /// Bumper switches in contact: bit `i` for switch `i`.
    pub bumper: u32,
    /// Distance ahead of the position that was set to zero, in tenths of an inch; wraps at 83 m.
    pub x: i16,
    /// Distance to the left of the position that was set to zero, in tenths of an inch; wraps at 83 m.
    pub y: i16,
    /// Heading, in tenths of a degree, counter-clockwise.
    pub heading: i16,
    /// Speed of the right wheel, in tenths of an inch per second.
    pub right: i16,
    /// Speed of the left wheel, in tenths of an inch per second.
    pub left: i16,
    /// Status bits for motors, battery, charger and emergency stop.
    pub status: u8,
    /// Time by the controller's clock, in milliseconds.
    pub clock: u32,
    /// Supply voltage of the robot's computer, as a raw measurement.
    pub cpu: u8,
    /// Supply voltage of the robot's motors, as a raw measurement.
    pub motor: u8,
}

impl State {
    /// Decodes the state from the arguments of an answer; `None` if there are too few bytes.
    #[must_use]
    pub fn read(arguments: &[u8]) -> Option<Self> {
        let body: &[u8; LENGTH] = arguments.get(..LENGTH)?.try_into().ok()?;
        let [sonars @ .., _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _, _] = body;
        let [
            ..,
            b0,
            b1,
            b2,
            x0,
            x1,
            y0,
            y1,
            h0,
            h1,
            _turret0,
            _turret1,
            r0,
            r1,
            l0,
            l1,
            _spin0,
            _spin1,
            _compass0,
            _compass1,
            status,
            t0,
            t1,
            t2,
            t3,
            cpu,
            motor,
        ] = *body;
        Some(Self {
            sonars: *sonars,
            bumper: u32::from_le_bytes([b0, b1, b2, 0]),
            x: number::read([x0, x1]),
            y: number::read([y0, y1]),
            heading: number::read([h0, h1]),
            right: number::read([r0, r1]),
            left: number::read([l0, l1]),
            status,
            clock: u32::from_le_bytes([t0, t1, t2, t3]),
            cpu,
            motor,
        })
    }

    /// Returns `true` if the emergency stop is pressed, so that no command moves the robot.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        self.status & 0b0100_0000 != 0
    }

    /// Returns `true` if the charger is plugged in or charging.
    #[must_use]
    pub const fn is_plugged(&self) -> bool {
        self.status & 0b0011_0000 != 0
    }

    /// Returns the supply voltages of the robot's computer and motors. Each voltage is limited to the scale of its
    /// measurement.
    #[must_use]
    pub fn volts(&self) -> [Volts; 2] {
        let volts = |raw: u8, range: f64| Volts((2.0 + f64::from(raw) * (3.0 / 255.0)) * (range / 5.0));
        [volts(self.cpu, CPU_RANGE), volts(self.motor, MOTOR_RANGE)]
    }
}
