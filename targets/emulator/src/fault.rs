//! What can go wrong with a robot on command: on its line, whatever it speaks, or in its body.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use mdle_sim::Disc;

use crate::serve::{Embodied, Emulated};

/// The longest time that can be given, in seconds.
const LATEST: f64 = 1e6;
/// What is on a line that nobody has shielded.
const NOISE: [u8; 3] = [0xFF, 0x00, 0xA5];

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Bytes that mean nothing come before each frame.
    Noise,
    /// Frames come byte by byte.
    Dribble,
    /// In each frame a bit is wrong.
    Check,
    /// Each frame but every third is lost.
    Lose,
    /// Each frame comes twice.
    Double,
    /// No frame comes.
    Silence,
    /// The line is closed.
    Close,
    /// What the body suffers.
    Body(Ailment),
}

/// What goes wrong with the robot itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ailment {
    /// The right side does not move.
    StuckWheel,
    /// The sonar in front hears nothing.
    DeadSonar,
    /// The first bumper is in contact.
    Bumper,
    /// The emergency stop is pressed.
    Emergency,
    /// The battery is low.
    LowBattery,
    /// The charger is plugged in.
    PluggedIn,
    /// Bytes that a reader must skip are in each frame.
    Filler,
    /// It tells the same of itself again and again.
    Hang,
    /// Its sonars no longer ping.
    NoPings,
}

/// All of them, with what `--fault` calls them.
const KINDS: [(&str, Fault); 16] = [
    ("noise", Fault::Noise),
    ("dribble", Fault::Dribble),
    ("check", Fault::Check),
    ("lose", Fault::Lose),
    ("double", Fault::Double),
    ("silence", Fault::Silence),
    ("close", Fault::Close),
    ("stuck-wheel", Fault::Body(Ailment::StuckWheel)),
    ("dead-sonar", Fault::Body(Ailment::DeadSonar)),
    ("bumper", Fault::Body(Ailment::Bumper)),
    ("emergency", Fault::Body(Ailment::Emergency)),
    ("low-battery", Fault::Body(Ailment::LowBattery)),
    ("plugged-in", Fault::Body(Ailment::PluggedIn)),
    ("filler", Fault::Body(Ailment::Filler)),
    ("hang", Fault::Body(Ailment::Hang)),
    ("no-pings", Fault::Body(Ailment::NoPings)),
];

/// A fault, and how long after the robot was switched on it begins, by the time of its world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct At {
    /// What.
    pub fault: Fault,
    /// When.
    pub time: Duration,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = KINDS.iter().find(|(_, fault)| fault == self).map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

impl FromStr for At {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, seconds) = text.split_once('@').unwrap_or((text, "0"));
        let fault = KINDS.iter().find(|(known, _)| *known == name).map(|(_, fault)| *fault);
        let fault = fault.ok_or_else(|| format!("the faults are {}", KINDS.map(|(name, _)| name).join(", ")))?;
        let seconds = seconds.parse().ok().filter(|seconds| (0.0..=LATEST).contains(seconds));
        let seconds = seconds.ok_or("seconds are meant behind the @, as in `silence@2.5`")?;
        Ok(Self { fault, time: Duration::from_secs_f64(seconds) })
    }
}

/// A robot with which something goes wrong.
#[allow(missing_debug_implementations, reason = "a robot need not have one")]
pub struct Faulty<R> {
    robot: R,
    /// What is still to come, and what goes wrong by now.
    coming: Vec<At>,
    begun: Vec<Fault>,
    /// How long it has been on.
    age: Duration,
    /// How many frames it has had to say.
    count: u32,
}

impl<R: Emulated> Faulty<R> {
    /// A robot that has just been switched on.
    ///
    /// # Errors
    /// It cannot suffer one of these.
    pub fn new(robot: R, faults: &[At]) -> Result<Self, String> {
        let cannot = faults.iter().find(|at| matches!(at.fault, Fault::Body(ailment) if !R::can_suffer(ailment)));
        if let Some(At { fault, .. }) = cannot {
            return Err(format!("--fault {fault}: this robot cannot have that"));
        }
        let mut faulty = Self { robot, coming: faults.to_vec(), begun: Vec::new(), age: Duration::ZERO, count: 0 };
        faulty.begin();
        Ok(faulty)
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &R {
        &self.robot
    }

    /// Whether the line is closed.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.has(Fault::Close)
    }

    fn has(&self, fault: Fault) -> bool {
        self.begun.contains(&fault)
    }

    /// Whatever is due begins.
    fn begin(&mut self) {
        for At { fault, .. } in self.coming.extract_if(.., |at| at.time <= self.age) {
            self.begun.push(fault);
            if let Fault::Body(ailment) = fault {
                self.robot.suffer(ailment);
            }
        }
    }

    /// What becomes of a frame on the line, in the pieces in which it comes.
    fn sent(&mut self, mut frame: Vec<u8>) -> Vec<Vec<u8>> {
        self.count = self.count.wrapping_add(1);
        if self.has(Fault::Silence) || self.has(Fault::Lose) && !self.count.is_multiple_of(3) {
            return Vec::new();
        }
        let middle = frame.len() / 2;
        if let Some(byte) = frame.get_mut(middle).filter(|_| self.begun.contains(&Fault::Check)) {
            *byte ^= 1;
        }
        if self.has(Fault::Noise) {
            frame.splice(..0, NOISE);
        }
        if self.has(Fault::Double) {
            // At once: on a line the second would come right behind the first.
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

    fn said(&mut self) -> Vec<Vec<u8>> {
        let frames = self.robot.said();
        frames.into_iter().flat_map(|frame| self.sent(frame)).collect()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}

impl<R: Embodied> Embodied for Faulty<R> {
    fn disc(&self) -> Disc {
        self.robot.disc()
    }

    fn see(&mut self, others: &[Disc]) {
        self.robot.see(others);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that says the same frame in each period, and can suffer all but filler.
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

        fn said(&mut self) -> Vec<Vec<u8>> {
            vec![vec![1, 2, 3, 4]]
        }

        fn can_suffer(ailment: Ailment) -> bool {
            ailment != Ailment::Filler
        }

        fn suffer(&mut self, ailment: Ailment) {
            self.0.push(ailment);
        }
    }

    /// The pieces of three frames with these faults.
    fn said(faults: &[&str]) -> Vec<Vec<u8>> {
        let faults: Vec<At> = faults.iter().map(|text| text.parse().expect("a fault")).collect();
        let mut robot = Faulty::new(Robot::default(), &faults).expect("a robot");
        (0..3).flat_map(|_| robot.said()).collect()
    }

    #[test]
    fn frames_are_lost_and_doubled_and_damaged() {
        let frame = vec![1, 2, 3, 4];
        assert_eq!(said(&[]), vec![frame.clone(); 3]);
        assert_eq!(said(&["silence"]), [[0_u8; 0]; 0]);
        assert_eq!(said(&["lose"]), vec![frame.clone()]);
        assert_eq!(said(&["double"]), vec![frame.repeat(2); 3]);
        assert_eq!(said(&["check"]), vec![vec![1, 2, 2, 4]; 3]);
        assert_eq!(said(&["noise"]), vec![vec![0xFF, 0x00, 0xA5, 1, 2, 3, 4]; 3]);
        assert_eq!(said(&["dribble", "lose"]), [[1], [2], [3], [4]]);
        assert_eq!(said(&["silence@0.1", "close@1"]), vec![frame; 3]);
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
        for (text, said) in [
            ("smoke@1", "the faults are noise, dribble, check,"),
            ("bumper@", "seconds are meant behind the @"),
            ("bumper@-1", "seconds are meant behind the @"),
            ("bumper@nan", "seconds are meant behind the @"),
            ("bumper@1e9", "seconds are meant behind the @"),
        ] {
            assert!(text.parse::<At>().is_err_and(|error| error.starts_with(said)), "{text}");
        }
        let filler = ["filler@3"].map(|text| text.parse().expect("a fault"));
        let refused = Faulty::new(Robot::default(), &filler).map(|_| ());
        assert_eq!(refused, Err("--fault filler: this robot cannot have that".to_owned()));
    }
}
