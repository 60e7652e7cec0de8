//! Every plan in `plans/`: tree, machine and Rust as golden files where `sim` can run it, what is said of it elsewhere.
//!
//! Rust is kept as a `.rs` file in `golden/`, to be opened and read as one. After a change that is meant, record all of
//! them with `INSTA_UPDATE=always cargo test -p mdle-tests --test golden`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_runtime::Plan;
use mdle_tests::golden::{judge, machine, rust, tree};
use mdle_tests::repository::{TextFile, files, root};

/// The recorded Rust, compiled as it is under the lints of this workspace.
mod recorded {
    pub(crate) mod lab_tour {
        include!("golden/lab_tour.rs");
    }
    pub(crate) mod lab2_to_lab1 {
        include!("golden/paper-lab2_to_lab1.rs");
    }
}

fn plans() -> Vec<TextFile> {
    let plans: Vec<_> = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect();
    assert!(plans.len() >= 6, "the plans are gone");
    plans
}

/// `plans/paper/first_robot.mdle` as `paper-first_robot`.
fn name(file: &TextFile) -> String {
    file.path.trim_start_matches("plans/").trim_end_matches(".mdle").replace('/', "-")
}

#[test]
fn trees() {
    for file in plans() {
        insta::assert_snapshot!(format!("tree-{}", name(&file)), format!("{}\n----\n{}", file.text, tree(&file)));
    }
}

#[test]
fn what_a_robot_that_has_everything_is_told() {
    for file in plans() {
        let (compiled, said) = judge(&file, None);
        assert!(!compiled.is_empty(), "{said}");
        insta::assert_snapshot!(format!("check-{}", name(&file)), said);
    }
}

#[test]
fn machines_of_what_the_simulator_runs_and_why_it_does_not_run_the_rest() {
    let mut runs = 0;
    for file in plans() {
        let (compiled, said) = judge(&file, Some("sim"));
        let machines: String = compiled.iter().map(machine).collect();
        runs += usize::from(!compiled.is_empty());
        insta::assert_snapshot!(format!("sim-{}", name(&file)), format!("{said}{machines}"));
    }
    assert!(runs >= 3, "the simulator runs {runs} plans");
}

#[test]
fn rust_is_as_recorded() {
    let folder = root().join("tests/golden");
    let mut recorded: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    for file in plans() {
        let (compiled, _) = judge(&file, Some("sim"));
        for compiled in &compiled {
            let name = format!("{}.rs", name(&file));
            let path = folder.join(&name);
            let text = rust(&file, compiled);
            if std::env::var("INSTA_UPDATE").as_deref() == Ok("always") {
                fs::write(&path, &text).unwrap();
            }
            let golden = fs::read_to_string(&path).unwrap_or_default();
            assert!(golden == text, "tests/golden/{name} is not what is emitted now; see the head of this file");
            recorded.retain(|other| *other != *name);
        }
    }
    assert_eq!(recorded, [] as [&str; 0], "no plan makes these any more");
}

#[test]
fn recorded_rust_compiles_and_has_the_tables_of_its_plan() {
    let tables = |file: &str| {
        let file = plans().into_iter().find(|plan| name(plan) == file).unwrap();
        judge(&file, Some("sim")).0.swap_remove(0).lowered
    };
    assert_eq!(recorded::lab_tour::LabTour::new().fsm(), tables("lab_tour").tables());
    let plan = recorded::lab2_to_lab1::Lab2ToLab1Plan::new();
    assert_eq!(plan.fsm(), tables("paper-lab2_to_lab1").tables());
    assert_eq!([plan.law(2), plan.condition(0), plan.name(0)], ["align 7 9", "bumper", "Lab2ToLab1Plan"]);
}
