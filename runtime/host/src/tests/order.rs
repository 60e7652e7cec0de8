//! Tests the inputs that a robot receives, and their order, for every kind of end.

use mdle_runtime::Cause::{Completed, Fired};

use super::toy::{Act, Run, Stage};
use crate::signals::ProcessSignal;
use crate::{Refusal, Time};

fn quiet() -> Act {
    Act::Senses(vec![])
}

/// Returns the robot's journal, the exit status and standard error, for a snapshot.
fn way_out(run: &Run) -> String {
    format!("{}\nstatus {}\n{}", run.journal, run.status, run.err)
}

#[test]
fn an_input_acts_one_turn_later_and_the_null_input_ends_a_plan() {
    let run = Stage::script([quiet(), quiet(), Act::Senses(vec![(0, Fired(0))])]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, exchange 1, exchange 0, stop, finish
    status 0
    ");
}

#[test]
fn only_the_atom_that_is_left_standing_has_begun() {
    let skip = Act::Senses(vec![(0, Fired(1)), (1, Completed(2))]);
    let again = Act::Senses(vec![(2, Fired(2)), (3, Fired(1))]);
    let run = Stage::script([quiet(), skip, quiet(), again]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, began 3 stop at 0.1, exchange 3, exchange 3, exchange 0, stop, finish
    status 0
    ");
}

#[test]
fn an_observer_gets_the_position_in_each_turn() {
    let skip = Act::Senses(vec![(0, Fired(1)), (1, Completed(2))]);
    let over = Act::Senses(vec![(2, Fired(0))]);
    let run = Stage { looks: true, ..Stage::script([quiet(), skip, quiet(), over]) }.run(&[]);
    insta::assert_snapshot!(way_out(&run).replace(", ", "\n"), @"
    exchange 0
    began 1 go 20 0 at 0
    1 go 20 0 in Lab[bumper] 0 [atIsection 0100] 0
    exchange 1
    began 3 stop at 0.1
    3 stop in Lab[bumper] 0.1 Turn[wait 10] 0 [r3 < r5] 0
    exchange 3
    3 stop in Lab[bumper] 0.2 Turn[wait 10] 0.1 [r3 < r5] 0.1
    exchange 3
    Lab over at 0.3 by bumper (Lab)
    exchange 0
    stop
    finish
    status 0
    ");
}

#[test]
fn a_plan_that_is_over_in_its_first_turn_is_never_applied() {
    let run = Stage::script([Act::Senses(vec![(0, Fired(0))])]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, exchange 0, stop, finish
    status 0
    ");
}

#[test]
fn a_robot_gets_the_reason_of_the_end() {
    let ended = |acts: Vec<Act>, arguments: &[&str]| {
        let run = Stage { looks: true, ..Stage::script(acts) }.run(arguments);
        run.journal.split(", ").find(|line| line.contains(" by ")).unwrap_or_default().to_owned()
    };
    assert_eq!(ended(vec![quiet()], &["--turns", "3"]), "Lab stopped at 0.2 by --turns");
    assert_eq!(ended(vec![quiet()], &["--timeout", "0.5"]), "Lab stopped at 0.5 by --timeout");
    assert_eq!(ended(vec![quiet(), Act::Fails("no answer")], &[]), "Lab stopped at 0 by a fault");
    assert_eq!(
        ended(vec![quiet(), quiet(), Act::Hears(ProcessSignal::TERMINATE)], &[]),
        "Lab stopped at 0.2 by SIGTERM"
    );
}

#[test]
fn a_robot_whose_exchange_failed_is_only_stopped() {
    let run = Stage::script([quiet(), Act::Fails("no answer within 300 ms")]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, stop, finish
    status 3
    error: a fault stopped the robot: no answer within 300 ms
    ");
}

#[test]
fn one_sentence_tells_of_a_fault_that_leaves_the_robot_unstopped() {
    let fails = |stop| Stage { stop: Act::Fails(stop), ..Stage::script([Act::Fails("the line is dead")]) };
    insta::assert_snapshot!(way_out(&fails("the line is dead").run(&[])), @"
    exchange 0, stop, finish
    status 3
    error: a fault ended the plan, and the robot may not have stopped: the line is dead
    ");
    assert_eq!(fails("no answer").run(&[]).err, fails("the line is dead").run(&[]).err);
}

#[test]
fn the_first_exchange_may_fail() {
    let run = Stage::script([Act::Fails("the emergency stop is pressed")]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, stop, finish
    status 3
    error: the plan was not started: the emergency stop is pressed
    ");
}

#[test]
fn a_fault_in_the_last_exchange_is_a_fault() {
    let run = Stage::script([Act::Senses(vec![(0, Fired(0))]), Act::Fails("no answer")]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, exchange 0, stop, finish
    status 3
    error: a fault stopped the robot: no answer
    ");
    assert_eq!(run.out, "0.0 s  plan over: bumper (Lab)\n");
}

#[test]
fn a_panic_stops_the_robot_and_asks_no_more_of_it() {
    let run = Stage::script([quiet(), Act::Panics("index out of bounds")]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, stop
    status 3
    error: a fault stopped the robot: its code or the plan's panicked, which is a bug: index out of bounds
    ");
}

#[test]
fn a_panic_in_the_last_exchange_stops_the_robot_too() {
    let run = Stage::script([Act::Hears(ProcessSignal::INTERRUPT), Act::Panics("oh")]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 0, stop
    status 3
    stopped by SIGINT
    error: a fault stopped the robot: its code or the plan's panicked, which is a bug: oh
    ");
}

#[test]
fn a_signal_replaces_the_next_input_by_the_null_input() {
    let run = Stage::script([quiet(), Act::Hears(ProcessSignal::INTERRUPT)]).run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, exchange 0, stop, finish
    status 130
    stopped by SIGINT
    ");
}

#[test]
fn each_signal_has_its_status() {
    let status = |signal| Stage::script([Act::Hears(signal)]).run(&[]).status;
    assert_eq!(
        [ProcessSignal::HANG_UP, ProcessSignal::INTERRUPT, ProcessSignal::TERMINATE].map(status),
        [129, 130, 143]
    );
}

#[test]
fn a_second_signal_while_the_robot_is_stopped_changes_nothing() {
    let script = [Act::Hears(ProcessSignal::TERMINATE), Act::Hears(ProcessSignal::INTERRUPT)];
    let run = Stage { stop: Act::Hears(ProcessSignal::HANG_UP), ..Stage::script(script) }.run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 0, stop, finish
    status 143
    stopped by SIGTERM
    ");
}

#[test]
fn a_stop_that_fails_is_a_fault_whatever_came_before() {
    let script = || [Act::Hears(ProcessSignal::INTERRUPT)];
    let run = Stage { stop: Act::Fails("the line is dead"), ..Stage::script(script()) }.run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 0, stop, finish
    status 3
    stopped by SIGINT
    error: the robot may not have stopped: the line is dead
    ");
    let run = Stage { stop: Act::Panics("oh"), ..Stage::script(script()) }.run(&[]);
    assert_eq!(run.status, 3);
    assert!(run.err.ends_with("error: the robot may not have stopped: its code panicked: oh\n"));
}

#[test]
fn what_cannot_be_finished_is_a_fault_of_a_plan_that_is_over_only() {
    let finish = || Err("plot.svg cannot be written".to_owned());
    let over = [Act::Senses(vec![(0, Fired(0))])];
    let run = Stage { finish: finish(), ..Stage::script(over) }.run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, exchange 0, stop, finish
    status 3
    error: plot.svg cannot be written
    ");
    let run = Stage { finish: finish(), ..Stage::script([Act::Hears(ProcessSignal::TERMINATE)]) }.run(&[]);
    assert_eq!(run.status, 143);
    assert_eq!(run.err, "stopped by SIGTERM\nerror: plot.svg cannot be written\n");
}

#[cfg(target_os = "linux")]
#[test]
fn failures_while_ending_are_reported_in_order() {
    let script = [Act::Hears(ProcessSignal::INTERRUPT), Act::Fails("no answer")];
    let finish = Err("plot.svg cannot be written".to_owned());
    let stage = Stage { stop: Act::Fails("the line is dead"), finish, ..Stage::script(script) };
    insta::assert_snapshot!(way_out(&stage.run(&["--log", "/dev/full"])), @"
    exchange 0, began 1 go 20 0 at 0, exchange 0, stop, finish
    status 3
    stopped by SIGINT
    error: a fault ended the plan, and the robot may not have stopped: no answer
    error: the run log cannot be written: No space left on device (os error 28)
    error: plot.svg cannot be written
    ");
}

#[test]
fn a_robot_that_cannot_be_opened_is_sent_nothing() {
    let refused = |refusal| way_out(&Stage { refusal: Some(refusal), time: Time::Wall, ..Stage::default() }.run(&[]));
    let usage = refused(Refusal::Usage("the start pose is inside a wall".to_owned()));
    let fault = refused(Refusal::Fault("nothing answers at /dev/ttyS0".to_owned()));
    assert_eq!(usage, "\nstatus 2\nerror: the start pose is inside a wall\n");
    assert_eq!(fault, "\nstatus 3\nerror: nothing answers at /dev/ttyS0\n");
}

#[test]
fn a_signal_at_the_start_stops_the_robot() {
    let interrupted = |refusal| Stage { interrupted: Some(ProcessSignal::INTERRUPT), refusal, ..Stage::default() };
    // A robot that ignores the stop request.
    insta::assert_snapshot!(way_out(&interrupted(None).run(&[])), @"
    exchange 0, stop, finish
    status 130
    stopped by SIGINT
    ");
    insta::assert_snapshot!(way_out(&interrupted(Some(Refusal::Ended(Ok(())))).run(&[])), @"

    status 130
    stopped by SIGINT
    ");
    let unstopped = Refusal::Ended(Err("the line is dead".to_owned()));
    insta::assert_snapshot!(way_out(&interrupted(Some(unstopped)).run(&[])), @"

    status 3
    stopped by SIGINT
    error: the robot may not have stopped: the line is dead
    ");
}

#[test]
fn no_fault_says_that_it_stopped_a_robot_that_may_not_have_stopped() {
    let script = [quiet(), Act::Panics("index out of bounds")];
    let run = Stage { stop: Act::Fails("the robot still moves"), ..Stage::script(script) }.run(&[]);
    insta::assert_snapshot!(way_out(&run), @"
    exchange 0, began 1 go 20 0 at 0, exchange 1, stop
    status 3
    error: a fault ended the plan: its code or the plan's panicked, which is a bug: index out of bounds
    error: the robot may not have stopped: the robot still moves
    ");
}

#[test]
fn a_robot_that_may_not_have_stopped_is_a_fault_whatever_ended_the_run() {
    let unstopped = |script: Vec<Act>, options: &[&str]| {
        let run = Stage { stop: Act::Fails("the robot still moves"), ..Stage::script(script) }.run(options);
        assert!(run.err.ends_with("error: the robot may not have stopped: the robot still moves\n"), "{}", run.err);
        run.status
    };
    assert_eq!(unstopped(vec![Act::Senses(vec![(0, Fired(0))])], &[]), 3);
    assert_eq!(unstopped(Vec::new(), &["--timeout", "1"]), 3);
    assert_eq!(unstopped(Vec::new(), &["--turns", "3"]), 3);
    assert_eq!(unstopped(vec![Act::Hears(ProcessSignal::TERMINATE)], &[]), 3);
}
