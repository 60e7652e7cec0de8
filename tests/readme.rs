//! What the README shows is what there is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::repository::root;

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).unwrap()
}

#[test]
fn its_first_plan_is_the_one_in_plans() {
    let readme = readme();
    let shown = readme.split("```\n").nth(1).expect("a block of code");
    let plan = fs::read_to_string(root().join("plans/dock.mdle")).unwrap();
    assert_eq!(code(shown), code(&plan));
}

/// A plan without its comments and blank lines.
fn code(plan: &str) -> Vec<&str> {
    let lines = plan.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
    lines.filter(|line| !line.is_empty()).collect()
}

#[test]
fn its_first_command_is_the_tour_that_is_tested() {
    let readme = readme();
    assert!(readme.contains("plans/lab_tour.mdle --target sim"));
    assert!(root().join("plans/lab_tour.mdle").is_file());
}

#[test]
fn its_rooms_are_all_there() {
    let readme = readme();
    let rooms = readme.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    let missing: Vec<_> = rooms.filter(|room| !root().join(room).exists()).collect();
    assert_eq!(missing, [""; 0]);
}
