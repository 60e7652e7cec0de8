//! Tests files that use each other: the plans that each file can use, the plan that runs, and messages about files that
//! cannot be used.

use crate::samples::judged_files;

#[test]
fn plans_of_used_files_are_seen_and_run_only_where_they_are_named() {
    insta::assert_snapshot!(judged_files(&[
        ("main.mdle", "use \"legs.mdle\" use \"turns.mdle\"\n{ Main Leg(3) Corner }"),
        (
            "legs.mdle",
            "use \"turns.mdle\"\n{ Leg (n: count) ExecPlan n { (Atom (bumper) go 20 0) Corner } }\n{ Unused Leg(1) }"
        ),
        ("turns.mdle", "{ Corner (Atom (wait 9) turn 90) }"),
    ]));
}

#[test]
fn files_that_cannot_be_used() {
    insta::assert_snapshot!(judged_files(&[
        ("main.mdle", "use \"nowhere.mdle\"\nuse \"a.mdle\"\n{ Main Leg }"),
        ("a.mdle", "use \"./b.mdle\"\n{ Leg (Atom (bumpr) stop) }"),
        ("b.mdle", "use \"c.mdle\"\n{ Main (Atom (wait 1) stop) }"),
        ("c.mdle", "use \"a.mdle\" use \"c.mdle\"\n{ C Main"),
    ]));
}
