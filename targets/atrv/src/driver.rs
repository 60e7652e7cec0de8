//! The driver of an ATRV, as a kinetic state machine (paper, Eq. 1). Each input is sent as two velocity commands; the
//! output is computed from the latest reports.

use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::{Compass, Meters, Nanos, PathStore, Published, Robot, Sensed, Shape, Twist};
use mdle_serial::{Clock, Line, LineFault, Obedience, Times, time_of};

use crate::command::Command;
use crate::config::Config;
use crate::fault::Fault;
use crate::layout::RING_RADIUS;
use crate::motion;
use crate::receiver::Hearing;
use crate::sender::Mouth;

/// Speed of the line in bits per second, 8N1.
const SPEED: u32 = 115_200;
/// Half the length of the body.
const HALF_LENGTH: Meters = Meters(0.315);
/// Half the width of the body.
const HALF_WIDTH: Meters = Meters(0.27);
/// Radius of the smallest circle around the body.
const RADIUS: Meters = Meters(0.415);
/// Distance between two points on a wall beside the robot, in metres: the points that reflect the pings of the two
/// sonars at 18° from the wall's normal.
const SONARS_APART: Meters = Meters(0.33);
/// Number of pings that must agree before a direction is treated as free, on a robot whose sonars fire one after the
/// other.
const CONFIRMATION: usize = 2;
/// Maximum time until the robot has released its brake and each sonar has pinged several times.
const STARTING: Duration = Duration::from_millis(1000);
/// Minimum time to wait for the robot to come to rest before its brake is set. A robot that drives at 0.2 m/s needs 0.2
/// s.
const STOPPING: Duration = Duration::from_millis(800);
/// Timeout in lockstep for a report while the robot is being stopped, and for the line to accept the last commands.
const ANSWER: Duration = Duration::from_millis(150);
/// Timeout from the command to brake until the robot reports that its brake is set.
const BRAKING: Duration = Duration::from_millis(500);
/// Interval at which the command to brake is repeated.
const AGAIN: Duration = Duration::from_millis(100);
/// Interval at which the driver checks whether the robot is at rest.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum speed at which a robot is treated as being at rest, in m/s and rad/s.
const STANDS: f64 = 0.01;
/// Interval of the bumper reports, in microseconds. It is the interval that other drivers request.
const INPUTS: u32 = 100_000;

/// Driver of an ATRV. The robot has begun to report its position.
#[derive(Debug)]
pub struct Atrv {
    mouth: Mouth,
    config: Config,
    clock: Clock,
    times: Times,
    hearing: Hearing,
    /// Drift of the odometry heading, estimated from walls.
    compass: Compass,
    obedience: Obedience,
    /// Interval of the position reports.
    reports: Duration,
    /// Number of position reports per turn in lockstep.
    a_turn: u32,
    /// Time of the last request for the state of the brake.
    asked: Nanos,
    /// Recorded paths that the plan can replay.
    pub(crate) paths: PathStore,
}

/// Returns the time for transmitting all commands of a turn, including the pause after each command.
pub(crate) fn turn_takes(config: &Config) -> Duration {
    let [along, round] = motion::commands(&Twist::default(), config);
    let commands = [Command::Status, along, round];
    let bytes = commands.iter().map(|command| command.frame(config.escape).bytes().len()).sum();
    time_of(bytes, SPEED) + Duration::from_millis(config.pause) * commands.len() as u32
}

impl Atrv {
    /// Opens the line and prepares the robot. Afterwards, the robot is at rest, its brake is released, it reports its
    /// position, and each sonar has pinged.
    ///
    /// # Errors
    /// Fails if the line or the robot is missing, if the brake stays set, or if sonars do not report.
    pub fn connect(config: Config, clock: Clock, period: Duration, request: &StopRequest) -> Result<Self, Fault> {
        let line = Line::open(&config.device, SPEED)?;
        let watchdog = match clock {
            Clock::Wall => {
                let stop = motion::commands(&Twist::default(), &config).map(|command| command.frame(config.escape));
                Some((Duration::from_millis(config.watchdog), stop))
            }
            Clock::Stepped(_) => None,
        };
        let asked = Duration::from_millis(config.reports);
        // In lockstep a turn has to end with a report.
        let (reports, a_turn) = match clock {
            Clock::Wall => (asked, 0),
            Clock::Stepped(period) => {
                let count = (period.as_micros() / asked.as_micros().max(1)).clamp(1, 1000) as u32;
                (period / count, count)
            }
        };
        let hearing = Hearing::new(&config, period);
        let [forward, turning] = motion::brakes(&config);
        let obedience = Obedience::new(forward, turning, Duration::from_millis(config.disobey));
        let mouth = Mouth::new(line, watchdog);
        let times = Times::new(clock);
        let (asked, paths) = (Nanos::ZERO, PathStore::EMPTY);
        let compass = Compass::default();
        let mut atrv = Self { mouth, config, clock, times, hearing, compass, obedience, reports, a_turn, asked, paths };
        match atrv.prepare(period, request) {
            Ok(()) => Ok(atrv),
            Err(Fault::Ended(_)) => Err(Fault::Ended(atrv.stop().err().map(Box::new))),
            Err(fault) => {
                // The earlier fault is reported, whether or not the stop succeeds.
                let _ = atrv.stop();
                Err(fault)
            }
        }
    }

    fn prepare(&mut self, period: Duration, request: &StopRequest) -> Result<(), Fault> {
        let go_on = || if request.is_made() { Err(Fault::Ended(None)) } else { Ok(()) };
        go_on()?;
        // Another program may have left the robot moving.
        self.move_on(&Twist::default())?;
        self.say(Command::Defaults)?;
        self.say(Command::Inputs(INPUTS))?;
        self.say(Command::Sonars(self.config.echo))?;
        self.say(Command::Reports(self.reports.as_micros() as u32))?;
        go_on()?;
        self.say(Command::Release)?;
        let mut left = STARTING;
        loop {
            self.say(Command::Status)?;
            self.move_on(&Twist::default())?;
            self.clock.pass_unless(request, period.min(left));
            go_on()?;
            self.hear(Nanos::ZERO, self.config.patience())?;
            let waits = self.hearing.waits_for();
            if waits.is_none() {
                return self.mouth.is_awake();
            }
            left = left.saturating_sub(period);
            if left.is_zero() {
                return waits.map_or(Ok(()), Err);
            }
        }
    }

    /// Commands a motion, and returns the commanded speeds of the robot's right and left side, in m/s.
    fn move_on(&mut self, input: &Twist) -> Result<[f64; 2], Fault> {
        let commands = motion::commands(input, &self.config);
        for command in &commands {
            let frame = command.frame(self.config.escape);
            self.mouth.say_motion(&frame, Instant::now() + self.config.patience())?;
            self.rest();
        }
        Ok(motion::asked(&commands, &self.config))
    }

    /// Sends a command other than a motion command.
    fn say(&mut self, command: Command) -> Result<(), Fault> {
        self.mouth.say(&command.frame(self.config.escape), Instant::now() + self.config.patience())?;
        self.rest();
        Ok(())
    }

    /// Pauses, because controllers need some time after each command.
    fn rest(&self) {
        self.clock.pass(Duration::from_millis(self.config.pause));
    }

    /// Reads the reports that have arrived. In lockstep, waits until all reports of the turn have arrived.
    fn hear(&mut self, at: Nanos, patience: Duration) -> Result<(), Fault> {
        self.hearing.take(self.mouth.line(), at, self.a_turn, patience)
    }

    /// Sends stop commands until the robot reports that it is at rest. It continues even if no reports arrive, because
    /// commands may reach the robot although its reports are lost.
    ///
    /// # Errors
    /// Fails if no command can be sent, or if the robot has not reported within the time limit that it is at rest.
    fn stands(&mut self) -> Result<(), Fault> {
        let (begun, limit) = (Instant::now(), self.obedience.time_to_stand(STOPPING));
        // Earlier reports describe an earlier time. A read error is detected below.
        let _ = self.hearing.forget(self.mouth.line());
        // A robot that was stopped before sends no reports.
        let mut sent = self.say(Command::Reports(self.reports.as_micros() as u32));
        // In lockstep, time passes only with commands; after a first timeout, waiting has no purpose.
        let mut patience = if self.clock == Clock::Wall { Duration::ZERO } else { self.clock.patience(ANSWER) };
        for looks in 1.. {
            sent = sent.and_then(|()| self.move_on(&Twist::default()).map(drop));
            if let Err(cut @ Fault::Line(LineFault::Closed | LineFault::Failed(_))) = sent {
                return Err(cut);
            }
            self.clock.pass(LOOK);
            let fault = match self.is_at_rest(patience.min(self.config.patience())) {
                Ok(true) => return Ok(()),
                Ok(false) => Fault::Moves,
                Err(fault) => {
                    patience = Duration::ZERO;
                    fault
                }
            };
            if self.clock.is_past(limit, begun, looks) {
                return Err(fault);
            }
            sent = Ok(());
        }
        Err(Fault::Moves)
    }

    /// Sends the command to brake until the robot reports that the brake is set. A report that the robot is at rest is
    /// not sufficient, because a robot that receives no commands also stops.
    ///
    /// # Errors
    /// Fails if no command can be sent, or if the robot has not reported within the time limit that its brake is set.
    fn brakes(&mut self) -> Result<(), Fault> {
        self.hearing.forget_brake();
        let end = Instant::now() + self.clock.patience(BRAKING);
        loop {
            self.say(Command::Brake)?;
            self.say(Command::Status)?;
            let next = end.min(Instant::now() + self.clock.patience(AGAIN));
            match self.hearing.brake(self.mouth.line(), next) {
                Err(Fault::Unheard | Fault::Unbraked) if next < end => {}
                result => return result,
            }
        }
    }

    /// Returns `true` if the reports that have arrived since the beginning of the stop show that the robot is at rest.
    fn is_at_rest(&mut self, patience: Duration) -> Result<bool, Fault> {
        let deadline = Instant::now() + patience;
        let Twist { v, omega } = self.hearing.speed(self.mouth.line(), self.a_turn.max(1), deadline)?;
        Ok(v.0.abs() < STANDS && omega.0.abs() < STANDS)
    }
}

impl Robot for Atrv {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        let at = self.times.now();
        if at.since(self.asked) >= Nanos(self.config.status.saturating_mul(1_000_000)) {
            self.asked = at;
            self.say(Command::Status)?;
        }
        let command = self.move_on(input)?;
        self.hear(at, self.config.patience())?;
        self.hearing.fault(at)?;
        if self.obedience.is_broken(at, command, motion::sides(&self.hearing.velocity(), &self.config)) {
            return Err(Fault::Disobeys(self.config.disobey));
        }
        let shape = Shape {
            body_radius: RADIUS,
            half_length: HALF_LENGTH,
            half_width: HALF_WIDTH,
            sonars_apart: Some(SONARS_APART),
            wheel_base: Meters(self.config.wheel_base),
            ring_radius: Meters(RING_RADIUS),
            confirmation: CONFIRMATION,
            steering: self.config.steering,
        };
        self.compass.take(self.hearing.pings(), self.hearing.pose(), &shape);
        Ok(Sensed {
            at,
            data_age: self.hearing.age(at),
            odometry: self.hearing.pose(),
            velocity: self.hearing.velocity(),
            switches: self.hearing.switches(),
            pings: *self.hearing.pings(),
            compass: self.compass,
            supply: self.hearing.supply(),
            shape,
            paths: self.paths,
            published: Published::NONE,
        })
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.mouth.ends();
        // At speed, a braked robot would slide.
        let stands = self.stands();
        self.mouth.ends();
        let deadline = Instant::now() + self.clock.patience(ANSWER);
        // The brake is set even if the robot has not answered.
        let braked = match stands {
            Ok(()) => self.brakes(),
            Err(fault) => {
                let _ = self.mouth.say(&Command::Brake.frame(self.config.escape), deadline);
                self.rest();
                Err(fault)
            }
        };
        let last = [Command::Deaf, Command::Inputs(0), Command::Reports(0), Command::Defaults];
        let deadline = Instant::now() + self.clock.patience(ANSWER);
        last.into_iter().fold(braked, |before, command| {
            let sent = self.mouth.say(&command.frame(self.config.escape), deadline);
            self.rest();
            before.and(sent)
        })
    }

    fn longest_gap(&self) -> Option<Duration> {
        Some(Duration::from_millis(self.config.watchdog))
    }
}
