//! Conformance suite: the behaviour that an alphabet's capabilities require of any robot. A robot's author runs it on
//! the robot itself or on a robot emulator.
//!
//! A [`Stage`] puts the robot into rooms that the suite creates, and reports the true pose of its body,
//! independently of the robot's own data. One test then checks every capability that the alphabet claims:
//!
//! ```text
//! #[test]
//! fn it_conforms() {
//!     let report = Suite::on(&mut MyStage).diff_drive().odometry().bumper().sonar().paths().report();
//!     assert!(report.holds(), "{report}");
//! }
//! ```
//!
//! The suite uses std, as tests do; it is not part of a robot's executable.

mod body;
mod contact;
mod drive;
mod laws;
mod measured;
mod odometry;
mod power;
mod replay;
mod report;
mod ring;
mod room;
mod round;
mod sides;
mod stored_path;
mod trial;

use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, Paths, Power, SonarRing};
use mdle_runtime::{Alphabet, Nanos, PathStore, Pose, Robot, Twist};

pub use report::{Checked, Report, Verdict};
pub use room::{Room, Wall};

/// Test environment of a robot: builds a room around the robot and measures the true pose of its body.
pub trait Stage {
    /// The robot.
    type Robot: Robot<Input = Twist>;
    /// The robot's alphabet, as `mdlec bind` wrote it.
    type Alphabet: Alphabet<Output = <Self::Robot as Robot>::Output, Input = Twist>;
    /// Duration of an exchange: `alphabet::PERIOD`.
    const PERIOD: Nanos;

    /// Returns a robot that has just been started, at rest in this room at this pose, before its first exchange. It
    /// replaces any earlier robot.
    ///
    /// # Errors
    /// Fails with a message if there is no robot to return.
    fn robot(&mut self, room: &Room, at: Pose) -> Result<Self::Robot, String>;

    /// Passes the paths that the robot's plan replays to the robot, before its first exchange; for robots with
    /// the capability `paths`.
    fn take_paths(&mut self, _robot: &mut Self::Robot, _paths: PathStore) {}

    /// Sets the robot's power supply from now on; for robots with the capability `power`.
    fn supply(&mut self, _robot: &mut Self::Robot, _supplied: Supplied) {}

    /// Returns the true pose of the body, in room coordinates; odometry may differ.
    fn truth(&self, robot: &Self::Robot) -> Pose;

    /// Lets `periods` periods pass without an exchange.
    fn left_alone(&mut self, robot: &mut Self::Robot, periods: u32);
}

/// The power supply of a robot on a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Supplied {
    /// A charged battery, as when the robot has just been started.
    Well,
    /// A battery that has to be charged.
    Low,
    /// The robot's charger.
    Plugged,
}

/// The output of the robot on this stage.
type Out<S> = <<S as Stage>::Robot as Robot>::Output;

/// A suite of checks for one robot, with a method for each capability, and the verdicts so far.
#[derive(Debug)]
pub struct Suite<'s, S: Stage> {
    stage: &'s mut S,
    asked: Vec<&'static str>,
    checked: Vec<Checked>,
}

/// Function that runs one check of the robot on a stage.
type Check<S> = fn(&mut S) -> Result<(), Verdict>;

impl<'s, S: Stage> Suite<'s, S> {
    /// Returns a suite in which no check has run yet.
    #[must_use]
    pub fn on(stage: &'s mut S) -> Self {
        Self { stage, asked: Vec::new(), checked: Vec::new() }
    }

    /// Checks `diff_drive`: the motion that an input causes, stops, and the laws that need no other capability.
    #[must_use]
    pub fn diff_drive(self) -> Self
    where
        Out<S>: DiffDrive,
    {
        self.check(
            "diff_drive",
            &[
                ("its measures are those of a body", body::is_plausible),
                ("without an input it is at rest", drive::rests),
                ("an input that is no number moves nothing", drive::ignores_what_is_no_number),
                ("forward is forward, as fast as it was told", drive::goes_forward),
                ("a positive turn rate turns counter-clockwise, as fast as it was told", drive::turns),
                ("both at once drive an arc", drive::goes_round),
                ("it reaches what the alphabet lets plans ask of `go`", drive::reaches_its_limits),
                ("stopped, it stands", drive::stops),
                ("`go` drives on for ever", laws::go),
                ("`stop` stands still for ever", laws::stop),
            ],
        )
    }

    /// Checks `odometry`: compares the reported motion with the true motion of the body, and runs the laws that turn by
    /// odometry.
    #[must_use]
    pub fn odometry(self) -> Self
    where
        Out<S>: Odometry,
    {
        self.check(
            "odometry",
            &[
                ("the way it counts is the way it went", odometry::counts_the_way),
                ("the heading it counts is the way it turned", odometry::counts_turns),
                ("its axes stay put while it turns", odometry::keeps_its_axes),
                ("its heading goes on where a circle ends", odometry::goes_round),
                ("the speed it measures is that of the body", odometry::measures_speed),
                ("the turn rate it measures is that of the body", odometry::measures_turn_rate),
                ("`x`, `y`, `theta`, `v` and `omega` are in SI units", odometry::signals),
                ("`rotate` turns to a heading and stands there", laws::rotate),
                ("`turn` turns by an angle and stands there", laws::turn),
            ],
        )
    }

    /// Checks `bumper`: contact is reported only while the body touches a wall.
    #[must_use]
    pub fn bumper(self) -> Self
    where
        Out<S>: Bumpers + DiffDrive,
    {
        self.check("bumper", &[("it is pressed in contact, not before and not after", contact::is_felt)])
    }

    /// Checks `sonar[16]`: the range and the direction of each sonar, and the quarks that use them.
    #[must_use]
    pub fn sonar(self) -> Self
    where
        Out<S>: SonarRing + DiffDrive,
    {
        self.check(
            "sonar[16]",
            &[
                ("its measures are those of a ring on the body", body::has_a_ring),
                ("each of the sixteen looks where its number says", ring::looks_all_round),
                ("where nothing is, nothing is heard", ring::hears_nothing),
                ("what comes near is heard nearer, up to contact", ring::hears_what_comes),
                ("a ping says when and where it was taken", ring::dates_its_pings),
                ("`atIsection` tells the four sides apart", sides::at_isection),
                ("`align` turns square to a wall", laws::align),
                ("`goAvoid` arrives where it was sent", round::arrives),
                ("`goAvoid` touches no wall", round::touches_nothing),
            ],
        )
    }

    /// Checks `paths`: the output has the paths that the robot was given, and the law `path` replays one.
    #[must_use]
    pub fn paths(self) -> Self
    where
        Out<S>: Paths,
    {
        self.check(
            "paths",
            &[
                ("each output has the paths that the robot was given", replay::are_there),
                ("`path` drives along one, and is done at its end", replay::replays),
            ],
        )
    }

    /// Checks `power`: the battery's voltage, the low-battery state, and the charger.
    #[must_use]
    pub fn power(self) -> Self
    where
        Out<S>: Power,
    {
        self.check(
            "power",
            &[
                ("it tells the battery's voltage, and when it is low", power::battery),
                ("it tells whether it is on its charger", power::charger),
            ],
        )
    }

    /// Returns the verdicts on the checks and on the alphabet's claims: each claimed capability must have been checked,
    /// and each checked capability claimed.
    #[must_use]
    pub fn report(self) -> Report {
        Report::new(self.checked, &self.asked, S::Alphabet::CAPABILITIES)
    }

    fn check(mut self, capability: &'static str, checks: &[(&'static str, Check<S>)]) -> Self {
        self.asked.push(capability);
        for (name, check) in checks {
            let verdict = check(self.stage).err().unwrap_or(Verdict::Holds);
            self.checked.push(Checked { capability, name, verdict });
        }
        self
    }
}
