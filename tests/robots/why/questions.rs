//! Tests forty questions, each about a record of a few seconds, with snapshots of the answers.

use std::path::Path;

use mdle_runtime::{MetersPerSecond, Sensed};
use mdle_tests::executable::folder;

use super::asked;
use super::scripted::{outputs, ping, write};

/// Writes a record, and returns the answers to questions about it. A question is a time, or `--not` and an atom.
pub(super) fn answers(name: &str, plan: &str, outputs: &[Sensed], questions: &[&str]) -> String {
    let folder = folder(&format!("why-{name}"));
    let target = mdle_files::target(Some("sim")).unwrap();
    write(&folder, name, &target, plan, outputs);
    questions.iter().map(|question| one(&folder, name, question)).collect::<Vec<_>>().join("\n")
}

fn one(folder: &Path, name: &str, question: &str) -> String {
    let log = format!("{name}.mcap");
    let mut arguments = vec!["why", &log];
    match question.strip_prefix("--not ") {
        Some(atom) => arguments.extend(["--not", atom]),
        None => arguments.push(question),
    }
    asked(folder, &arguments)
}

/// The bumper is pressed a tenth of a second before the timer fires.
#[test]
fn a_timer_was_short() {
    let plan = "{ Timers (wait 10s)
  { Leg (bumper)
    (Atom (wait 3s) go 20 0)
    (Atom (wait 1s) go 10 0)
  }
  (Atom (wait 2s OR t > 1s) stop)
}
";
    let outputs = outputs(60, |turn, y| y.switches = u32::from(turn == 29));
    let questions = ["0", "2.8", "2.9", "2.95", "4.0s", "4.1", "--not go 10 0", "--not 4", "-1", "6", "1m", "soon"];
    insta::assert_snapshot!(answers("timers", plan, &outputs, &questions));
}

/// A behavior whose interrupt has fired when it is entered is skipped.
#[test]
fn behaviors_were_skipped() {
    let plan = "{ Skips (wait 4s)
  (Atom (wait 1s) go 20 0)
  { Near (r0 < 1m)
    (Atom (wait 1s) go 10 0)
    (Atom (wait 1s) go 5 0)
  }
  (Atom (NOT bumper) (go 4 0))
  (Atom (wait 1s) stop)
}
";
    let outputs = outputs(40, |_, y| ping(y, 0, 0.75));
    let questions = ["1", "0.9", "--not go 10 0", "--not Near", "--not go 5 0", "2"];
    insta::assert_snapshot!(answers("skips", plan, &outputs, &questions));
}

/// The outermost interrupt wins, although the inner interrupt and the law would have ended the atom too.
#[test]
fn conditions_were_shadowed() {
    let plan = "{ Outer (r0 < 50cm)
  { Middle (bumper OR r8 < 1m)
    (Atom (r4 < 2m) (turn 0))
    (Atom (bumper OR wait 1s) go 10 0)
  }
}
";
    let outputs = outputs(20, |turn, y| {
        let is_near = turn >= 10;
        ping(y, 0, if is_near { 0.4 } else { 3.0 });
        ping(y, 4, 3.0);
        ping(y, 8, if is_near { 0.9 } else { 1.1 });
        y.switches = u32::from(is_near);
    });
    let questions = ["0", "0.9", "1", "--not turn 0"];
    insta::assert_snapshot!(answers("shadows", plan, &outputs, &questions));
}

/// Three operands fire in the same turn: joined by OR, by AND, and by both.
#[test]
fn three_operands_fired_at_once() {
    let plan = "{ Three (wait 1min)
  (Atom (bumper OR r0 < 50cm OR r8 < 1m) go 20 0)
  (Atom (bumper AND r0 < 50cm AND v > 1) go 10 0)
  (Atom ((bumper OR r0 < 30cm) AND NOT lowBattery) stop)
}
";
    let outputs = outputs(40, |turn, y| {
        let now = turn == 10 || turn == 25 || turn == 35;
        y.switches = u32::from(now);
        ping(y, 0, if now || turn == 20 { 0.4 } else { 0.6 });
        ping(y, 8, if now { 0.9 } else { 1.1 });
        y.supply.is_low = turn < 30;
        y.velocity.v = MetersPerSecond(if turn >= 25 { 0.02 } else { 0.0 });
    });
    let questions = ["0.9", "1", "2", "2.5", "3.4", "3.5"];
    insta::assert_snapshot!(answers("three", plan, &outputs, &questions));
}

/// One sonar fails after a second, another one never pings, and two sonars ping alternately.
#[test]
fn sensors_were_stale() {
    let plan = "{ Stale (wait 5s)
  (Atom (r0 < 50cm OR r3 < 50cm OR r5 < r6 OR age(4) > 3s) go 20 0)
  (Atom (null) stop)
}
";
    let outputs = outputs(55, |turn, y| {
        if turn <= 10 {
            ping(y, 0, 0.55);
        }
        if turn % 2 == 0 {
            ping(y, 5, 2.0);
        }
        if turn % 2 == 1 || turn == 0 {
            ping(y, 6, 1.5);
        }
        if turn <= 2 {
            ping(y, 4, 1.0);
        }
    });
    let questions = ["0", "1.9", "2.5", "3.3", "5.0"];
    insta::assert_snapshot!(answers("stale", plan, &outputs, &questions));
}

/// Conditions with NOT, RISING and `after`, alone and combined with other conditions.
#[test]
fn memories_kept_a_condition_from_firing() {
    let plan = "{ Memories (wait 10s)
  near: (Atom (RISING (r0 < 80cm) OR wait 4s) go 30 0)
  (Atom (after near (wait 4s) OR wait 1s) stop)
  (Atom (RISING (bumper OR r0 < 80cm) AND NOT (lowBattery OR r0 < 30cm)) go 10 0)
  (Atom (null) go 5 0)
}
";
    let outputs = outputs(60, |turn, y| {
        ping(y, 0, if (10..20).contains(&turn) || (35..40).contains(&turn) { 0.9 } else { 0.7 });
        y.supply.is_low = turn < 38;
    });
    let questions = ["0.5", "1.5", "2", "2.5", "3.7", "4.1", "--not go 5 0"];
    insta::assert_snapshot!(answers("memories", plan, &outputs, &questions));
}

/// Each operand inside NOT and RISING is shown with its value and unit. For an operand that holds, the answer names the
/// amount or the time that is missing until NOT fires.
#[test]
fn operands_inside_not_have_values() {
    let plan = "{ Inside (wait 1min)
  (Atom (NOT (r0 > 40cm OR bumper) OR NOT (x < 1m AND v < 50cm/s) OR NOT (t < 2s)) go 20 0)
  (Atom (NOT (NOT wait 1 OR r0 < r1) AND NOT r0 > 40cm AND NOT theta == 90deg) go 10 0)
  (Atom (NOT (way < 1m AND RISING (r0 < 60cm OR r1 < 60cm)) AND NOT (NOT way > 1m AND battery > 20) AND wait 1) stop)
}
";
    let outputs = outputs(60, |turn, y| {
        ping(y, 0, if turn < 20 { 0.9 } else { 0.3 });
        ping(y, 1, if turn < 30 { f64::INFINITY } else { 0.2 });
        y.odometry.x.0 = 0.02 * turn as f64;
    });
    let questions = ["0", "0.4", "1", "1.5", "2.2", "2.5", "3.5", "5.9", "--not stop"];
    insta::assert_snapshot!(answers("inside", plan, &outputs, &questions));
}

/// A law with a goal makes no progress, an interrupt that an enclosing scope also has is removed, and passes of loops
/// are counted.
#[test]
fn laws_and_loops_took_part() {
    let plan = "{ Laws (bumper)
  ((Atom (stuck 1s OR bumper) (goAvoid 0 3)) (Atom (way > 1m OR bumper) (turn 0)))^2
  (Atom (wait 1s) stop)
}
";
    let outputs = outputs(40, |_, y| (0..16).for_each(|sonar| ping(y, sonar, 2.0)));
    let questions = ["0.5", "1", "2", "3.1", "--not stop", "--not 2"];
    insta::assert_snapshot!(answers("laws", plan, &outputs, &questions));
}

/// Nothing leads to an atom, and some names do not exist in the plan.
#[test]
fn an_atom_had_no_chance() {
    let plan = "{ Far
  (Atom (bumper) go 20 0)
  { Second (wait 3s)
    (Atom (wait 1s) stop)
    (Atom (wait 1s) go 1 0)
  }
  (Atom (null) go 2 0)
}
";
    let outputs = outputs(20, |_, y| ping(y, 0, 2.0));
    let questions = ["--not stop", "--not go 1 0", "--not go 2 0", "--not Second", "--not Third", "--not go 20"];
    insta::assert_snapshot!(answers("far", plan, &outputs, &questions));
}

/// The answer as JSON contains everything that the text contains.
#[test]
fn answers_are_objects_as_well() {
    let plan = "{ Both (bumper)\n  (Atom (r0 < 50cm OR wait 1s) go 20 0)\n  (Atom (wait 1s) stop)\n}\n";
    let (folder, target) = (folder("why-json"), mdle_files::target(Some("sim")).unwrap());
    write(&folder, "both", &target, plan, &outputs(20, |turn, y| y.switches = u32::from(turn == 7)));
    let object = |arguments: &[&str]| {
        let text = asked(&folder, arguments);
        let line = text.lines().nth(1).unwrap();
        serde_json::to_string_pretty(&serde_json::from_str::<serde_json::Value>(line).unwrap()).unwrap()
    };
    let answers =
        [object(&["why", "both.mcap", "0.7", "--json"]), object(&["why", "both.mcap", "--not", "stop", "--json"])];
    insta::assert_snapshot!(answers.join("\n"));
}
