//! Tests options: help, invalid options, period, timeout and turn limit.

use std::time::Duration;

use mdle_runtime::Cause::Fired;

use super::toy::{Act, Stage};
use crate::{Pace, Time};

#[test]
fn help_lists_all_options_and_opens_no_robot() {
    let run = Stage::default().run(&["-h"]);
    assert_eq!((run.status, &*run.err, &*run.journal), (0, "", ""));
    insta::assert_snapshot!(run.out, @"
    Run the plan Lab on the robot toy

    Usage: lab_tour [OPTIONS]

    Options:
          --period <TIME>      Period of the control loop, in seconds or as in `50ms` [default: 0.1]
          --timeout <TIME>     Maximum duration of the plan, in seconds or as in `5min`; exit status 4 after it [default: none]
          --turns <N>          Maximum number of turns; exit status 4 after them [default: none]
          --log <FILE>         File for a log of the run, one JSON object per turn; `FILE.mcap` is a record to replay
          --log-best-effort    Let the run go on without its log if that cannot be written, and say so
          --watch              Show the robot on its floor, the running atom and the timers in this terminal
          --plot <FILE.svg>    Picture of the run: walls or echoes, trail, start of each atom, contacts
          --record <FILE.svg>  Animated picture of the run, for a browser
          --trail <FILE.csv>   File for the pose in each turn: seconds, metres, degrees
          --require <CAUSE>    Cause by which the plan must end, such as `bumper`; exit status 5 otherwise
          --device <PATH>      Where the toy is
      -h, --help               Print help (see more with '--help')

    Exit status:
      0      the plan ended
      2      invalid option, world or start pose
      3      a fault stopped the robot
      4      timeout or turn limit
      5      the plan ended otherwise than required
      128+N  terminated by signal N
    The robot is stopped at the end, except after SIGKILL, a crash or a lost line: then only its own watchdog stops it.
    ");
}

/// The outputs of the toy robot have a type of its own, without odometry.
#[test]
fn a_robot_without_known_odometry_has_no_views() {
    let refused = [&["--watch"][..], &["--plot", "run.svg"], &["--record", "run.svg"], &["--trail", "run.csv"]];
    for options in refused {
        let run = Stage::default().run(options);
        let option = options[0];
        let sentence = format!(
            "error: {option}: the robot toy has outputs of a type of its own, without the odometry by which a run is \
             drawn; leave {option} out\n"
        );
        assert_eq!((run.status, run.err, &*run.journal), (2, sentence, ""));
    }
}

#[test]
fn long_help_lists_all_exit_statuses_and_opens_no_robot() {
    let run = Stage::default().run(&["--help"]);
    assert_eq!((run.status, &*run.err, &*run.journal), (0, "", ""));
    let (_, statuses) = run.out.split_once("Exit status:\n").expect(&run.out);
    for status in ["  0 ", "  2 ", "  3 ", "  4 ", "  128+N "] {
        assert!(statuses.contains(status), "{status:?} is missing in {statuses}");
    }
    assert!(run.out.contains("from 100µs to 60s [default: 0.1]"), "{}", run.out);
}

#[test]
fn usage_names_the_executable_or_else_the_plan() {
    let usage = |program, option| {
        let run = Stage { program, ..Stage::default() }.run(&[option]);
        (run.out + &run.err).lines().find(|line| line.starts_with("Usage: ")).unwrap().to_owned()
    };
    assert_eq!(usage("bin/tour", "--help"), "Usage: tour [OPTIONS]");
    assert_eq!(usage("./tour", "--nonsense"), "Usage: tour [OPTIONS]");
    assert_eq!(usage("..", "--nonsense"), "Usage: Lab [OPTIONS]");
}

#[test]
fn a_bad_option_opens_no_robot() {
    let wrong: [&[&str]; 10] = [
        &["--period", "0"],
        &["--period", "-0.1"],
        &["--period", "NaN"],
        &["--timeout", "0"],
        &["--timeout", "-1"],
        &["--turns", "0"],
        &["--turns", "1.5"],
        &["--device", "/dev/null"],
        &["--sped"],
        &["plan.mdle"],
    ];
    for arguments in wrong {
        let run = Stage::default().run(arguments);
        assert_eq!((run.status, &*run.out, &*run.journal), (2, "", ""), "{arguments:?}");
        assert!(run.err.starts_with("error: "), "{arguments:?}: {}", run.err);
    }
    let tip = |option: &str| Stage::default().run(&[option]).err.contains("a similar argument exists: '--period'");
    assert_eq!(["--perid", "--peroid=1", "--speed", "--record"].map(tip), [true, true, false, false]);
    insta::assert_snapshot!(Stage::default().run(&["--period=0"]).err, @"
    error: invalid value '0' for '--period <TIME>': expected a time from 100µs to 60s

    For more information, try '--help'.
    ");
}

#[test]
fn a_turn_limit_counts_turns() {
    let run = Stage::default().run(&["--turns", "3"]);
    assert_eq!(run.journal, "exchange 0, began 1 go 20 0 at 0, exchange 1, exchange 1, exchange 0, stop, finish");
    assert_eq!((run.status, &*run.err), (4, "stopped by --turns: the plan was not over after 3 turns\n"));
}

#[test]
fn a_turn_limit_of_one_applies_nothing() {
    let run = Stage::default().run(&["--turns", "1"]);
    assert_eq!(run.journal, "exchange 0, began 1 go 20 0 at 0, exchange 0, stop, finish");
    assert_eq!((run.status, &*run.err), (4, "stopped by --turns: the plan was not over after 1 turn\n"));
}

#[test]
fn a_timeout_is_in_the_time_of_the_plan() {
    let run = Stage::default().run(&["--timeout", "0.25", "--period", "0.1"]);
    assert_eq!(run.journal.matches("exchange 1").count(), 3, "turns at 0, 0.1, 0.2 and 0.3: {}", run.journal);
    assert_eq!((run.status, &*run.err), (4, "stopped by --timeout: the plan was not over after 0.25 s\n"));
}

#[test]
fn a_plan_that_is_over_at_its_limit_is_over() {
    let script = || [Act::Senses(vec![]), Act::Senses(vec![(0, Fired(0))])];
    assert_eq!(Stage::script(script()).run(&["--turns", "2", "--timeout", "0.1"]).status, 0);
    assert_eq!(Stage::script(script()).run(&["--turns", "1"]).status, 4);
}

#[test]
fn a_pace_decides_how_long_a_run_takes_and_nothing_else() {
    let at = |pace| Stage { time: Time::Stepped(pace), ..Stage::default() }.run(&["--timeout", "2", "--period", "0.5"]);
    let (real, fast, fastest) = (at(Pace::Times(1.0)), at(Pace::Times(10.0)), at(Pace::Max));
    assert_eq!(real.slept, Duration::from_secs(2));
    assert_eq!(fast.slept, Duration::from_millis(200));
    assert_eq!(fastest.slept, Duration::ZERO);
    assert_eq!((&real.journal, &real.out), (&fast.journal, &fast.out));
    assert_eq!((&real.journal, &real.out), (&fastest.journal, &fastest.out));
}

#[test]
fn missing_permissions_are_reported_once_in_real_time() {
    let at = |time| Stage { time, ..Stage::default() }.run(&["--turns", "3"]).err;
    assert_eq!(at(Time::Stepped(Pace::Times(1.0))), "stopped by --turns: the plan was not over after 3 turns\n");
    insta::assert_snapshot!(at(Time::Wall).lines().take(3).collect::<Vec<_>>().join("\n"));
}
