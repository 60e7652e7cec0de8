//! An emulated robot with faults that begin at given times.

use std::collections::VecDeque;
use std::time::Duration;

use mdle_simulator::Footprint;

use crate::fault::{Ailment, Fault, ScheduledFault};
use crate::serve::{Embodied, Emulated};

/// Noise bytes, as on an unshielded line. They are repeated as often as needed.
const NOISE: [u8; 3] = [0xFF, 0x00, 0xA5];

/// An emulated robot, with faults of the line and of the body.
#[allow(missing_debug_implementations, reason = "a robot need not have one")]
pub struct Faulty<R> {
    robot: R,
    /// Faults that have not begun yet.
    coming: Vec<ScheduledFault>,
    begun: Vec<Fault>,
    /// Time since the robot was switched on.
    age: Duration,
    /// Number of frames that the robot has sent.
    count: u32,
    /// Fragments of delayed frames, each with its arrival time, which is counted from the time when the robot was
    /// switched on.
    late: VecDeque<(Duration, Vec<u8>)>,
}

impl<R: Emulated> Faulty<R> {
    /// Creates a robot that has just been switched on. Each of `faults` begins at its time.
    ///
    /// # Errors
    /// Fails if this kind of robot cannot have one of the faults.
    pub fn new(robot: R, faults: &[ScheduledFault]) -> Result<Self, String> {
        let cannot = faults.iter().find(|at| matches!(at.fault, Fault::Body(ailment) if !R::can_suffer(ailment)));
        if let Some(ScheduledFault { fault, .. }) = cannot {
            return Err(format!("--fault {fault}: this robot cannot have that"));
        }
        let mut faulty = Self {
            robot,
            coming: faults.to_vec(),
            begun: Vec::new(),
            age: Duration::ZERO,
            count: 0,
            late: VecDeque::new(),
        };
        faulty.begin();
        Ok(faulty)
    }

    /// Returns the robot without the faults of its line.
    #[must_use]
    pub fn robot(&self) -> &R {
        &self.robot
    }

    /// Converts to the robot without the faults of its line.
    #[must_use]
    pub fn into_robot(self) -> R {
        self.robot
    }

    /// Returns `true` if the fault that closes the line has begun.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.has(Fault::Close)
    }

    fn has(&self, fault: Fault) -> bool {
        self.begun.contains(&fault)
    }

    /// Returns the number of the first active fault for which `of` returns a number; `None` if there is no such fault.
    fn number(&self, of: fn(Fault) -> Option<u32>) -> Option<u32> {
        self.begun.iter().find_map(|fault| of(*fault))
    }

    /// Begins the faults that are due.
    fn begin(&mut self) {
        for ScheduledFault { fault, .. } in self.coming.extract_if(.., |at| at.time <= self.age) {
            self.begun.push(fault);
            if let Fault::Body(ailment) = fault {
                self.robot.suffer(ailment);
            }
        }
    }

    /// Returns the fragments of `frame` that arrive over the faulty line.
    fn sent(&mut self, mut frame: Vec<u8>) -> Vec<Vec<u8>> {
        self.count = self.count.wrapping_add(1);
        if self.has(Fault::Silence) || self.has(Fault::Lose) && !self.count.is_multiple_of(3) {
            return Vec::new();
        }
        let middle = frame.len() / 2;
        if let Some(byte) = frame.get_mut(middle).filter(|_| self.begun.contains(&Fault::Check)) {
            *byte ^= 1;
        }
        if let Some(count) = self.number(|fault| if let Fault::Noise(count) = fault { Some(count) } else { None }) {
            frame.splice(..0, NOISE.into_iter().cycle().take(count as usize));
        }
        if self.has(Fault::Double) {
            // In one fragment: on a line, the copy would follow without a gap.
            frame = frame.repeat(2);
        }
        let size = if self.has(Fault::Dribble) { 1 } else { frame.len().max(1) };
        frame.chunks(size).map(<[u8]>::to_vec).collect()
    }
}

impl<R: Emulated> Emulated for Faulty<R> {
    fn push(&mut self, bytes: &[u8]) {
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.robot.pass(time)?;
        self.age += time;
        self.begin();
        if self.is_closed() { Err("closed".to_owned()) } else { Ok(()) }
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        let frames = self.robot.take_frames();
        let delay = self.number(|fault| if let Fault::Late(millis) = fault { Some(millis) } else { None });
        let due = self.age + Duration::from_millis(u64::from(delay.unwrap_or(0)));
        for frame in frames {
            let pieces = self.sent(frame);
            self.late.extend(pieces.into_iter().map(|piece| (due, piece)));
        }
        std::iter::from_fn(|| self.late.pop_front_if(|(due, _)| *due <= self.age)).map(|(_, piece)| piece).collect()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}

impl<R: Embodied> Embodied for Faulty<R> {
    fn footprint(&self) -> Footprint {
        self.robot.footprint()
    }

    fn see(&mut self, others: &[Footprint]) {
        self.robot.see(others);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that sends the same frame in each period, and can have every [`Ailment`] except filler.
    #[derive(Default)]
    struct Robot(Vec<Ailment>);

    impl Emulated for Robot {
        fn push(&mut self, _: &[u8]) {}

        fn obey(&mut self) -> Option<bool> {
            None
        }

        fn pass(&mut self, _: Duration) -> Result<(), String> {
            Ok(())
        }

        fn take_frames(&mut self) -> Vec<Vec<u8>> {
            vec![vec![1, 2, 3, 4]]
        }

        fn can_suffer(ailment: Ailment) -> bool {
            ailment != Ailment::Filler
        }

        fn suffer(&mut self, ailment: Ailment) {
            self.0.push(ailment);
        }
    }

    /// Returns the fragments in which three frames arrive with these faults.
    fn frames(faults: &[&str]) -> Vec<Vec<u8>> {
        let faults: Vec<ScheduledFault> = faults.iter().map(|text| text.parse().expect("a fault")).collect();
        let mut robot = Faulty::new(Robot::default(), &faults).expect("a robot");
        (0..3).flat_map(|_| robot.take_frames()).collect()
    }

    #[test]
    fn frames_are_lost_and_doubled_and_damaged() {
        let frame = vec![1, 2, 3, 4];
        assert_eq!(frames(&[]), vec![frame.clone(); 3]);
        assert_eq!(frames(&["silence"]), [[0_u8; 0]; 0]);
        assert_eq!(frames(&["lose"]), vec![frame.clone()]);
        assert_eq!(frames(&["double"]), vec![frame.repeat(2); 3]);
        assert_eq!(frames(&["check"]), vec![vec![1, 2, 2, 4]; 3]);
        assert_eq!(frames(&["noise"]), vec![vec![0xFF, 0x00, 0xA5, 1, 2, 3, 4]; 3]);
        assert_eq!(frames(&["noise=1"]), vec![vec![0xFF, 1, 2, 3, 4]; 3]);
        assert_eq!(frames(&["dribble", "lose"]), [[1], [2], [3], [4]]);
        assert_eq!(frames(&["silence@0.1", "close@1"]), vec![frame; 3]);
    }

    #[test]
    fn a_late_frame_comes_in_time_and_in_order() {
        let faults = ["late=200@0.1"].map(|text| text.parse().expect("a fault"));
        let mut robot = Faulty::new(Robot::default(), &faults).expect("a robot");
        let frames = [(); 5].map(|()| {
            let count = robot.take_frames().len();
            robot.pass(Duration::from_millis(100)).expect("time");
            count
        });
        assert_eq!(frames, [1, 0, 0, 1, 1]);
    }

    #[test]
    fn a_fault_begins_when_it_is_due() {
        let faults = ["bumper@0.2", "close@0.3", "emergency"].map(|text| text.parse().expect("a fault"));
        let mut robot = Faulty::new(Robot::default(), &faults).expect("a robot");
        let mut pass = || {
            let passed = robot.pass(Duration::from_millis(100));
            (robot.robot().0.clone(), passed.is_ok(), robot.is_closed())
        };
        let (first, both) = (vec![Ailment::Emergency], vec![Ailment::Emergency, Ailment::Bumper]);
        assert_eq!([pass(), pass(), pass()], [(first, true, false), (both.clone(), true, false), (both, false, true)]);
    }

    #[test]
    fn what_is_no_fault_or_none_of_this_robot_is_refused() {
        for (text, message) in [
            ("smoke@1", "the faults are noise, dribble, check,"),
            ("bumper=1", "`bumper=1`: noise and late take a whole number"),
            ("noise=", "`noise=`: noise and late take a whole number"),
            ("late=60001", "`late=60001`: noise and late take a whole number"),
            ("bumper@", "after the @: `` is not a number with a unit"),
            ("late=2s5", "`late=2s5`: noise and late take a whole number"),
            ("late=1.5", "`late=1.5`: noise and late take a whole number"),
            ("bumper@-1", "after the @: expected a time from 0ns to 1000000s"),
            ("bumper@nan", "after the @: `nan` is not a number with a unit"),
            ("bumper@2m", "after the @: `2m` is a length: expected a time in s, ms, min, h"),
            ("bumper@1e9", "after the @: expected a time from 0ns"),
        ] {
            assert!(text.parse::<ScheduledFault>().is_err_and(|error| error.starts_with(message)), "{text}");
        }
        for (text, same) in [("late=2500ms@1500ms", "late=2500@1.5"), ("late=2.5s@1min", "late=2500@60")] {
            assert_eq!(text.parse::<ScheduledFault>(), same.parse::<ScheduledFault>(), "{text}");
        }
        let filler = ["filler@3"].map(|text| text.parse().expect("a fault"));
        let refused = Faulty::new(Robot::default(), &filler).map(|_| ());
        assert_eq!(refused, Err("--fault filler: this robot cannot have that".to_owned()));
    }
}
