//! Snapshot tests of every plan in `plans/`: the tree, the machine and the Rust if `sim` can run the plan, and the
//! messages for other robots.
//!
//! The Rust is in a separate file beside its snapshot, `snapshots/machine__golden__rust-….snap.rs`, so that it can be
//! opened as a Rust file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::Compiled;
use mdle_compiler::rust::Shape;
use mdle_runtime::Plan;
use mdle_tests::golden::{alphabet, judge, machine, rust, tree};
use mdle_tests::pipeline::scripted;
use mdle_tests::repository::{TextFile, files, root};

/// Recorded Rust, which is compiled without changes under the lints of this workspace.
mod recorded {
    pub(crate) mod lab_tour {
        include!("snapshots/machine__golden__rust-lab_tour.snap.rs");
    }
    pub(crate) mod rows_lab_tour {
        include!("snapshots/machine__golden__rust-rows-lab_tour.snap.rs");
    }
    pub(crate) mod dock {
        include!("snapshots/machine__golden__rust-dock.snap.rs");
    }
    pub(crate) mod lab2_to_lab1 {
        include!("snapshots/machine__golden__rust-paper-lab2_to_lab1.snap.rs");
    }
    pub(crate) mod lab1_to_office {
        include!("snapshots/machine__golden__rust-paper-lab1_to_office.snap.rs");
    }
}

fn plans() -> Vec<TextFile> {
    let plans: Vec<_> = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect();
    assert!(plans.len() >= 11, "the plans are gone");
    plans
}

/// Returns the name of a plan in snapshots, such as `paper-first_robot` for `plans/paper/first_robot.mdle`.
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
fn plans_for_any_robot_have_no_errors() {
    for file in plans() {
        let (compiled, message) = judge(&file, None);
        assert!(!compiled.is_empty(), "{message}");
        insta::assert_snapshot!(format!("check-{}", name(&file)), message);
    }
}

#[test]
fn machines_of_what_the_simulator_runs_and_why_it_does_not_run_the_rest() {
    let mut runs = 0;
    for file in plans() {
        let (compiled, message) = judge(&file, Some("sim"));
        let machines: String = compiled.iter().map(machine).collect();
        runs += usize::from(!compiled.is_empty());
        insta::assert_snapshot!(format!("sim-{}", name(&file)), format!("{message}{machines}"));
    }
    assert!(runs >= 3, "the simulator runs {runs} plans");
}

#[test]
fn rust_for_the_simulator() {
    for file in plans() {
        // A group has a separate plan for each of its robots.
        let emit = |compiled: &Compiled| rust(&file, compiled, Shape::of(&compiled.machine));
        let text: String = judge(&file, Some("sim")).0.iter().map(emit).collect();
        if !text.is_empty() {
            insta::assert_binary_snapshot!(&format!("rust-{}.rs", name(&file)), text.into_bytes());
        }
    }
}

#[test]
fn rust_in_rows() {
    let file = plans().into_iter().find(|plan| name(plan) == "lab_tour").unwrap();
    let text = rust(&file, &judge(&file, Some("sim")).0.swap_remove(0), Shape::Rows);
    insta::assert_binary_snapshot!("rust-rows-lab_tour.rs", text.into_bytes());
}

#[test]
fn recorded_rust_compiles_and_has_the_tables_of_its_plan() {
    let tables = |file: &str| {
        let file = plans().into_iter().find(|plan| name(plan) == file).unwrap();
        judge(&file, Some("sim")).0.swap_remove(0).machine
    };
    assert_eq!(recorded::lab_tour::LabTour::new().fsm(), tables("lab_tour").tables());
    assert_eq!(recorded::rows_lab_tour::LabTour::new().fsm(), tables("lab_tour").tables());
    assert_eq!(recorded::dock::Dock::new().fsm(), tables("dock").tables());
    let plan = recorded::lab2_to_lab1::Lab2ToLab1Plan::new();
    assert_eq!(plan.fsm(), tables("paper-lab2_to_lab1").tables());
    let office = recorded::lab1_to_office::Lab1ToOfficePlan::new();
    assert_eq!(office.fsm(), tables("paper-lab1_to_office").tables());
    assert_eq!([plan.law(2), plan.condition(0), plan.name(0)], ["align 7 9", "bumper", "Lab2ToLab1Plan"]);
}

#[test]
fn bound_alphabets_are_as_they_are_committed() {
    let committed = |target: &str| std::fs::read_to_string(root().join(target).join("src/alphabet.rs")).unwrap();
    assert!(mdle_compiler::rust::bind(&alphabet(None)) == committed("atoms"), "`mdlec bind` says what differs");
    assert!(
        mdle_compiler::rust::bind(&alphabet(Some("sim"))) == committed("targets/sim"),
        "`mdlec bind` says what differs"
    );
    assert!(mdle_compiler::rust::bind(scripted()) == committed("tests/scripted"), "`mdlec bind` says what differs");
}
