//! An emulated robot that measures how late it is: on a busy machine, a robot may seem to give no answer.

use std::time::{Duration, Instant};

use mdle_emulator::{Ailment, Emulated};

/// A robot whose time passes by the clock, and the maximum time by which it was late.
pub(crate) struct Timed<R> {
    pub(crate) robot: R,
    /// Clock time at which the robot was switched on.
    begun: Instant,
    age: Duration,
    pub(crate) late: Duration,
}

impl<R> Timed<R> {
    pub(crate) fn new(robot: R) -> Self {
        Self { robot, begun: Instant::now(), age: Duration::ZERO, late: Duration::ZERO }
    }
}

impl<R: Emulated> Emulated for Timed<R> {
    fn push(&mut self, bytes: &[u8]) {
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.age += time;
        self.late = self.late.max(self.begun.elapsed().saturating_sub(self.age));
        self.robot.pass(time)
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        self.robot.take_frames()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}
