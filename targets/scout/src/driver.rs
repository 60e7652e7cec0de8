//! The driver of a Scout, as a kinetic state machine (paper, Eq. 1). Each input is sent as a velocity command; the
//! output comes from the answer to this command.

use std::time::{Duration, Instant};

use mdle_host::{RobotSettings, StopRequest, sonar_order};
use mdle_runtime::{Compass, Meters, Nanos, PathStore, Published, Robot, Sensed, Shape, Supply, Twist, Volts};
use mdle_serial::{Clock, LineFault, Moment, Obedience, Times, time_of};

use crate::command::Command;
use crate::config::Config;
use crate::fault::Fault;
use crate::frame::{self, Frame};
use crate::freshness::Freshness;
use crate::line::{SPEED, ScoutLine};
use crate::odometer::Odometer;
use crate::ring::Ring;
use crate::state::{self, State};
use crate::wheels::{self, WHEEL_BASE};

/// Radius of the body, in metres.
const RADIUS: Meters = Meters(0.205);
/// Number of pings that must agree before a direction is treated as free, on a robot whose sonars fire one after the
/// other.
const CONFIRMATION: usize = 2;
/// Minimum time to wait for the robot to come to rest before its motors are released. A robot that drives at 1 m/s
/// needs 0.5 s.
const STOPPING: Duration = Duration::from_millis(600);
/// Timeout for the last answer of a robot that has not answered before.
const ANSWER: Duration = Duration::from_millis(150);
/// Maximum fluctuation, in tenths of an inch per second, of the speed of a wheel that holds its position.
const JITTER: u16 = 4;
/// Interval at which the driver checks whether the robot is at rest.
const LOOK: Duration = Duration::from_millis(20);
/// Interval at which the stop command is repeated to a robot that does not answer.
const AGAIN: Duration = Duration::from_millis(100);
/// Minimum timeout for setting the position to zero. Newer versions of the manufacturer's library wait much longer.
const ZEROING: Duration = Duration::from_secs(5);

/// Driver of a Scout. The robot has begun to answer.
#[derive(Debug)]
pub struct Scout {
    line: ScoutLine,
    config: Config,
    clock: Clock,
    odometer: Odometer,
    ring: Ring,
    /// `true` if the new order of the sonars has not been sent to the robot yet.
    is_reordered: bool,
    /// Drift of the odometry heading, estimated from walls.
    compass: Compass,
    freshness: Freshness,
    obedience: Obedience,
    times: Times,
    /// Time of the last command; `None` before the first command, and after the robot has been stopped.
    commanded: Option<Moment>,
    /// Recorded paths that the plan can replay.
    pub(crate) paths: PathStore,
}

/// Returns the time for transmitting the data of a turn: a command, and the answer with the state.
pub(crate) fn turn_takes() -> Duration {
    let command = Command::Velocities(0, 0).frame().bytes().len();
    time_of(command + state::LENGTH + frame::AROUND, SPEED)
}

impl Scout {
    /// Opens the line and prepares the robot. Afterwards, the robot is at rest at position zero, its watchdog is armed,
    /// and each sonar has pinged.
    ///
    /// # Errors
    /// Fails if the line or the robot is missing, or if the robot's emergency stop is pressed.
    pub fn connect(config: Config, clock: Clock, period: Duration, request: &StopRequest) -> Result<Self, Fault> {
        let line = ScoutLine::open(&config.device)?;
        let ring = Ring::new(&config.sonars, Nanos(config.gap.saturating_mul(1_000_000)));
        let (odometer, freshness, times) = (Odometer::default(), Freshness::default(), Times::new(clock));
        // Forward motion and rotation share each wheel's deceleration: in the worst case, each gets half of it.
        let brakes = config.acceleration / 2.0;
        let obedience = Obedience::new(brakes, brakes, Duration::from_millis(config.disobey));
        let mut scout = Self {
            line,
            config,
            clock,
            odometer,
            ring,
            is_reordered: false,
            compass: Compass::default(),
            freshness,
            obedience,
            times,
            commanded: None,
            paths: PathStore::EMPTY,
        };
        match scout.prepare(period, request) {
            Ok(()) => Ok(scout),
            Err(Fault::Ended(_)) => Err(Fault::Ended(scout.stop().err().map(Box::new))),
            Err(fault) => {
                // The earlier fault is reported, whether or not the stop succeeds.
                let _ = scout.stop();
                Err(fault)
            }
        }
    }

    /// Returns the time without a command after which the robot stops itself.
    fn watchdog(&self) -> Duration {
        Duration::from_secs(self.config.watchdog.into())
    }

    fn prepare(&mut self, period: Duration, request: &StopRequest) -> Result<(), Fault> {
        let go_on = || if request.is_made() { Err(Fault::Ended(None)) } else { Ok(()) };
        go_on()?;
        // Another program may have left the robot moving.
        self.command(Command::Velocities(0, 0))?;
        self.command(Command::Watchdog(self.config.watchdog))?;
        let acceleration = libm::trunc(self.config.acceleration / wheels::UNIT) as u16;
        self.command(Command::Accelerations(acceleration, acceleration))?;
        go_on()?;
        self.order_sonars()?;
        let mut left = Duration::from_nanos(self.ring.around().0);
        while !left.is_zero() {
            self.clock.pass_unless(request, period.min(left));
            go_on()?;
            left = left.saturating_sub(period);
            self.command(Command::State)?;
        }
        // The robot is at rest by now.
        let (asked, limit) = (Moment::now(), ZEROING.max(self.config.patience()));
        self.line.ask_while(&Command::Zero, Instant::now() + limit, &go_on)?;
        if self.clock == Clock::Wall && asked.elapsed() > limit {
            return Err(Fault::Overslept(self.config.watchdog));
        }
        self.commanded = Some(Moment::now());
        Ok(())
    }

    /// Sends the order in which the sonars have to ping.
    fn order_sonars(&mut self) -> Result<(), Fault> {
        self.is_reordered = false;
        self.command(Command::Sonars((self.config.gap / 4) as u8, self.config.order())).map(drop)
    }

    /// Waits until the robot is at rest.
    ///
    /// # Errors
    /// Fails if the robot does not answer, or if it still moves when the time limit has passed.
    fn stands(&mut self, begun: Instant, limit: Duration) -> Result<(), Fault> {
        let mut was_slow = false;
        for looks in 1.. {
            let is_last = self.clock.is_past(limit, begun, looks);
            let frame = self.at_the_end(Command::State, self.config.patience())?;
            let state = State::read(&frame.arguments).ok_or(Fault::Short(frame.arguments.len()))?;
            let fastest = state.right.unsigned_abs().max(state.left.unsigned_abs());
            let is_slow = fastest <= JITTER;
            // A robot that is still braking comes to rest before the next check.
            if fastest == 0 || was_slow && is_slow {
                return Ok(());
            }
            if is_last {
                break;
            }
            was_slow = is_slow;
            self.clock.pass(LOOK);
        }
        Err(Fault::Moves)
    }

    /// Sends a command at the end of a run, with the timeout `patience` for the answer.
    fn at_the_end(&mut self, command: Command, patience: Duration) -> Result<Frame, Fault> {
        self.line.ask(&command, Instant::now() + patience)
    }

    /// Sends stop commands to a robot that does not answer, for the time that it needs to come to rest. Commands may
    /// reach the robot even if its answers are lost.
    fn insist(&mut self, begun: Instant, limit: Duration) {
        for attempts in 1.. {
            let deadline = Instant::now() + AGAIN;
            if self.clock.is_past(limit, begun, attempts) || self.line.say(&Command::Stop, deadline).is_err() {
                break;
            }
            self.clock.pass(AGAIN);
        }
    }

    /// Returns `true` if the robot's watchdog has stopped the robot since the last command. The robot must then not
    /// move again before the user has been informed.
    fn has_overslept(&self) -> bool {
        self.clock == Clock::Wall && self.commanded.is_some_and(|last| last.elapsed() >= self.watchdog())
    }

    /// Sends a command, and returns the state in its answer.
    fn command(&mut self, command: Command) -> Result<State, Fault> {
        if self.has_overslept() {
            return Err(Fault::Overslept(self.config.watchdog));
        }
        self.commanded = Some(Moment::now());
        let frame = match self.line.ask(&command, Instant::now() + self.config.patience()) {
            // This program was suspended while it waited for the answer.
            Err(Fault::Line(LineFault::Silent)) if self.has_overslept() => {
                return Err(Fault::Overslept(self.config.watchdog));
            }
            other => other?,
        };
        let state = State::read(&frame.arguments).ok_or(Fault::Short(frame.arguments.len()))?;
        if state.is_stopped() { Err(Fault::EmergencyStop) } else { Ok(state) }
    }
}

/// Returns the battery's voltage and state. The battery feeds both supplies; the lower voltage of the two is used.
fn supply(state: &State, config: &Config) -> Supply {
    let [cpu, motor] = state.volts();
    let battery = Volts(cpu.0.min(motor.0));
    Supply { battery, is_low: battery.0 < config.low_battery, is_plugged: state.is_plugged() }
}

/// Name of the setting for the order of the sonars.
const SONARS: &str = "sonars";

impl RobotSettings for Scout {
    fn settings(&self) -> &'static [(&'static str, &'static str)] {
        &[(SONARS, "sonars that ping, in their order")]
    }

    fn setting(&self, name: &str) -> Option<String> {
        let order: Vec<_> = self.config.sonars.iter().map(u8::to_string).collect();
        (name == SONARS).then(|| order.join(" "))
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        if name != SONARS {
            return Err(format!("a Scout has no setting `{name}`"));
        }
        self.config.sonars = sonar_order(value)?;
        self.ring.reorder(&self.config.sonars);
        self.is_reordered = true;
        Ok(())
    }
}

impl Robot for Scout {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        if self.is_reordered {
            self.order_sonars()?;
        }
        let (right, left) = wheels::speeds(input, self.config.fastest);
        let state = self.command(Command::Velocities(right, left))?;
        let at = self.times.now();
        let odometry = self.odometer.pose(&state, at, self.config.fastest)?;
        let data_age = self.freshness.take(&state, at, odometry, &self.config)?;
        let metres = |wheels: [i16; 2]| wheels.map(|wheel| f64::from(wheel) * wheels::UNIT);
        if self.obedience.is_broken(at, metres([right, left]), metres([state.right, state.left])) {
            return Err(Fault::Disobeys(self.config.disobey));
        }
        let shape = Shape {
            body_radius: RADIUS,
            half_length: RADIUS,
            half_width: RADIUS,
            sonars_apart: None,
            wheel_base: Meters(WHEEL_BASE),
            ring_radius: Meters(self.config.ring_radius),
            confirmation: CONFIRMATION,
            steering: self.config.steering,
        };
        let pings = self.ring.take_in(&state.sonars, at, odometry);
        self.compass.take(&pings, odometry, &shape);
        Ok(Sensed {
            at,
            data_age,
            odometry,
            velocity: wheels::twist(state.right, state.left),
            switches: state.bumper,
            pings,
            compass: self.compass,
            supply: supply(&state, &self.config),
            shape,
            paths: self.paths,
            published: Published::NONE,
        })
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.commanded = None;
        let (begun, limit) = (Instant::now(), self.obedience.time_to_stand(STOPPING));
        let patience = self.config.patience();
        let stopped = self.at_the_end(Command::Stop, patience);
        // If its motors were released while it moves, the robot would roll on.
        let stands = stopped.and_then(|_| self.stands(begun, limit));
        let answers = matches!(stands, Ok(()) | Err(Fault::Moves));
        if !answers {
            self.insist(begun, limit);
        }
        // The motors are released even if the robot has not answered.
        let let_go =
            self.at_the_end(Command::Limp, if answers { patience } else { self.clock.patience(ANSWER).min(patience) });
        if let_go == Err(Fault::Line(LineFault::Closed)) {
            // A robot whose answers are lost may still receive commands.
            let _ = self.line.say(&Command::Limp, Instant::now() + ANSWER);
        }
        stands.and(let_go.map(|_| ()))
    }

    fn longest_gap(&self) -> Option<Duration> {
        Some(self.watchdog())
    }
}
