//! A test for every robot on a serial line. It runs the robot with each fault, and compares the run with the expected
//! effects in the robot's table.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_runtime::{Sensed, SonarId};

use crate::fault::{Fault, ScheduledFault};
use crate::orders::MotionOrder;
use crate::serve::Emulated as _;
use crate::trial::{FinishedRun, Trial, WheelMotion, ran, started};

/// World time at which a fault begins, in seconds.
const BEGINS: u64 = 3;
/// Maximum time between the first stop order after the fault and the driver's last order.
const STOPPING: Duration = Duration::from_millis(2500);
/// Number of simultaneous runs. It can be large, because most runs wait for an answer that never arrives.
const AT_ONCE: usize = 32;

/// Speed that a driver requests, in turns of 100 ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Speed {
    /// The robot moves ahead at 0.2 m/s.
    Ahead,
    /// The robot moves ahead at 0.2 m/s for three seconds, until the fault begins, and then stops.
    Halts,
    /// The robot stays at rest.
    Rests,
}

/// Expected output of a robot that has been commanded to drive ahead for five seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Feels {
    /// The robot has moved a metre straight ahead, and receives an echo from the wall in front of it.
    Well,
    /// The robot has moved a metre straight ahead, and reports a contact.
    Contact,
    /// The robot has moved a metre straight ahead, and receives no echo.
    NoEcho,
    /// The robot has turned to the right.
    Turn,
}

/// Expected effect of faults on a run. A fault without an explicit time begins after three seconds.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    faults: &'static [&'static str],
    speed: Speed,
    turns: u32,
    output: Result<Feels, &'static str>,
    stop: Result<(), &'static str>,
    /// `true` if the stop may succeed although a failure is expected.
    may_stop: bool,
    motion: WheelMotion,
    orders: &'static [MotionOrder],
}

impl Effect {
    /// Creates the effect of `faults` for a robot that is commanded to drive ahead for five seconds. The driver notices
    /// nothing, and can stop the robot. After the stop, the motion of the wheels is `motion`, and the last orders that
    /// the robot received are `orders`.
    #[must_use]
    pub const fn of(faults: &'static [&'static str], motion: WheelMotion, orders: &'static [MotionOrder]) -> Self {
        Self {
            faults,
            speed: Speed::Ahead,
            turns: 50,
            output: Ok(Feels::Well),
            stop: Ok(()),
            may_stop: false,
            motion,
            orders,
        }
    }

    /// Sets the speed that the driver requests, and the number of turns (of 100 ms each).
    #[must_use]
    pub const fn asked(self, speed: Speed, turns: u32) -> Self {
        Self { speed, turns, ..self }
    }

    /// Expects that the run ends with a fault whose message contains `words`.
    #[must_use]
    pub const fn fails(self, words: &'static str) -> Self {
        Self { output: Err(words), ..self }
    }

    /// Expects that the stop fails with a message that contains `words`.
    #[must_use]
    pub const fn stop_fails(self, words: &'static str) -> Self {
        Self { stop: Err(words), ..self }
    }

    /// Accepts a stop that succeeds as well as a stop that fails, because it depends on the time of a request whether
    /// its answer is lost.
    #[must_use]
    pub const fn may_stop(self) -> Self {
        Self { may_stop: true, ..self }
    }

    /// Expects that the output reports a contact.
    #[must_use]
    pub const fn feels_contact(self) -> Self {
        Self { output: Ok(Feels::Contact), ..self }
    }

    /// Expects that the sonar at the front receives no echo.
    #[must_use]
    pub const fn hears_nothing_ahead(self) -> Self {
        Self { output: Ok(Feels::NoEcho), ..self }
    }

    /// Expects that the robot turns to the right.
    #[must_use]
    pub const fn turns_right(self) -> Self {
        Self { output: Ok(Feels::Turn), ..self }
    }

    /// Runs the robot. Returns a sentence that describes the first difference from this effect.
    fn differences<T: Trial>(&self) -> Result<(), String> {
        let faults: Vec<String> = self.faults.iter().map(|fault| begun(fault)).collect();
        let faults: Vec<&str> = faults.iter().map(String::as_str).collect();
        let FinishedRun { output, stop, robot } = ran::<T>(self.turns, &faults, self.speed.function())?;
        let output = match (self.output, output) {
            (Ok(feels), Ok(sensed)) if self.speed == Speed::Ahead && self.turns == 50 => feels.check(&sensed),
            (expected, output) => {
                same(expected.map(drop), output.map(drop)).map_err(|error| format!("the run: {error}"))
            }
        };
        let expected = if self.may_stop && stop.is_ok() { Ok(()) } else { self.stop };
        let stop = same(expected, stop).map_err(|error| format!("the stop: {error}"));
        let motion = T::motion(&robot);
        let motion =
            if motion == self.motion { Ok(()) } else { Err(format!("{motion:?} instead of {:?}", self.motion)) };
        let orders: Vec<(Duration, MotionOrder)> = T::orders(&robot).iter().collect();
        [output, stop, motion, self.ordered(&orders)].into_iter().collect()
    }

    /// Compares the last orders with the expected ones. Also checks that the driver sends its last order within the
    /// time [`STOPPING`] after the first stop order.
    fn ordered(&self, orders: &[(Duration, MotionOrder)]) -> Result<(), String> {
        let kinds: Vec<MotionOrder> = orders.iter().map(|(_, order)| *order).collect();
        if !kinds.ends_with(self.orders) {
            return Err(format!("the orders {kinds:?} do not end with {:?}", self.orders));
        }
        let stands = orders.iter().find(|(age, order)| age.as_secs() >= BEGINS && *order == MotionOrder::Stand);
        match (stands, orders.last()) {
            (Some((first, _)), Some((last, _))) if *last - *first > STOPPING => {
                Err(format!("orders from {first:?} to {last:?}"))
            }
            _ => Ok(()),
        }
    }
}

impl Speed {
    fn function(self) -> fn(turn: u32) -> f64 {
        match self {
            Self::Ahead => |_| 0.2,
            Self::Halts => |turn| if turn < 30 { 0.2 } else { 0.0 },
            Self::Rests => |_| 0.0,
        }
    }
}

impl Feels {
    /// Compares `y` with the expected output. The error is a sentence that describes the difference.
    fn check(self, y: &Sensed) -> Result<(), String> {
        let (way, heading) = (y.pose().x.0, y.pose().theta.degrees());
        let echo = y.pings(SonarId::new(0)).newest_first().next().and_then(|ping| ping.range);
        let is_straight = (way - 1.0).abs() < 0.03 && heading.abs() < 1.0;
        let is_so = match self {
            Self::Well => is_straight && echo.is_some() && !y.pressed(),
            Self::Contact => is_straight && y.pressed(),
            Self::NoEcho => is_straight && echo.is_none(),
            Self::Turn => (-170.0..-20.0).contains(&heading),
        };
        let is = || format!("{way} m ahead, {heading}°, {echo:?}, contact: {}; expected {self:?}", y.pressed());
        if is_so { Ok(()) } else { Err(is()) }
    }
}

/// Returns `fault`. If it has no time, the time [`BEGINS`] is appended.
fn begun(fault: &str) -> String {
    if fault.contains('@') { fault.to_owned() } else { format!("{fault}@{BEGINS}") }
}

/// Compares a result with the expected one; the message of an expected fault has to contain the given words.
fn same<F: std::fmt::Display>(expected: Result<(), &str>, result: Result<(), F>) -> Result<(), String> {
    match (expected, result.map_err(|fault| fault.to_string())) {
        (Ok(()), Ok(())) => Ok(()),
        (Err(words), Err(sentence)) if sentence.contains(words) => Ok(()),
        (expected, result) => Err(format!("{result:?} instead of {expected:?}")),
    }
}

/// Runs the robot with the faults of each row in `effects`, and starts a robot with each fault in `refusals`. The
/// driver has to reject each of these starts with a message that contains the given words. Returns a sentence for each
/// row that differs from its run, for each start that is not rejected in this way, and for each fault of the emulator
/// that has no row.
#[must_use]
pub fn untrue_effects<T: Trial>(effects: &[Effect], refusals: &[(&'static str, &'static str)]) -> Vec<String> {
    let run = |effect: &Effect| effect.differences::<T>().map_err(|error| format!("{:?}: {error}", effect.faults));
    let refuse = |(fault, words): &(&'static str, &str)| {
        let result = started::<T>(fault).and_then(|result| same(Err(words), result));
        result.map_err(|error| format!("{fault} at the start: {error}"))
    };
    let (next, untrue) = (AtomicUsize::new(0), Mutex::new(missing::<T>(effects)));
    let work = || {
        loop {
            let row = next.fetch_add(1, Ordering::Relaxed);
            let result = match effects.get(row) {
                Some(effect) => run(effect),
                None => match refusals.get(row - effects.len()) {
                    Some(refusal) => refuse(refusal),
                    None => break,
                },
            };
            untrue.lock().unwrap_or_else(PoisonError::into_inner).extend(result.err());
        }
    };
    thread::scope(|scope| (0..AT_ONCE).for_each(|_| drop(scope.spawn(work))));
    untrue.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Returns a sentence for each fault that the robot can have but that has no row. Late frames are not checked, because
/// they need a clock, and robots in lockstep have none.
fn missing<T: Trial>(effects: &[Effect]) -> Vec<String> {
    let faults =
        effects.iter().flat_map(|effect| effect.faults).filter_map(|fault| fault.parse::<ScheduledFault>().ok());
    let names: Vec<String> = faults.map(|at| at.fault.to_string()).collect();
    let can = |fault: &Fault| if let Fault::Body(ailment) = fault { T::Emulated::can_suffer(*ailment) } else { true };
    let is_missing = |fault: &Fault| !matches!(fault, Fault::Late(_)) && !names.contains(&fault.to_string());
    Fault::all().filter(can).filter(is_missing).map(|fault| format!("no row has {fault}")).collect()
}
