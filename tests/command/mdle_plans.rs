//! Tests that `mdle shell` loads, replaces and refuses plans and modules while the robot drives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;

use crate::mdle_shell::{Left, dialogue, piped};
use mdle_tests::executable::folder;

/// Returns a folder with a plan that turns on the spot, and with plans that replace it.
fn with_plans(test: &str) -> PathBuf {
    let folder = folder(test);
    let files = [
        ("plan.mdle", "{ Turn (bumper)\n  (Atom (wait 1s) (go 0 10deg/s))\n  (Atom (wait 1s) (go 0 20deg/s))\n}\n"),
        ("go.mdle", "{ Go (bumper)\n  (Atom (wait 60s) (go 30 0))\n}\n"),
        (
            "two.mdle",
            "{ Left (wait 1s) (Atom (null) (go 0 1rad/s)) }\n{ Right (wait 1s) (Atom (null) (go 0 -1rad/s)) }\n",
        ),
        ("wrong.mdle", "{ Wrong (bumper)\n  (Atom (wiat 60s) (go 30 0))\n}\n"),
        ("warned.mdle", "{ Warned (wait 5s) (Atom (wait 9s) (go 30 0)) }\n"),
        ("path.mdle", "{ Path (bumper) (Atom (null) path(hall)) }\n"),
        ("ended.mdle", "{ Ended (wait 0s) (Atom (null) (go 30 0)) }\n"),
        ("rules.toml", "[guards.fast]\nwhen = \"v > 25cm/s\"\nthen = \"end\"\n"),
    ];
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

#[test]
fn a_stored_plan_takes_over_at_its_moment() {
    let folder = with_plans("shell_swap");
    let commands = "load_plan go.mdle\nload_plan two.mdle\nls /plans\nls /plans/Go\nget /plans/Go/text\nstep 3\n\
                    set /usr/mdle/main Go\nget /usr/mdle/armed\nstep\nget /usr/mdle/main\nget /usr/mdle/t\n\
                    get /usr/robot/input/v\nget /usr/mdle/on_trial\nswap Left atom\nstep 3\nget /usr/mdle/main\n\
                    rollback\nstep\nget /usr/mdle/main\nget /usr/mdle/t\nget /usr/mdle/since\nswap Left atom\nstep 7\n\
                    get /usr/mdle/main\nget /usr/mdle/t\nswap Right plan\nstep 9\nget /usr/mdle/main\nstep\n\
                    get /usr/mdle/main\nget /usr/mdle/atom\nget /usr/mdle/armed\n";
    insta::assert_snapshot!(dialogue(&folder, &["--log", "log"], commands));
    insta::assert_snapshot!("a_log_has_the_number_of_the_plan", fs::read_to_string(folder.join("log")).unwrap());
}

#[test]
fn a_stored_plan_has_warnings_and_figures() {
    let folder = with_plans("shell_facts");
    let commands = "get /plans/Turn/diagnostics\nget /plans/Turn/analysis\nload_plan warned.mdle\n\
                    get /plans/Warned/diagnostics\nget /plans/Warned/analysis\n";
    insta::assert_snapshot!(dialogue(&folder, &[], commands));
}

#[test]
fn a_text_that_is_typed_becomes_the_plan() {
    let folder = with_plans("shell_text");
    let commands = "step\nset /usr/mdle/main { Back (wait 2s) \\\n (Atom (null) (go -20 0)) }\nstep\nget /usr/mdle/main\n\
                    get /usr/mdle/place\nget /usr/robot/input/v\nls /plans\nget /plans/Back/text\n\
                    set /usr/mdle/main { Back (wait 2s) (Atom (nul) (go -20 0)) }\nset /usr/mdle/main { A (null) stop } { B (null) stop }\n\
                    step 30\n";
    insta::assert_snapshot!(dialogue(&folder, &[], commands));
}

#[test]
fn what_is_no_plan_is_refused_and_the_plan_goes_on() {
    let folder = with_plans("shell_refused_plans");
    let commands = "load_plan wrong.mdle\nload_plan missing.mdle\nload_plan .\nload_plan path.mdle\nswap Path\n\
                    load_plan warned.mdle\nload_plan a b\nload_plan\nswap\nswap Nowhere\nswap Warned soon\n\
                    swap Warned now now\nset /usr/mdle/main Wraned\nset /usr/mdle/trial 3\nset /usr/mdle/trial -1s\n\
                    set /usr/mdle/trial 5s\nget /usr/mdle/trial\nset /usr/mdle/armed x\ncancel\nrollback\n\
                    call /plans/Warned/delete\nls /plans\nswap Turn\nstep\nget /usr/mdle/main\nget /usr/mdle/state\n\
                    call /plans/Turn/delete\nls /plans\nstep\nget /usr/mdle/main\n";
    insta::assert_snapshot!(dialogue(&folder, &[], commands));
}

#[test]
fn a_plan_on_trial_that_fails_is_rolled_back() {
    let folder = with_plans("shell_trial");
    let commands = "load_plan go.mdle\nload_plan ended.mdle\nset /usr/mdle/trial 1s\nstep 5\nswap Go\nstep 3\n\
                    get /usr/mdle/main\nstep 2\nget /usr/mdle/main\nget /usr/mdle/state\nswap Go\nstep 20\n";
    insta::assert_snapshot!(dialogue(&folder, &["--safety", "rules.toml"], commands));
}

#[test]
fn roles_decide_who_replaces_plans() {
    let folder = with_plans("shell_plan_roles");
    let commands = "load_plan go.mdle\nset /usr/mdle/main Turn\ncall /plans/Turn/delete\nrollback\n";
    let all = ["tune", "swap"].map(|role| dialogue(&folder, &["--role", role], commands));
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn a_cancelled_plan_does_not_take_over() {
    let folder = with_plans("shell_cancel");
    let commands = "load_plan go.mdle\nswap Go atom\nget /usr/mdle/armed\ncancel\nget /usr/mdle/armed\nstep 12\n\
                    get /usr/mdle/main\nswap Go\nswap Turn plan\nget /usr/mdle/armed\n";
    let Left { out, err, status } = piped(&folder, &[], commands.as_bytes());
    assert_eq!(
        (&*out, &*err, status),
        (
            "Go is stored\nGo takes over when the atom ends\nGo, when the atom ends\nGo does not take over\n(no value yet)\n12 turns, 1.1s\n\
             Turn\nGo takes over in the next turn\nTurn takes over when the plan ends, in place of Go\nTurn, when the plan ends\n",
            "1.0 s  go 0 0.3490658503988659 (plan.mdle:3)  <- wait 1s (plan.mdle:2)\n",
            Some(0)
        )
    );
}

#[test]
fn large_plans_take_over_as_small_ones_do() {
    let folder = with_plans("shell_large");
    // The plan has a megabyte of text and a trillion states.
    let atoms = "  (Atom (wait 1000s AND NOT (x > 1000m)) (go 30 0)) // an atom of a very long plan\n".repeat(12_500);
    let megabyte = format!("{{ Megabyte (bumper)\n{atoms}}}\n");
    assert!(megabyte.len() > 1_000_000);
    fs::write(folder.join("megabyte.mdle"), megabyte).unwrap();
    let trillion = "{ Trillion (bumper)\n  (((Atom (wait 1s) (go 10 0))^10000)^10000)^10000\n}\n";
    fs::write(folder.join("trillion.mdle"), trillion).unwrap();
    let commands = "load_plan megabyte.mdle\nload_plan trillion.mdle\nstep\nswap Megabyte\nstep\nget /usr/mdle/main\n\
                    swap Trillion\nstep 11\nget /usr/mdle/place\nget /usr/mdle/state\nrollback\nstep\n\
                    get /usr/mdle/main\ncall /plans/Megabyte/delete\nstep\nget /usr/mdle/main\n";
    insta::assert_snapshot!(dialogue(&folder, &[], commands));
}

#[test]
fn a_plan_can_be_replaced_in_every_turn() {
    let folder = with_plans("shell_every_turn");
    let commands = "set /usr/mdle/main Turn\nstep\nget /usr/mdle/t\n".repeat(40);
    let Left { out, status, .. } = piped(&folder, &["--log", "log"], commands.as_bytes());
    assert_eq!((out.matches("\n0s\n").count(), status), (40, Some(0)), "{out}");
    let log = fs::read_to_string(folder.join("log")).unwrap();
    assert!(log.lines().last().unwrap().contains("\"turn\":39,\"t\":3.9,\"state\":1"), "{log}");
    assert!(log.lines().last().unwrap().contains("\"plan\":41"), "{log}");
}

#[test]
fn the_time_of_a_plan_needs_no_timer() {
    let folder = with_plans("shell_time");
    fs::write(folder.join("plan.mdle"), "{ Ahead (x > 45cm) (Atom (null) (go 30 0)) }\n").unwrap();
    let commands = "step 5\nget /usr/mdle/t\nstep 30\nget /usr/mdle/t\nget /clock/now\n";
    let Left { out, status, .. } = piped(&folder, &[], commands.as_bytes());
    let lines: Vec<_> = out.lines().collect();
    let &[_, t, end, last, now] = lines.as_slice() else { panic!("{out}") };
    assert!(end.ends_with(", and the plan is over"), "{out}");
    assert_eq!((t, last, status), ("0.4s", now, Some(0)), "{out}");
    assert_ne!(last, "0s");
}

#[test]
fn at_most_64_plans_are_stored() {
    let folder = with_plans("shell_many_plans");
    let many: String = (0..64).map(|number| format!("{{ P{number} (wait 1s) (Atom (null) stop) }}\n")).collect();
    fs::write(folder.join("many.mdle"), many).unwrap();
    let Left { out, err, status } = piped(&folder, &[], b"load_plan many.mdle\nls /plans\n");
    let refused = "error: standard input:1: 64 plans are stored, which is the most: delete one\n";
    assert_eq!((&*out, &*err, status), ("Turn/\n", refused, Some(1)));
}

#[test]
fn a_plan_whose_module_is_missing_does_not_take_over() {
    let folder = with_plans("shell_missing_module");
    fs::write(folder.join("follow.mdle"), "{ Pursuit (bumper) (Atom (null) goAvoid(heading module)) }\n").unwrap();
    let commands = "load_plan follow.mdle\nset /usr/mdle/main { Long (wait 9s) (Atom (null) stop) }\nstep\nswap Pursuit\n\
                    step 15\nget /usr/mdle/armed\nstep 15\nget /usr/mdle/armed\nget /usr/mdle/main\n";
    insta::assert_snapshot!(dialogue(&folder, &[], commands));
}
