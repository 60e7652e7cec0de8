//! Code that the tests of all drivers share. Every driver of a robot on a serial line has to pass these tests with its
//! emulated robot.

use std::marker::PhantomData;
use std::path::Path;
use std::time::Duration;

use mdle_conformance::{Room, Stage, Supplied};
use mdle_host::StopRequest;
use mdle_runtime::{Alphabet, MetersPerSecond, Nanos, PathStore, Pose, RadiansPerSecond, Robot, Sensed, Twist};
use mdle_serial::{Clock, Configured, SerialRobot};
use mdle_simulator::{Body, Make, Simulated, World};

use crate::driven::{Driven, driven};
use crate::fault::{Ailment, ScheduledFault};
use crate::faulty::Faulty;
use crate::orders::OrderLog;
use crate::serve::{Emulated, Pace};
use crate::staged::Staged;

/// Timeout of the driver, in milliseconds, for runs in which every answer arrives. It is longer than any computer
/// needs.
const LONG: u64 = 60_000;
/// Timeout of the driver, in milliseconds, for runs in which some answers do not arrive.
const PATIENCE: u64 = 3000;

/// World with one wall 4 m in front of the robot; all other walls are at least 3 m away.
const HALL: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[4, -3], [4, 3], [-3, 3], [-3, -3], [4, -3]]";

/// Motion of a robot's wheels at the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WheelMotion {
    /// The wheels turn.
    Moves,
    /// The wheels are at rest, without a brake.
    Still,
    /// The wheels are at rest, and the brake is set.
    Braked,
}

/// A kind of robot, with its driver and its emulator.
pub trait Trial {
    /// Driver of the robot.
    type Driver: SerialRobot;
    /// Alphabet of the driver's crate.
    type Alphabet: Alphabet<Output = Sensed, Input = Twist>;
    /// Emulator of the robot.
    type Emulated: Emulated + Send + 'static;
    /// Body of the robot in the simulator.
    const BODY: Body;

    /// Returns the time step of the robot's world at this pace.
    fn step(pace: Pace) -> Duration {
        pace.step()
    }

    /// Creates an emulated robot that has just been switched on. The robot's world advances in steps of `step`.
    ///
    /// # Errors
    /// Fails if `body` rejects the null input, which it never does.
    fn emulated(body: Simulated, step: Duration) -> Result<Self::Emulated, String>;

    /// Returns the robot's true pose in the world.
    fn pose(robot: &Self::Emulated) -> Pose;

    /// Returns the motion of the robot's wheels.
    fn motion(robot: &Self::Emulated) -> WheelMotion;

    /// Returns the orders that the robot has received.
    fn orders(robot: &Self::Emulated) -> &OrderLog;
}

/// Returns the period of the robot's turns.
fn period<T: Trial>() -> Duration {
    Duration::from_nanos(T::Driver::PERIOD.0)
}

/// Creates a robot that has just been switched on at the pose `at` in `world`.
fn switched_on<T: Trial>(world: &World, at: Pose, seed: Option<u64>) -> Result<T::Emulated, String> {
    let step = T::step(Pace::Lockstep(period::<T>()));
    let make = Make { body: T::BODY, without: Vec::new(), seed };
    T::emulated(Simulated::with(&make, world, at, step).map_err(|error| error.to_string())?, step)
}

/// Connects a driver to the robot at this device, with a timeout of `answer` milliseconds.
fn connected<T: Trial>(device: &Path, answer: u64) -> Result<Result<T::Driver, FaultOf<T>>, String> {
    let mut config = Configured::<<T::Driver as SerialRobot>::Config>::read(None, device.to_str())?.config;
    *T::Driver::answer(&mut config) = answer;
    let period = period::<T>();
    Ok(T::Driver::connect(config, Clock::Stepped(period), period, &StopRequest::default()))
}

/// Fault type of the driver of `T`.
type FaultOf<T> = <<T as Trial>::Driver as Robot>::Error;

/// Test stage for the conformance suite. It connects the driver to the robot that is currently switched on. The robot's
/// sensors are exact, and its wheels do not slip.
#[derive(Debug)]
pub struct OnItsLine<T>(Option<Staged<Pose>>, PhantomData<T>);

impl<T> Default for OnItsLine<T> {
    fn default() -> Self {
        Self(None, PhantomData)
    }
}

impl<T: Trial> Stage for OnItsLine<T> {
    type Robot = T::Driver;
    type Alphabet = T::Alphabet;
    const PERIOD: Nanos = T::Driver::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<T::Driver, String> {
        let world = World::parse("the room", &room.to_string()).map_err(|error| error.to_string())?;
        let robot = switched_on::<T>(&world, at, None)?;
        let staged = Staged::new(robot, period::<T>(), T::pose).map_err(|error| error.to_string())?;
        let driver = connected::<T>(staged.device(), LONG)?.map_err(|fault| fault.to_string());
        self.0 = Some(staged);
        driver
    }

    fn take_paths(&mut self, robot: &mut T::Driver, paths: PathStore) {
        robot.take_paths(paths);
    }

    fn supply(&mut self, _: &mut T::Driver, supplied: Supplied) {
        let ailment = match supplied {
            Supplied::Well => return,
            Supplied::Low => Ailment::LowBattery,
            Supplied::Plugged => Ailment::PluggedIn,
        };
        self.0.iter().for_each(|staged| staged.suffers(ailment));
    }

    fn truth(&self, _: &T::Driver) -> Pose {
        self.0.as_ref().map_or(Pose::ORIGIN, Staged::now)
    }

    fn left_alone(&mut self, _: &mut T::Driver, periods: u32) {
        self.0.iter().for_each(|staged| staged.left_alone(periods));
    }
}

/// Returns the number of memory allocations that the driver makes in fifty turns; `asked` returns the number of
/// allocations on this thread so far. In fifty turns, each sonar pings, and the driver also does everything that it
/// does only in some turns.
///
/// # Errors
/// Fails if the robot or its driver failed.
pub fn memory_asked_for<T: Trial>(asked: fn() -> u64) -> Result<u64, String> {
    let world = World::office().map_err(|error| error.to_string())?;
    let robot = switched_on::<T>(&world, world.start, Some(1))?;
    let Driven { result, served, .. } = driven(robot, Pace::Lockstep(period::<T>()), |device| {
        let mut driver = connected::<T>(device, LONG)?.map_err(|fault| fault.to_string())?;
        let before = asked();
        for turn in 0..50 {
            let omega = RadiansPerSecond(f64::from(turn % 7) / 10.0 - 0.3);
            driver.exchange(&Twist { v: MetersPerSecond(0.2), omega }).map_err(|fault| fault.to_string())?;
        }
        Ok(asked() - before)
    })
    .map_err(|error| error.to_string())?;
    served.map_err(|error| error.to_string())?;
    result
}

/// A finished run with faults of a robot that was in front of a wall.
pub(crate) struct FinishedRun<T: Trial> {
    /// Last output, or the fault that ended the run.
    pub(crate) output: Result<Sensed, FaultOf<T>>,
    /// Result of stopping the robot.
    pub(crate) stop: Result<(), FaultOf<T>>,
    /// Emulated robot after the run.
    pub(crate) robot: T::Emulated,
}

/// Runs a driver that requests the speed `speed`, in m/s, for `turns` turns. Then stops the robot, as the host always
/// does.
///
/// # Errors
/// Fails if a fault is unknown, if the driver cannot connect, if the line closes although no fault closes it, or if it
/// stays open although a fault should close it.
pub(crate) fn ran<T: Trial>(
    turns: u32,
    faults: &[&str],
    speed: fn(turn: u32) -> f64,
) -> Result<FinishedRun<T>, String> {
    let Driven { result, served, robot } = driven(faulty::<T>(faults)?, Pace::Lockstep(period::<T>()), |device| {
        let mut driver = connected::<T>(device, PATIENCE)?.map_err(|fault| fault.to_string())?;
        let mut exchange = |turn| driver.exchange(&Twist { v: MetersPerSecond(speed(turn)), ..Twist::default() });
        let output = (1..turns).try_fold(exchange(0), |last, turn| last.map(|_| exchange(turn)));
        Ok::<_, String>((output.unwrap_or_else(Err), driver.stop()))
    })
    .map_err(|error| error.to_string())?;
    let closes = faults.iter().any(|fault| fault.starts_with("close"));
    if served.is_err() != closes {
        return Err(format!("{faults:?}: {served:?}"));
    }
    let (output, stop) = result?;
    Ok(FinishedRun { output, stop, robot: robot.into_robot() })
}

/// Connects a driver to a robot that has this fault from the beginning, and returns the result.
///
/// # Errors
/// Fails if the fault is unknown, or if the line failed.
pub(crate) fn started<T: Trial>(fault: &str) -> Result<Result<(), FaultOf<T>>, String> {
    let Driven { result, served, .. } =
        driven(faulty::<T>(&[fault])?, Pace::Lockstep(period::<T>()), |device| connected::<T>(device, PATIENCE))
            .map_err(|error| error.to_string())?;
    served.map_err(|error| error.to_string())?;
    result.map(|driver| driver.map(drop))
}

/// Creates a robot with these faults, in front of the wall of [`HALL`].
fn faulty<T: Trial>(faults: &[&str]) -> Result<Faulty<T::Emulated>, String> {
    let world = World::parse("hall", HALL).map_err(|error| error.to_string())?;
    let faults: Vec<ScheduledFault> = faults.iter().map(|fault| fault.parse()).collect::<Result<_, _>>()?;
    Faulty::new(switched_on::<T>(&world, world.start, None)?, &faults)
}
