//! A Super Scout in a simulated world: executes requests, and answers with its state.

use std::time::Duration;

use mdle_emulator::{Ailment, Embodied, Emulated, MotionOrder, OrderLog};
use mdle_runtime::capability::{Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, Pose, RadiansPerSecond, Robot as _, SonarId, Twist, Volts};
use mdle_simulator::{Footprint, Output, Simulated};

use crate::wire::{Incoming, Request, answer, number, two_bytes};

/// Metres in an inch.
const INCH: f64 = 0.0254;
/// Distance, in inches, that a wheel moves for each degree of a turn on the spot.
const INCHES_A_DEGREE: f64 = 0.118_597;
/// Deceleration of a robot whose motors have no current, in tenths of an inch per second squared; it corresponds to 0.3
/// m/s².
const ROLLING: f64 = 120.0;
/// Raw values of both supply voltages in a report, if both are 10.5 V.
const LOW: [u8; 2] = [202, 177];
/// Distance between consecutive positions that a robot with the fault `leap` reports, in tenths of an inch; it
/// corresponds to 3 m.
const LEAP: i64 = 1181;
/// Type of the answer to an unknown command.
const REFUSED: u8 = 8;

/// An emulated Scout.
#[allow(missing_debug_implementations, reason = "its body has none")]
pub struct Scout {
    body: Simulated,
    sensed: Output,
    incoming: Incoming,
    /// Last request that has not been answered, and `true` if the robot knows its command.
    asked: Option<(Request, bool)>,
    /// Commanded speeds of the wheels, in tenths of an inch per second.
    wheels: (i32, i32),
    /// `true` while the motors have no current, so that the robot rolls until friction stops it.
    limp: bool,
    /// Pose at which the reported position and heading are zero.
    zero: Pose,
    /// Sonars that ping: bit `i` for sonar `i`.
    active: u16,
    /// Last range of each sonar, as reported.
    heard: [u8; 16],
    /// Time without a request after which the robot stops itself; `None` if the watchdog is off.
    watchdog: Option<Duration>,
    silence: Duration,
    /// Time since the robot was switched on.
    age: Duration,
    /// `true` while the emergency stop is pressed.
    pub emergency: bool,
    /// `true` while the right wheel is stuck. The next fields are further faults of the body: the front sonar is dead,
    /// the first bumper is pressed, the battery is low, the charger is plugged in, and the sonars do not ping.
    is_stuck: bool,
    is_deaf: bool,
    is_pressed: bool,
    is_low: bool,
    is_plugged: bool,
    is_mute: bool,
    /// State that a robot with the fault `hang` repeats; `None` if the robot does not have this fault.
    hung: Option<Vec<u8>>,
    is_cut_off: bool,
    /// Wheel speeds that the robot keeps while it ignores all commands; `None` if it obeys commands.
    runaway: Option<(i32, i32)>,
    /// Offset that is added to the reported positions, in tenths of an inch.
    off: i64,
    /// `true` while this offset grows.
    leaps: bool,
    orders: OrderLog,
}

impl Scout {
    /// Creates a robot that has just been switched on.
    ///
    /// # Errors
    /// Fails if `body` rejects the null input, which it never does.
    pub fn new(mut body: Simulated) -> Result<Self, String> {
        let sensed = body.exchange(&Twist::default()).map_err(|error| error.to_string())?;
        let zero = sensed.pose();
        let mut scout = Self {
            body,
            sensed,
            wheels: (0, 0),
            limp: true,
            zero,
            incoming: Incoming::default(),
            asked: None,
            active: u16::MAX,
            heard: [255; 16],
            watchdog: None,
            silence: Duration::ZERO,
            age: Duration::ZERO,
            emergency: false,
            is_stuck: false,
            is_deaf: false,
            is_pressed: false,
            is_low: false,
            is_plugged: false,
            is_mute: false,
            hung: None,
            is_cut_off: false,
            runaway: None,
            off: 0,
            leaps: false,
            orders: OrderLog::default(),
        };
        scout.listen();
        Ok(scout)
    }

    /// Returns the robot's true pose in the world.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.body.pose()
    }

    /// Returns the motion commands that the robot has received.
    #[must_use]
    pub fn orders(&self) -> &OrderLog {
        &self.orders
    }

    /// Returns `true` if the wheels are at rest.
    #[must_use]
    pub fn stands(&self) -> bool {
        self.rolling() == (0, 0)
    }

    /// Records `request` as an order if it is a motion command.
    fn note(&mut self, request: &Request) {
        let order = match (request.command, &*request.data) {
            (5, [r0, r1, l0, l1, ..]) if (number(*r0, *r1), number(*l0, *l1)) != (0, 0) => MotionOrder::Drive,
            (5 | 9, _) => MotionOrder::Stand,
            (10, _) => MotionOrder::LetGo,
            _ => return,
        };
        self.orders.push(self.age, order);
    }

    /// Stores the latest echoes of the sonars that have pinged.
    fn listen(&mut self) {
        if self.is_mute {
            return;
        }
        for (sonar, heard) in (0..).zip(&mut self.heard) {
            let newest = self.sensed.pings(SonarId::new(sonar)).newest_first().next();
            if self.active & (1 << sonar) != 0
                && let Some(ping) = newest
            {
                *heard = ping.range.map_or(255, |range| (range.0 / INCH + 0.5).clamp(0.0, 255.0) as u8);
            }
        }
        if let Some(heard) = self.heard.first_mut().filter(|_| self.is_deaf) {
            *heard = 255;
        }
    }

    /// Executes a request, and returns `true` if the robot knows the command.
    fn does(&mut self, request: &Request) -> bool {
        self.silence = Duration::ZERO;
        match (request.command, &*request.data) {
            (1 | 2 | 7, _) => {}
            (5, [r0, r1, l0, l1, ..]) => (self.wheels, self.limp) = ((number(*r0, *r1), number(*l0, *l1)), false),
            (9, _) => (self.wheels, self.limp) = ((0, 0), false),
            (10, _) => (self.wheels, self.limp) = (self.rolling(), true),
            (12, [0, 0, 0, 0]) => self.zero = Pose { theta: self.zero.theta, ..self.sensed.pose() },
            (13, _) => self.zero = self.sensed.pose(),
            (15, [_, order @ ..]) => {
                let order = order.iter().take_while(|sonar| **sonar < 16);
                self.active = order.fold(0, |active, sonar| active | 1 << sonar);
            }
            (18, [seconds]) => {
                self.watchdog = (*seconds > 0).then(|| Duration::from_secs(u64::from(*seconds)));
            }
            _ => return false,
        }
        true
    }

    /// Returns the current speeds of the right and the left wheel, in tenths of an inch per second.
    fn rolling(&self) -> (i32, i32) {
        let velocity = self.sensed.velocity();
        let spin = velocity.omega.0.to_degrees() * INCHES_A_DEGREE * INCH;
        let tenths = |speed: f64| (speed / INCH * 10.0).round() as i32;
        (tenths(velocity.v.0 + spin), tenths(velocity.v.0 - spin))
    }

    /// Returns the bytes of the state in the form in which an answer contains them.
    fn state(&self) -> Vec<u8> {
        let pose = self.sensed.pose();
        let (x, y) = (pose.x.0 - self.zero.x.0, pose.y.0 - self.zero.y.0);
        let (sin, cos) = libm::sincos(self.zero.theta.0);
        let tenths = |meters: f64| (meters / INCH * 10.0).round() as i64;
        let heading = (pose.theta.0 - self.zero.theta.0).to_degrees().rem_euclid(360.0);
        let is_low = self.is_low || self.sensed.supply.is_low;
        let charge = if is_low { 0 } else { 0b1000 }
            | if self.is_plugged || self.sensed.supply.is_plugged { 0b0011_0000 } else { 0 };
        let moving = |wheel: i32, bit: u8| if wheel == 0 { 0 } else { bit };
        let (right, left) = self.rolling();
        let status = moving(left, 1) | moving(right, 2) | charge | if self.emergency { 0b0100_0000 } else { 0 };
        let switches = self.sensed.switches | u32::from(self.is_pressed);
        [
            &self.heard[..],
            &[switches as u8, (switches >> 8) as u8, (switches >> 16) as u8],
            &two_bytes(tenths(x * cos + y * sin) + self.off),
            &two_bytes(tenths(y * cos - x * sin)),
            &two_bytes((heading * 10.0).round() as i64 % 3600),
            &[0, 0],
            &two_bytes(i64::from(right)),
            &two_bytes(i64::from(left)),
            &[0, 0, 0, 0, status],
            &(self.age.as_millis() as u32).to_le_bytes(),
            &if self.is_low { LOW } else { volts(self.sensed.supply.battery) },
        ]
        .concat()
    }
}

/// Converts a battery voltage to the bytes that a report contains for both supplies. A byte is 0 at two fifths of a
/// supply's full scale, and 255 at full scale.
fn volts(battery: Volts) -> [u8; 2] {
    [12.0, 12.85].map(|range| ((battery.0 * 5.0 / range - 2.0) * (255.0 / 3.0)).round().clamp(0.0, 255.0) as u8)
}

impl Embodied for Scout {
    fn footprint(&self) -> Footprint {
        self.body.footprint()
    }

    fn see(&mut self, others: &[Footprint]) {
        self.body.see(others);
    }
}

impl Emulated for Scout {
    fn push(&mut self, bytes: &[u8]) {
        self.incoming.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        let request = self.incoming.next_request()?;
        if self.is_cut_off {
            return Some(true);
        }
        self.note(&request);
        let is_known = self.does(&request);
        self.asked = Some((request, is_known));
        Some(true)
    }

    fn pass(&mut self, period: Duration) -> Result<(), String> {
        self.age += period;
        self.silence += period;
        if self.watchdog.is_some_and(|limit| self.silence >= limit) {
            (self.wheels, self.limp) = ((0, 0), false);
        }
        if self.limp {
            let less = |wheel: i32| wheel - wheel.signum() * wheel.abs().min((ROLLING * period.as_secs_f64()) as i32);
            self.wheels = (less(self.wheels.0), less(self.wheels.1));
        }
        let (right, left) = if self.emergency { (0, 0) } else { self.runaway.unwrap_or(self.wheels) };
        let right = if self.is_stuck { 0 } else { right };
        // The body truncates speeds to tenths of an inch: a hundredth of a unit more preserves the commanded values.
        let inches = |wheel: i32| (f64::from(wheel) + 0.01 * f64::from(wheel.signum())) / 10.0;
        let (right, left) = (inches(right), inches(left));
        let degrees = (right - left) / 2.0 / INCHES_A_DEGREE;
        let input =
            Twist { v: MetersPerSecond((right + left) / 2.0 * INCH), omega: RadiansPerSecond(degrees.to_radians()) };
        self.sensed = self.body.exchange(&input).map_err(|error| error.to_string())?;
        self.listen();
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        match self.asked.take() {
            Some((request, true)) => {
                self.off += if self.leaps { LEAP } else { 0 };
                let state = self.hung.clone().unwrap_or_else(|| self.state());
                vec![answer(request.command, &state)]
            }
            Some((_, false)) => vec![answer(REFUSED, &[])],
            None => Vec::new(),
        }
    }

    fn can_suffer(ailment: Ailment) -> bool {
        match ailment {
            // Every byte on the Scout's line has a meaning, and all data are in one frame.
            Ailment::Filler | Ailment::NoBumpers | Ailment::NoTranslation | Ailment::NoRotation | Ailment::NoStatus => {
                false
            }
            Ailment::Deaf
            | Ailment::Runaway
            | Ailment::StuckWheel
            | Ailment::DeadSonar
            | Ailment::Bumper
            | Ailment::Emergency
            | Ailment::LowBattery
            | Ailment::PluggedIn
            | Ailment::Hang
            | Ailment::NoPings
            | Ailment::Leap => true,
        }
    }

    fn suffer(&mut self, ailment: Ailment) {
        match ailment {
            Ailment::StuckWheel => self.is_stuck = true,
            Ailment::DeadSonar => self.is_deaf = true,
            Ailment::Bumper => self.is_pressed = true,
            Ailment::Emergency => self.emergency = true,
            Ailment::LowBattery => self.is_low = true,
            Ailment::PluggedIn => self.is_plugged = true,
            Ailment::Hang => self.hung = Some(self.state()),
            Ailment::NoPings => self.is_mute = true,
            Ailment::Deaf => self.is_cut_off = true,
            Ailment::Runaway => self.runaway = Some(self.wheels),
            Ailment::Leap => self.leaps = true,
            Ailment::Filler | Ailment::NoBumpers | Ailment::NoTranslation | Ailment::NoRotation | Ailment::NoStatus => {
            }
        }
        self.listen();
    }
}
