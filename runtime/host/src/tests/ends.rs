//! Tests the end of a run: the causes of `--require`, the robot's goal, and the exit status.

use mdle_runtime::Cause::{Completed, Fired};

use super::plan::ToyPlan;
use super::toy::{Act, Run, Stage};
use crate::Judgement;

/// Returns a stage on which the plan `Lab` goes to its last atom in its first turn and then ends by this cause.
fn ended(cause: mdle_runtime::Cause) -> Stage {
    Stage::script([Act::Senses(vec![(0, Fired(1)), (1, Fired(1))]), Act::Senses(vec![(3, cause)])])
}

fn required(stage: Stage, causes: &[&str]) -> Run {
    let options: Vec<&str> = causes.iter().flat_map(|cause| ["--require", cause]).collect();
    stage.run(&options)
}

#[test]
fn a_plan_that_ends_otherwise_has_status_5() {
    let statuses =
        |causes: &[&str]| [Fired(0), Fired(1), Completed(1)].map(|cause| required(ended(cause), causes).status);
    assert_eq!(statuses(&[]), [0, 0, 0]);
    assert_eq!(statuses(&["bumper"]), [0, 5, 5]);
    assert_eq!(statuses(&["Lab"]), [0, 5, 5]);
    assert_eq!(statuses(&["heard\"stop\""]), [5, 0, 5]);
    assert_eq!(statuses(&["completed"]), [5, 5, 0]);
    assert_eq!(statuses(&["completed", "bumper"]), [0, 5, 0]);
    let run = required(ended(Fired(1)), &["completed", "bumper"]);
    insta::assert_snapshot!(run.err, @r#"not as required: the plan ended by heard "stop", and --require asks for `completed` or `bumper`"#);
}

#[test]
fn a_limit_says_more_than_a_cause_that_did_not_come() {
    let run = Stage::default().run(&["--require", "bumper", "--turns", "3"]);
    assert_eq!(run.status, 4);
    let stage = Stage { stop: Act::Fails("no brakes"), ..ended(Fired(1)) };
    assert_eq!(required(stage, &["bumper"]).status, 3);
    let stage = Stage { finish: Err("no disk".to_owned()), ..ended(Fired(1)) };
    assert_eq!(required(stage, &["bumper"]).status, 3);
}

#[test]
fn a_cause_that_cannot_end_the_plan_is_refused() {
    let refused = ["bumpr", "wait 10", "Turn", "r3<r5", "", "after dark"].map(|cause| {
        let run = required(ended(Fired(0)), &[cause]);
        assert_eq!((run.status, &*run.out, &*run.journal), (2, "", ""), "{cause}");
        run.err
    });
    insta::assert_snapshot!(refused.concat(), @r#"
    error: --require 'bumpr': the plan has no such cause; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`; did you mean `bumper`?
    error: --require 'wait 10': that ends a part of the plan, and more follows; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`
    error: --require 'Turn': that ends a part of the plan, and more follows; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`
    error: --require 'r3<r5': that ends a part of the plan, and more follows; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`
    error: --require '': the plan has no such cause; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`
    error: --require 'after dark': the plan has no such cause; it can end by `bumper`, `Lab`, `heard "stop"`, `completed`
    "#);
    let run = required(Stage { plan: ToyPlan::restless(), ..Stage::default() }, &["always"]);
    insta::assert_snapshot!(run.err, @"error: --require 'always': that ends a part of the plan, and more follows; it can end by `bumper`, `Spin`, `completed`");
}

#[test]
fn a_goal_decides_about_the_status() {
    let judged = |judgement| {
        let run = Stage { judgement: Some(judgement), ..ended(Fired(1)) }.run(&[]);
        assert!(run.journal.ends_with(", exchange 0, stop, judged, finish"), "{}", run.journal);
        (run.status, run.out.lines().last().unwrap().to_owned(), run.err)
    };
    assert_eq!(judged(Judgement::Arrived), (0, "arrived".to_owned(), String::new()));
    assert_eq!(
        judged(Judgement::Bumped),
        (5, "bumped".to_owned(), "not as required: the run is bumped, and --goal asks for arrived\n".to_owned())
    );
    insta::assert_debug_snapshot!(judged(Judgement::Astray("(1.00, 2.50) heading 90".to_owned())), @r#"
    (
        5,
        "astray at (1.00, 2.50) heading 90",
        "not as required: the run is astray at (1.00, 2.50) heading 90, and --goal asks for arrived\n",
    )
    "#);
    let both = Stage { judgement: Some(Judgement::Arrived), ..ended(Fired(1)) };
    assert_eq!(required(both, &["bumper"]).status, 5);
    let stopped = Stage { judgement: Some(Judgement::Bumped), ..Stage::default() }.run(&["--turns", "2"]);
    assert_eq!((stopped.status, stopped.out.as_str()), (4, ""));
}
