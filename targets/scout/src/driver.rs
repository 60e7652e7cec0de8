//! The Scout as a kinetic state machine: each input is a velocity command, whose answer is the output (paper, Eq. 1).

use std::time::{Duration, Instant};

use mdle_runtime::{Meters, Nanos, Robot, Twist};

use crate::command::Command;
use crate::config::Config;
use crate::fault::Fault;
use crate::line::Line;
use crate::odometer::Odometer;
use crate::output::Sensed;
use crate::ring::Ring;
use crate::state::State;
use crate::wheels;

/// How long the robot may take to stand before its motors are let go: from 1 m/s it takes half a second.
const STOPPING: Duration = Duration::from_millis(600);
/// How long each answer may take meanwhile.
const ANSWER: Duration = Duration::from_millis(150);
/// The time between two looks at whether it stands.
const LOOK: Duration = Duration::from_millis(20);
/// How long it may take to set its position to zero: newer versions of its maker's library wait much longer for that.
const ZEROING: Duration = Duration::from_secs(5);

/// Where the time of an output comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// The time that has passed since the first output.
    Wall,
    /// So much for each output: a robot in lockstep.
    Stepped(Duration),
}

/// A Scout that answers.
#[derive(Debug)]
pub struct Scout {
    line: Line,
    config: Config,
    clock: Clock,
    odometer: Odometer,
    ring: Ring,
    /// When the first output was taken, and how many there have been.
    first: Option<Instant>,
    outputs: u64,
}

impl Scout {
    /// Opens the line and prepares the robot: it stands at zero, its watchdog is armed, and each sonar has pinged.
    ///
    /// # Errors
    /// There is no line, no robot, or its emergency stop is pressed.
    pub fn connect(config: Config, clock: Clock, period: Duration) -> Result<Self, Fault> {
        let line = Line::open(&config.device)?;
        let ring = Ring::new(&config.sonars, Nanos(config.gap.saturating_mul(1_000_000)));
        let mut scout = Self { line, config, clock, odometer: Odometer::default(), ring, first: None, outputs: 0 };
        match scout.prepare(period) {
            Ok(()) => Ok(scout),
            Err(fault) => {
                // What led here says more than what comes of this.
                let _ = scout.stop();
                Err(fault)
            }
        }
    }

    fn prepare(&mut self, period: Duration) -> Result<(), Fault> {
        // Whoever drove it before may have left it moving.
        self.tell(Command::Velocities(0, 0))?;
        self.tell(Command::Watchdog(self.config.watchdog))?;
        let acceleration = libm::trunc(self.config.acceleration / wheels::UNIT) as u16;
        self.tell(Command::Accelerations(acceleration, acceleration))?;
        self.tell(Command::Sonars((self.config.gap / 4) as u8, self.config.order()))?;
        let mut left = Duration::from_nanos(self.ring.around().0);
        while !left.is_zero() {
            self.pass(period.min(left));
            left = left.saturating_sub(period);
            self.tell(Command::State)?;
        }
        // It stands by now.
        self.line.ask(&Command::Zero, Instant::now() + ZEROING.max(self.config.patience())).map(|_| ())
    }

    /// Lets time pass, unless it passes with each command.
    fn pass(&self, time: Duration) {
        match self.clock {
            Clock::Wall => std::thread::sleep(time),
            Clock::Stepped(_) => {}
        }
    }

    /// Waits until the robot stands, or `deadline`.
    fn stands(&mut self, deadline: Instant) -> Result<(), Fault> {
        while Instant::now() < deadline {
            let frame = self.line.ask(&Command::State, deadline.min(Instant::now() + ANSWER))?;
            if State::read(&frame.arguments).is_some_and(|state| (state.right, state.left) == (0, 0)) {
                break;
            }
            self.pass(LOOK);
        }
        Ok(())
    }

    /// Says a command and reads the state that answers it.
    fn tell(&mut self, command: Command) -> Result<State, Fault> {
        let frame = self.line.ask(&command, Instant::now() + self.config.patience())?;
        let state = State::read(&frame.arguments).ok_or(Fault::Short(frame.arguments.len()))?;
        if state.is_stopped() { Err(Fault::EmergencyStop) } else { Ok(state) }
    }

    /// The time of the output that has just come, from the first one on.
    fn now(&mut self) -> Nanos {
        let outputs = self.outputs;
        self.outputs = outputs.saturating_add(1);
        let passed = match self.clock {
            Clock::Wall => self.first.get_or_insert_with(Instant::now).elapsed(),
            Clock::Stepped(period) => period.saturating_mul(u32::try_from(outputs).unwrap_or(u32::MAX)),
        };
        Nanos(u64::try_from(passed.as_nanos()).unwrap_or(u64::MAX))
    }
}

impl Robot for Scout {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        let (right, left) = wheels::speeds(input, self.config.fastest);
        let state = self.tell(Command::Velocities(right, left))?;
        let (at, odometry) = (self.now(), self.odometer.pose(&state));
        Ok(Sensed {
            odometry,
            velocity: wheels::twist(state.right, state.left),
            switches: state.bumper,
            pings: self.ring.take_in(&state.sonars, at, odometry),
            ring_radius: Meters(self.config.ring_radius),
        })
    }

    fn stop(&mut self) -> Result<(), Fault> {
        let deadline = Instant::now() + STOPPING;
        let stopped = self.line.ask(&Command::Stop, Instant::now() + ANSWER);
        // Let go while it moves, it would roll on.
        let stands = stopped.and_then(|_| self.stands(deadline));
        // Its motors are let go whether or not it has understood.
        let let_go = self.line.ask(&Command::Limp, Instant::now() + ANSWER);
        stands.and(let_go.map(|_| ()))
    }
}
