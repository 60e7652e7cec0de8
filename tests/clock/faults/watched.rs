//! An emulated robot whose true path is recorded, and events that `--fault` does not cover.

use std::cell::RefCell;
use std::process::Child;
use std::time::{Duration, Instant};

use mdle_emulator::{Ailment, Emulated, Faulty, MotionOrder, OrderLog};
use mdle_runtime::Pose;

use super::PERIOD;

/// Time of the robot's world at which an event begins; the robot drives at this time.
pub(crate) const BEGINS: Duration = Duration::from_secs(4);
/// Duration of garbage. `GARBAGE_A_SECOND` is the number of garbage bytes per second, the capacity of the slower line.
const GARBAGE: Duration = Duration::from_secs(60);
const GARBAGE_A_SECOND: u32 = 3840;
/// Time for which an interrupted line carries nothing.
const DEAD: Duration = Duration::from_secs(2);
/// Time between two commands in lockstep from which the driver must have waited without an answer. With answers, it
/// waits much less.
const IN_VAIN: Duration = Duration::from_millis(2000);
/// Maximum movement in a step for which a body counts as still, in metres.
const STANDS: f64 = 1e-4;
/// Number of steps without movement after which the body remains still, because no watchdog takes longer.
const FOR_GOOD: usize = 30;

/// Event that happens to the robot, its line or its driver.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Happening {
    /// No event: the device belongs to another robot from the start.
    Nothing,
    /// The fault that `--fault` gives to the robot or its line, if any.
    OnCommand,
    /// The line carries nothing but garbage for a minute.
    Garbage,
    /// The answers belong to other commands.
    WrongAnswers,
    /// The line is interrupted in the middle of a frame, and works again later.
    DeadForAWhile,
    /// The program is killed.
    Killed,
}

/// Distance that the body still moves, in metres, and the duration of this movement.
#[derive(Debug)]
pub(crate) struct Way {
    pub(crate) metres: f64,
    pub(crate) time: Duration,
}

/// Properties of a robot that the tests need.
pub(crate) struct Nature<R> {
    /// Returns the true pose of the robot.
    pub(crate) pose: fn(&R) -> Pose,
    /// Returns the orders that have reached the robot.
    pub(crate) orders: fn(&R) -> &OrderLog,
    /// Changes a frame of the robot into an answer to another command.
    pub(crate) wrong: fn(&[u8]) -> Vec<u8>,
    /// Number of additional periods for which the robot moves while a driver waits without an answer. In lockstep, the
    /// emulator's world pauses during this wait.
    pub(crate) waits: u32,
    /// Step by which the robot's time advances.
    pub(crate) step: Duration,
}

/// The emulated robot to which an event happens. Its poses are recorded.
pub(crate) struct Watched<'a, R> {
    robot: Faulty<R>,
    happening: Happening,
    nature: Nature<R>,
    child: &'a RefCell<Child>,
    /// Real time at which the event began; `None` before the event.
    pub(crate) begun: Option<Instant>,
    age: Duration,
    /// Pose of the robot at the end of each step.
    poses: Vec<(Duration, Pose)>,
    /// Time at which the robot last received bytes.
    last_command: Option<Instant>,
    garbage: Vec<u8>,
}

impl<'a, R: Emulated> Watched<'a, R> {
    pub(crate) fn new(robot: Faulty<R>, happening: Happening, nature: Nature<R>, child: &'a RefCell<Child>) -> Self {
        let (age, poses, garbage) = (Duration::ZERO, Vec::new(), Vec::new());
        Self { robot, happening, nature, child, begun: None, age, poses, last_command: None, garbage }
    }

    /// Lets the robot move on without commands until its watchdog stops it. Returns the distance and the duration of
    /// the movement since the last answer before the event.
    pub(crate) fn left_alone(mut self) -> Way {
        while !self.stands() {
            // A closed line does not stop the robot's world.
            let _ = self.pass(self.nature.step);
            assert!(self.age < Duration::from_secs(300), "it never stands");
        }
        let since = if self.happening == Happening::Nothing { Duration::ZERO } else { BEGINS - PERIOD };
        let steps = self.poses.windows(2).filter(|two| two[0].0 >= since && moved(two) > STANDS);
        steps.fold(Way { metres: 0.0, time: Duration::ZERO }, |way, two| Way {
            metres: way.metres + moved(two),
            time: two[1].0 - since,
        })
    }

    /// Returns the last order that the robot received.
    pub(crate) fn order(&self) -> Option<MotionOrder> {
        (self.nature.orders)(self.robot.robot()).last().map(|(_, order)| order)
    }

    fn stands(&self) -> bool {
        self.poses.len() > FOR_GOOD && self.poses.windows(2).rev().take(FOR_GOOD).all(|two| moved(two) <= STANDS)
    }

    /// Returns `true` if the event is `happening` and is now in progress. `lasts` is the duration of the event.
    fn is(&self, happening: Happening, lasts: Duration) -> bool {
        self.happening == happening && self.age.checked_sub(BEGINS).is_some_and(|since| since < lasts)
    }

    /// Moves the robot on after its driver has waited for an answer by its own clock, because in lockstep only commands
    /// let time pass. To the driver, garbage is like silence; during garbage it gives up after the first wait.
    fn waited(&mut self) {
        let in_vain = self.last_command.replace(Instant::now()).is_some_and(|time| time.elapsed() >= IN_VAIN);
        if in_vain || self.is(Happening::Garbage, GARBAGE) {
            (0..std::mem::take(&mut self.nature.waits)).for_each(|_| drop(self.pass(PERIOD)));
        }
    }
}

/// Returns the distance between two poses, in metres.
fn moved(two: &[(Duration, Pose)]) -> f64 {
    libm::hypot(two[1].1.x.0 - two[0].1.x.0, two[1].1.y.0 - two[0].1.y.0)
}

impl<R: Emulated> Emulated for Watched<'_, R> {
    fn push(&mut self, bytes: &[u8]) {
        self.waited();
        if !self.is(Happening::DeadForAWhile, DEAD) {
            self.robot.push(bytes);
        }
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        let passed = self.robot.pass(time);
        self.age += time;
        if self.age >= BEGINS {
            self.begun.get_or_insert_with(Instant::now);
        }
        self.poses.push((self.age, (self.nature.pose)(self.robot.robot())));
        if self.is(Happening::Garbage, GARBAGE) {
            // Arbitrary numbers that are the same in every run.
            let count = time.as_millis() as u32 * GARBAGE_A_SECOND / 1000;
            let numbers = (0..count).scan(self.age.as_millis() as u32, |number, _| {
                *number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                Some((*number >> 24) as u8)
            });
            self.garbage.extend(numbers);
        }
        if self.is(Happening::Killed, time) {
            let mut child = self.child.borrow_mut();
            child.kill().and_then(|()| child.wait()).map_err(|error| error.to_string())?;
        }
        passed
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        let frames = self.robot.take_frames();
        if self.is(Happening::Garbage, GARBAGE) {
            return vec![std::mem::take(&mut self.garbage)];
        }
        if self.is(Happening::WrongAnswers, Duration::MAX) {
            return frames.iter().map(|frame| (self.nature.wrong)(frame)).collect();
        }
        if self.is(Happening::DeadForAWhile, PERIOD) {
            return frames.into_iter().take(1).map(|frame| frame[..frame.len() / 2].to_vec()).collect();
        }
        if self.is(Happening::DeadForAWhile, DEAD) { Vec::new() } else { frames }
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}
