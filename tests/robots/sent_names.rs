//! Tests that plans of other robots, if they are refused or replaced, do not use up the names that a process can store
//! for loaded plans.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use mdle_tests::executable::folder;

use crate::shared_modules::{run, scenario};

const STANDS: &str = "{ Stand (wait 50s) (Atom (null) stop) }";
const TAKES: &str = "plans-from = [\"ada\"]";

/// Runs a scenario in which `ada` sends a plan to `bob` every 2 s; returns its output.
fn sent(folder: &Path, plans: &[String]) -> String {
    let mut more = String::new();
    for (number, plan) in plans.iter().enumerate() {
        fs::write(folder.join(format!("{number}.mdle")), plan).unwrap();
        let at = 2 * number + 1;
        more += &format!(
            "[[sent-plan]]\nat = \"{at}s\"\nfrom = \"ada\"\nto = \"bob\"\nfile = \"{number}.mdle\"\nwhen = \"now\"\n"
        );
    }
    scenario(folder, [("", STANDS), (TAKES, STANDS)], &more);
    let (out, err, status) = run(folder, "run two.toml");
    assert_eq!(status, 0, "{out}{err}");
    out + &err
}

#[test]
fn a_refused_plan_leaves_no_names() {
    let folder = folder("refused_names");
    let long = |number: usize| format!("{number}_{}", "a".repeat(60_000));
    let mut plans: Vec<String> = (0..18)
        .map(|number| "{ Go (wait 1s) (Atom (null) path(WAY)) }".replace("WAY", &format!("way{}", long(number))))
        .collect();
    plans.push("{ Go (wait 1s) (Atom (rendezvous ROBOT) stop) }".replace("ROBOT", &format!("r{}", long(18))));
    plans.push("{ Go (range(new_one module) > 1m) (Atom (null) stop) }".to_owned());
    let text = sent(&folder, &plans);
    assert_eq!(
        text.matches("bob: warning: state link: the plan of ada is refused: the plan replays the path").count(),
        18
    );
    assert!(text.contains("refused: the plan names the robot `r18_"), "{}", text.len());
    // A module with a new name can still be loaded.
    assert!(text.contains("/usr/new_one/range"), "{}", &text[text.len() - 1000..]);
}

#[test]
fn a_robot_brings_few_names_of_modules() {
    let folder = folder("new_names");
    let plan = |name: &str| "{ Go (range(NAME module) > 1m) (Atom (null) stop) }".replace("NAME", name);
    let names = ["a", "b", "c"].map(|letter| letter.repeat(2000));
    let plans = [&names[0], &names[1], &names[2], &names[0]].map(|name| plan(name));
    let text = sent(&folder, &plans);
    let refusals = text.matches("bob: warning: state link: the plan of ada is refused: ").count();
    let budget = "the plans of ada have named modules with more than 10 kB of names in this run";
    assert_eq!((refusals, text.matches(&format!("is refused: {budget}")).count()), (4, 1), "{text}");
}
