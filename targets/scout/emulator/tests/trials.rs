//! Runs the shared tests of robots on a serial line with the Super Scout and its driver, over a pseudo-terminal in
//! lockstep.

use std::time::Duration;

use mdle_conformance::Suite;
use mdle_emulator::MotionOrder::{Drive, LetGo, Stand};
use mdle_emulator::Speed::{Ahead, Halts};
use mdle_emulator::WheelMotion::{Moves, Still};
use mdle_emulator::{Effect, OnItsLine, OrderLog, Trial, WheelMotion, memory_asked_for, untrue_effects};
use mdle_runtime::Pose;
use mdle_scout::{Scout, alphabet};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_simulator::{Body, Simulated};

#[path = "../../../emulator/tests/counting/mod.rs"]
mod counting;

/// The robot of these tests.
enum Robot {}

impl Trial for Robot {
    type Driver = Scout;
    type Alphabet = alphabet::Alphabet;
    type Emulated = Emulated;
    const BODY: Body = Body::Scout;

    fn emulated(body: Simulated, _: Duration) -> Result<Emulated, String> {
        Emulated::new(body)
    }

    fn pose(robot: &Emulated) -> Pose {
        robot.pose()
    }

    fn motion(robot: &Emulated) -> WheelMotion {
        if robot.stands() { Still } else { Moves }
    }

    fn orders(robot: &Emulated) -> &OrderLog {
        robot.orders()
    }
}

const EFFECTS: &[Effect] = &[
    Effect::of(&["noise"], Still, &[LetGo]),
    Effect::of(&["noise=1"], Still, &[LetGo]),
    Effect::of(&["noise=400"], Still, &[LetGo]),
    Effect::of(&["dribble"], Still, &[LetGo]),
    Effect::of(&["double"], Still, &[LetGo]),
    Effect::of(&["low-battery"], Still, &[LetGo]),
    Effect::of(&["plugged-in"], Still, &[LetGo]),
    Effect::of(&["bumper"], Still, &[LetGo]).feels_contact(),
    Effect::of(&["dead-sonar"], Still, &[LetGo]).hears_nothing_ahead(),
    Effect::of(&["stuck-wheel"], Still, &[LetGo]).turns_right(),
    Effect::of(&["emergency"], Still, &[LetGo]).fails("emergency stop is pressed"),
    Effect::of(&["check"], Still, &[LetGo]).fails("add up to").stop_fails("add up to"),
    Effect::of(&["lose"], Still, &[LetGo]).fails("does not answer").stop_fails("does not answer"),
    // A robot that falls silent receives the stop command repeatedly.
    Effect::of(&["silence"], Still, &[Stand, Stand, Stand, Stand, Stand, LetGo])
        .fails("does not answer")
        .stop_fails("does not answer"),
    Effect::of(&["close"], Moves, &[Drive]).fails("line was cut").stop_fails("line was cut"),
    // A robot that ignores commands and keeps its speed appears to obey while that speed is commanded.
    Effect::of(&["runaway"], Moves, &[LetGo]).stop_fails("still moved"),
    Effect::of(&["runaway"], Moves, &[LetGo]).asked(Halts, 50).fails("does not obey").stop_fails("still moved"),
    Effect::of(&["deaf"], Moves, &[Drive]).fails("does not answer").stop_fails("does not answer"),
    Effect::of(&["hang"], Still, &[LetGo]).fails("clock has not advanced").stop_fails("still moved"),
    // The fault is detected only after the robot has moved for a metre.
    Effect::of(&["no-pings"], Still, &[LetGo]).asked(Ahead, 90).fails("sonars say the same"),
    Effect::of(&["leap"], Still, &[LetGo]).fails("leap"),
];

const REFUSALS: &[(&str, &str)] = &[("emergency", "emergency stop is pressed"), ("silence", "does not answer")];

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
