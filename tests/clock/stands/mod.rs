//! Tests executables by the clock on an emulated robot that receives nothing, does not obey, answers late or no longer
//! reports something, and programs that were suspended. The tests check the last command that the robot received, and
//! that the robot does not move.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "how long it took is seen with --nocapture")]

mod run;
mod timed;

use std::process::Child;
use std::time::{Duration, Instant};
use std::{fs, thread};

use mdle_atrv_emulator::atrv::Atrv;
use mdle_emulator::{MotionOrder, OrderLog};
use mdle_scout_emulator::scout::Scout;
use rustix::process::{Pid, Signal, kill_process};

use self::run::{BEGINS, Ran, Robot, Way, executable, ran};
use super::at_once;

fn alone<R: Robot>(faults: &[&str]) -> Ran<R> {
    ran(faults, &[], Way::Terminal, |_, _| {})
}

pub(crate) fn robots_stand_at_every_end_of_a_run() {
    at_once(&[
        a_robot_without_a_fault_ends_as_the_plan_says,
        an_atrv_that_receives_nothing_ends_the_plan,
        an_atrv_that_is_not_braked_is_reported,
        a_scout_that_receives_nothing_ends_the_plan,
        a_robot_that_does_not_obey_ends_the_plan,
        a_stop_without_rest_is_reported,
        each_kind_of_report_of_an_atrv_that_stops_ends_the_plan,
        a_scout_that_answers_late_ends_as_the_plan_says,
        an_atrv_that_falls_silent_stands_before_it_is_braked,
        a_robot_that_only_receives_stands_before_it_is_let_go,
        noise_on_the_line_of_a_scout_is_borne,
        a_robot_is_not_driven_off_after_a_suspension,
    ]);
}

/// Runs these functions for both robots at the same time, and returns their results.
fn both(scout: impl FnOnce() -> Ran<Scout> + Send, atrv: impl FnOnce() -> Ran<Atrv> + Send) -> (Ran<Scout>, Ran<Atrv>) {
    thread::scope(|scope| {
        let scout = scope.spawn(scout);
        let atrv = atrv();
        (scout.join().unwrap(), atrv)
    })
}

fn a_robot_without_a_fault_ends_as_the_plan_says() {
    let (scout, atrv) = both(|| alone(&[]), || alone(&[]));
    scout.assert(0, &["plan over"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    atrv.assert(0, &["plan over"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
    assert!(scout.robot.stands() && atrv.robot.stands() && atrv.robot.is_braked());
}

fn an_atrv_that_receives_nothing_ends_the_plan() {
    // One robot stops by itself after a second and is connected by a serial line; the other drives on and is connected
    // over TCP.
    let (ran_out, drives_on) = thread::scope(|scope| {
        let drives_on = scope.spawn(|| ran::<Atrv>(&["deaf", "runaway"], &[], Way::Tcp, |_, _| {}));
        (alone::<Atrv>(&["deaf"]), drives_on.join().unwrap())
    });
    ran_out.assert(3, &["may not have stopped", "does not receive"], &[MotionOrder::Drive]);
    assert!(ran_out.robot.stands() && !ran_out.robot.is_braked());
    drives_on.assert(3, &["may not have stopped", "does not"], &[MotionOrder::Drive]);
    assert!(!drives_on.robot.stands());
}

fn an_atrv_that_is_not_braked_is_reported() {
    // The run ends before the unanswered question counts as a fault; meanwhile the robot stops by itself.
    let ran = ran::<Atrv>(&["deaf"], &["--timeout", "3.6"], Way::Terminal, |_, _| {});
    ran.assert(3, &["--timeout", "may not have stopped", "does not receive"], &[MotionOrder::Drive]);
    assert!(ran.robot.stands() && !ran.robot.is_braked());
}

fn a_scout_that_receives_nothing_ends_the_plan() {
    let ran = alone::<Scout>(&["deaf"]);
    ran.assert(3, &["may not have stopped", "does not answer"], &[MotionOrder::Drive]);
    // The robot's own watchdog stops it.
    assert!(ran.robot.stands());
}

fn a_robot_that_does_not_obey_ends_the_plan() {
    let message = ["may not have stopped", "does not obey"];
    let (scout, atrv) = both(|| alone(&["runaway"]), || alone(&["runaway"]));
    scout.assert(3, &message, &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    atrv.assert(3, &message, &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
}

fn a_stop_without_rest_is_reported() {
    // The time limit is reached while the robot still obeys.
    let arguments = ["--timeout", "3.5"];
    let (scout, atrv) = both(
        || ran(&["runaway"], &arguments, Way::Terminal, |_, _| {}),
        || ran(&["runaway"], &arguments, Way::Terminal, |_, _| {}),
    );
    let message = ["--timeout", "still moved", "may not have stopped"];
    scout.assert(3, &message, &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    atrv.assert(3, &message, &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
}

fn each_kind_of_report_of_an_atrv_that_stops_ends_the_plan() {
    let kinds = [
        ("no-bumpers", "bumper"),
        ("no-translation", "how far it has moved"),
        ("no-rotation", "how far it has turned"),
        ("no-status", "does not receive"),
        ("no-pings", "sonars"),
        ("leap", "leap"),
    ];
    thread::scope(|scope| {
        for (fault, words) in kinds {
            scope.spawn(move || {
                let ran = alone::<Atrv>(&[fault]);
                ran.assert(3, &[words], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
                assert!(ran.robot.stands() && ran.robot.is_braked(), "{fault}");
            });
        }
    });
}

fn a_scout_that_answers_late_ends_as_the_plan_says() {
    let file = executable::<Scout>().with_file_name("late.toml");
    // An answer may take 400 ms; 200 ms of them are left for a busy machine.
    fs::write(&file, "answer = 400\nwatchdog = 5\n").unwrap();
    let arguments = ["--period", "0.5", "--config", file.to_str().unwrap()];
    let ran = ran::<Scout>(&["late=200"], &arguments, Way::Tcp, |_, _| {});
    ran.assert(0, &["plan over"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    assert!(ran.robot.stands());
}

fn an_atrv_that_falls_silent_stands_before_it_is_braked() {
    let ran = alone::<Atrv>(&["silence"]);
    ran.assert(
        3,
        &["may not have stopped", "does not answer"],
        &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake],
    );
    let orders: Vec<_> = ran.robot.orders().iter().collect();
    let drove = orders.iter().rposition(|(_, order)| *order == MotionOrder::Drive).unwrap();
    let (first, last) = (orders[drove + 1], orders[orders.len() - 1]);
    assert!(last.0 - first.0 >= Duration::from_millis(700), "{first:?} {last:?}");
}

fn a_robot_that_only_receives_stands_before_it_is_let_go() {
    let (scout, atrv) =
        both(|| ran(&[], &[], Way::HalfClosed, |_, _| {}), || ran(&[], &[], Way::HalfClosed, |_, _| {}));
    atrv.assert(3, &["may not have stopped", "cut"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
    scout.assert(3, &["may not have stopped", "cut"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    for orders in [atrv.robot.orders(), scout.robot.orders()] {
        let orders: Vec<_> = orders.iter().collect();
        let drove = orders.iter().rposition(|(_, order)| *order == MotionOrder::Drive).unwrap();
        let (first, last) = (orders[drove + 1], orders[orders.len() - 1]);
        assert!(last.0 - first.0 >= Duration::from_millis(400), "{first:?} {last:?}");
    }
}

fn noise_on_the_line_of_a_scout_is_borne() {
    let ran = alone::<Scout>(&["noise=40"]);
    ran.assert(0, &["plan over"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
}

/// Suspends the program for longer than the timeout of any watchdog, and then continues it.
fn suspended(child: &Child, begun: Instant) {
    let signal = |signal| kill_process(Pid::from_child(child), signal).unwrap();
    thread::sleep(BEGINS.saturating_sub(begun.elapsed()));
    signal(Signal::STOP);
    thread::sleep(Duration::from_secs(3));
    signal(Signal::CONT);
}

fn a_robot_is_not_driven_off_after_a_suspension() {
    let (scout, atrv) = both(|| ran(&[], &[], Way::Terminal, suspended), || ran(&[], &[], Way::Terminal, suspended));
    scout.assert(3, &["a fault stopped the robot"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::LetGo]);
    atrv.assert(3, &["a fault stopped the robot"], &[MotionOrder::Drive, MotionOrder::Stand, MotionOrder::Brake]);
    // The last order to drive came before the suspension.
    let drove = |orders: &OrderLog| orders.iter().rfind(|(_, order)| *order == MotionOrder::Drive).unwrap().0;
    for last in [drove(scout.robot.orders()), drove(atrv.robot.orders())] {
        assert!(last < BEGINS + Duration::from_secs(3), "{last:?}");
    }
    assert!(scout.robot.stands() && atrv.robot.stands());
}
