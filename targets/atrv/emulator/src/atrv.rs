//! An ATRV-mini in a simulated world: executes commands, and sends reports as time passes.

mod reports;

use std::time::Duration;

use mdle_emulator::{Ailment, Embodied, Emulated, MotionOrder, OrderLog, Pace, STEP};
use mdle_runtime::{MetersPerSecond, Nanos, Pose, RadiansPerSecond, Robot as _, Twist};
use mdle_simulator::{Footprint, Output, Simulated};

use crate::wire::{Incoming, Request, number};
use reports::Schedule;

/// Number of the controller's units per metre.
const A_METRE: f64 = 139_654.7;
const A_RADIAN: f64 = 49_784.5;
/// Default time without a command after which the robot stops itself.
const FAILSAFE: Duration = Duration::from_secs(1);
/// Difference between the battery's voltage and the voltage that the controller reports, in volts.
const ABOVE: f64 = 1.82;
/// Two voltages, in hundredths of a volt, that the robot reports: for a low battery, and while it is on its charger.
/// The charger's voltage is higher than the voltage of any battery.
const LOW: u32 = 1850;
const PLUGGED: u32 = 2650;
/// Distance between the wheels of both sides, in metres, as in the model of the robot's body.
const BETWEEN: f64 = 0.4;

/// Returns the time step of the robot's body: the step of `pace`, divided into parts of at most [`STEP`].
#[must_use]
pub fn step(pace: Pace) -> Duration {
    let step = pace.step();
    step / step.as_nanos().div_ceil(STEP.as_nanos()).max(1) as u32
}

/// An emulated ATRV-mini.
#[allow(missing_debug_implementations, reason = "its body has none")]
pub struct Atrv {
    body: Simulated,
    step: Duration,
    sensed: Output,
    incoming: Incoming,
    /// Reports that have not been sent yet.
    outgoing: Vec<Vec<u8>>,
    /// Number of the last report; the robot counts its reports.
    count: u8,
    /// Commanded forward speed and turn rate, in the controller's units per second. They come from the last motion
    /// command.
    command: (i32, i32),
    last_command: (i32, i32),
    orders: OrderLog,
    /// Positions of both axes, in the controller's units.
    gone: (f64, f64),
    axes: Schedule,
    inputs: Schedule,
    /// Data of the last axis reports.
    axis_reports: Vec<Vec<u8>>,
    /// Time of the last reported ping of each sonar; `None` while the sonars are switched off.
    pings: Option<Vec<Nanos>>,
    is_braked: bool,
    silence: Duration,
    /// Time since the robot was switched on.
    age: Duration,
    /// `true` while the emergency stop is pressed.
    pub emergency: bool,
    /// Faults of the body that have begun.
    ailments: Vec<Ailment>,
    /// Time without a command after which the robot stops itself.
    pub failsafe: Duration,
}

impl Atrv {
    /// Creates a robot that has just been switched on and whose body's time advances in steps of `step`. `marks` is
    /// passed to [`Incoming::new`].
    ///
    /// # Errors
    /// Fails if `body` rejects the null input, which it never does.
    pub fn new(mut body: Simulated, step: Duration, marks: bool) -> Result<Self, String> {
        let sensed = body.exchange(&Twist::default()).map_err(|error| error.to_string())?;
        Ok(Self {
            body,
            step,
            sensed,
            incoming: Incoming::new(marks),
            outgoing: Vec::new(),
            count: 0,
            command: (0, 0),
            last_command: (0, 0),
            orders: OrderLog::default(),
            gone: (0.0, 0.0),
            axes: Schedule::default(),
            inputs: Schedule::default(),
            axis_reports: Vec::new(),
            pings: None,
            is_braked: true,
            silence: Duration::ZERO,
            age: Duration::ZERO,
            emergency: false,
            ailments: Vec::new(),
            failsafe: FAILSAFE,
        })
    }

    /// Returns the robot's true pose in the world.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.body.pose()
    }

    /// Returns the velocity that the robot measures.
    #[must_use]
    pub fn velocity(&self) -> Twist {
        self.sensed.velocity
    }

    /// Returns `true` if the brake or the emergency stop holds the robot.
    #[must_use]
    pub fn is_braked(&self) -> bool {
        self.is_braked || self.emergency
    }

    /// Returns the motion commands that the robot has received.
    #[must_use]
    pub fn orders(&self) -> &OrderLog {
        &self.orders
    }

    /// Executes a command. Returns `true` if the command sets a turn rate, which completes a motion command.
    fn does(&mut self, request: &Request) -> bool {
        if self.has(Ailment::Deaf) {
            return request.port == 2 && request.code == 7 && request.data.first() == Some(&1);
        }
        self.silence = Duration::ZERO;
        match (request.port, request.code, &*request.data) {
            (1, 1, _) if self.has(Ailment::NoStatus) => {}
            (1, 1, _) => {
                let brake = [u8::from(self.is_braked())];
                let battery = self.battery();
                let data = [&self.time()[..], &battery.to_be_bytes(), &brake].concat();
                self.send(1, 1, &data);
            }
            (2, 7, [axis, v0, v1, v2, v3, .., direction]) if request.data.len() == 14 => {
                let size = number(&[*v0, *v1, *v2, *v3]).min(i32::MAX as u32) as i32;
                let velocity = if *direction == 0 { -size } else { size };
                self.moves(*axis, velocity);
                return *axis == 1;
            }
            (2, 11, _) => {
                self.orders.push(self.age, MotionOrder::Brake);
                if !self.has(Ailment::Runaway) {
                    (self.command, self.is_braked) = ((0, 0), true);
                }
            }
            (2, 12, _) => self.is_braked = false,
            (2, 34, [p0, p1, p2, p3, _, _, _, axes]) => {
                let period = if *axes == 3 { number(&[*p0, *p1, *p2, *p3]) } else { 0 };
                self.axes = Schedule::new(period, self.age);
            }
            (4, 0, [.., mode]) => {
                let now = || self.body.heard().iter().map(|heard| heard.at).collect();
                self.pings = (*mode == 2).then(now);
            }
            (5, 0, period) => {
                self.inputs = Schedule::new(number(period), self.age);
                let done = [&[0; 4][..], &self.time()].concat();
                self.send(5, 0, &done);
            }
            _ => {}
        }
        false
    }

    /// Sets the commanded velocity of an axis. Setting the velocity of the rotation completes a motion command.
    fn moves(&mut self, axis: u8, velocity: i32) {
        match axis {
            0 => self.last_command.0 = velocity,
            _ => {
                self.last_command.1 = velocity;
                // Drivers send 1 unit in place of 0.
                let stands = self.last_command.0.abs() <= 1 && velocity == 0;
                self.orders.push(self.age, if stands { MotionOrder::Stand } else { MotionOrder::Drive });
            }
        }
        match axis {
            _ if self.has(Ailment::Runaway) => {}
            // As on the ATRV-Jr, a velocity of 0 does not change the commanded forward speed.
            0 if velocity == 0 => {}
            0 => self.command.0 = velocity,
            _ => self.command.1 = velocity,
        }
    }

    /// Advances the world by one step. `age` is the time, at the end of the step, since the robot was switched on.
    fn tick(&mut self, age: Duration) -> Result<(), String> {
        self.silence += age.saturating_sub(self.age);
        self.age = age;
        let fails_safe = self.silence >= self.failsafe && !self.has(Ailment::Runaway);
        if fails_safe || self.is_braked() {
            self.command = (0, 0);
        }
        // The body truncates speeds to whole units: one unit more preserves the commanded values.
        let exactly = |units: i32, one: f64| f64::from(units + units.signum()) / one;
        let input = Twist {
            v: MetersPerSecond(exactly(self.command.0, A_METRE)),
            omega: RadiansPerSecond(exactly(self.command.1, A_RADIAN)),
        };
        let input = if self.has(Ailment::StuckWheel) { left_alone(&input) } else { input };
        let before = self.sensed.odometry;
        self.sensed = self.body.exchange(&input).map_err(|error| error.to_string())?;
        self.goes(&before);
        self.report_pings();
        if self.inputs.is_due(age) {
            self.report_bumpers();
        }
        if self.axes.is_due(age) {
            self.report_axes();
        }
        Ok(())
    }

    /// Advances the positions of the axes by the motion that odometry has measured since the pose `before`.
    fn goes(&mut self, before: &Pose) {
        let after = &self.sensed.odometry;
        let turn = (after.theta.0 - before.theta.0 + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        let (sin, cos) = libm::sincos(before.theta.0 + turn / 2.0);
        let chord = (after.x.0 - before.x.0) * cos + (after.y.0 - before.y.0) * sin;
        let half = turn / 2.0;
        let way = if half.abs() < 1e-9 { chord } else { chord * half / libm::sin(half) };
        self.gone = (self.gone.0 + way * A_METRE, self.gone.1 + turn * A_RADIAN);
    }

    /// Returns the reported voltage of the battery, in hundredths of a volt. On the charger, the battery is never
    /// reported as low.
    fn battery(&self) -> u32 {
        let supply = self.body.supplied();
        if self.has(Ailment::PluggedIn) || supply.is_plugged {
            PLUGGED
        } else if self.has(Ailment::LowBattery) {
            LOW
        } else {
            ((supply.battery.0 - ABOVE) * 100.0).round().max(0.0) as u32
        }
    }

    fn has(&self, ailment: Ailment) -> bool {
        self.ailments.contains(&ailment)
    }
}

/// Returns the motion of a body whose right wheels do not move; `input` is the commanded motion.
fn left_alone(input: &Twist) -> Twist {
    let left = input.v.0 - input.omega.0 * (BETWEEN / 2.0);
    Twist { v: MetersPerSecond(left / 2.0), omega: RadiansPerSecond(-left / BETWEEN) }
}

impl Embodied for Atrv {
    fn footprint(&self) -> Footprint {
        self.body.footprint()
    }

    fn see(&mut self, others: &[Footprint]) {
        self.body.see(others);
    }
}

impl Emulated for Atrv {
    fn push(&mut self, bytes: &[u8]) {
        self.incoming.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        let request = self.incoming.next_request()?;
        Some(self.does(&request))
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        let begun = self.age;
        let steps = (time.as_nanos() / self.step.as_nanos().max(1)).max(1) as u32;
        (1..=steps).try_for_each(|step| self.tick(begun + time * step / steps))
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        std::mem::take(&mut self.outgoing)
    }

    fn can_suffer(_: Ailment) -> bool {
        true
    }

    fn suffer(&mut self, ailment: Ailment) {
        match ailment {
            Ailment::Emergency => self.emergency = true,
            Ailment::Deaf
            | Ailment::Runaway
            | Ailment::StuckWheel
            | Ailment::DeadSonar
            | Ailment::Bumper
            | Ailment::LowBattery
            | Ailment::PluggedIn
            | Ailment::Filler
            | Ailment::Hang
            | Ailment::NoPings
            | Ailment::NoBumpers
            | Ailment::NoTranslation
            | Ailment::NoRotation
            | Ailment::NoStatus
            | Ailment::Leap => self.ailments.push(ailment),
        }
    }
}
