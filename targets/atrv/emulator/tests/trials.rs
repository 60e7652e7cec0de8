//! Runs the shared tests of robots on a serial line with the ATRV-mini and its driver, over a pseudo-terminal in
//! lockstep.

use std::time::Duration;

use mdle_atrv::{Atrv, alphabet};
use mdle_atrv_emulator::atrv::{Atrv as Emulated, step};
use mdle_conformance::Suite;
use mdle_emulator::MotionOrder::{Brake, Drive, Stand};
use mdle_emulator::Speed::{Ahead, Halts, Rests};
use mdle_emulator::WheelMotion::{Braked, Moves, Still};
use mdle_emulator::{Effect, OnItsLine, OrderLog, Pace, Trial, WheelMotion, memory_asked_for, untrue_effects};
use mdle_runtime::Pose;
use mdle_simulator::{Body, Simulated};

#[path = "../../../emulator/tests/counting/mod.rs"]
mod counting;

/// The robot of these tests.
enum Robot {}

impl Trial for Robot {
    type Driver = Atrv;
    type Alphabet = alphabet::Alphabet;
    type Emulated = Emulated;
    const BODY: Body = Body::Atrv;

    fn step(pace: Pace) -> Duration {
        step(pace)
    }

    fn emulated(body: Simulated, step: Duration) -> Result<Emulated, String> {
        Emulated::new(body, step, false)
    }

    fn pose(robot: &Emulated) -> Pose {
        robot.pose()
    }

    fn motion(robot: &Emulated) -> WheelMotion {
        match (robot.velocity().v.0 == 0.0, robot.is_braked()) {
            (false, _) => Moves,
            (true, false) => Still,
            (true, true) => Braked,
        }
    }

    fn orders(robot: &Emulated) -> &OrderLog {
        robot.orders()
    }
}

const EFFECTS: &[Effect] = &[
    Effect::of(&["noise"], Braked, &[Brake]),
    Effect::of(&["dribble"], Braked, &[Brake]),
    Effect::of(&["double"], Braked, &[Brake]),
    Effect::of(&["filler"], Braked, &[Brake]),
    Effect::of(&["low-battery"], Braked, &[Brake]),
    Effect::of(&["plugged-in"], Braked, &[Brake]),
    Effect::of(&["bumper"], Braked, &[Brake]).feels_contact(),
    Effect::of(&["dead-sonar"], Braked, &[Brake]).hears_nothing_ahead(),
    Effect::of(&["stuck-wheel"], Braked, &[Brake]).turns_right(),
    Effect::of(&["emergency"], Braked, &[Brake]).fails("brake is set"),
    Effect::of(&["check"], Braked, &[Brake]).fails("the check of a frame").stop_fails("the check of a frame"),
    Effect::of(&["lose"], Braked, &[Brake]).fails("the ATRV does not").stop_fails("the ATRV does not").may_stop(),
    // A robot that falls silent is commanded to stop before its brake is set.
    Effect::of(&["silence"], Braked, &[Stand, Stand, Stand, Stand, Stand, Stand, Stand, Stand, Brake])
        .fails("does not answer")
        .stop_fails("does not answer"),
    Effect::of(&["close"], Moves, &[Drive]).fails("line was cut").stop_fails("line was cut"),
    // A robot that ignores commands and keeps its speed appears to obey while that speed is commanded.
    Effect::of(&["runaway"], Moves, &[Brake]).stop_fails("still moved"),
    Effect::of(&["runaway"], Moves, &[Brake]).asked(Halts, 50).fails("does not obey").stop_fails("still moved"),
    Effect::of(&["runaway"], Still, &[Brake]).asked(Rests, 42).stop_fails("brake is not set"),
    // A robot that receives nothing: its controller stops it after a second without commands.
    Effect::of(&["deaf"], Still, &[Drive]).fails("does not receive").stop_fails("does not receive"),
    Effect::of(&["deaf", "runaway"], Moves, &[Drive]).fails("does not receive").stop_fails("still moved"),
    // The run ends before a missing answer is a fault, and after the robot has stopped itself.
    Effect::of(&["deaf"], Still, &[Drive]).asked(Ahead, 42).stop_fails("does not receive"),
    Effect::of(&["hang"], Braked, &[Brake]).fails("clock has not advanced").stop_fails("clock has not"),
    Effect::of(&["no-pings"], Braked, &[Brake]).fails("sonars in direction"),
    Effect::of(&["no-bumpers"], Braked, &[Brake]).fails("does not report its front bumper"),
    Effect::of(&["leap"], Braked, &[Brake]).fails("leap"),
    // If the position of an axis is missing, no report shows that the robot is at rest; without status reports, none
    // shows that its brake is set.
    Effect::of(&["no-translation"], Braked, &[Brake]).fails("how far it has moved, only").stop_fails("how far"),
    Effect::of(&["no-rotation"], Braked, &[Brake]).fails("how far it has turned, only").stop_fails("how far"),
    Effect::of(&["no-status"], Braked, &[Brake]).fails("does not receive").stop_fails("does not receive"),
];

const REFUSALS: &[(&str, &str)] = &[
    ("no-bumpers", "does not report its front bumper"),
    ("no-translation", "how far it has moved, only"),
    ("no-rotation", "how far it has turned, only"),
    ("no-status", "does not receive"),
    ("silence", "does not answer"),
];

#[test]
fn the_driver_conforms() {
    let mut stage = OnItsLine::<Robot>::default();
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}

#[test]
fn each_fault_has_its_effect() {
    let untrue = untrue_effects::<Robot>(EFFECTS, REFUSALS);
    assert!(untrue.is_empty(), "{untrue:#?}");
}

#[test]
fn a_turn_allocates_nothing() {
    assert_eq!(memory_asked_for::<Robot>(counting::asked), Ok(0));
}
