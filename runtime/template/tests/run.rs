//! Tests that a plan that reads the module runs in the simulator.

use std::process::Command;

#[test]
fn a_plan_reads_the_module() {
    let mut run = Command::new(env!("CARGO_BIN_EXE_template"));
    run.args(["run", "plan.mdle", "--target", "sim", "--world", "hall", "--speed", "max"]);
    let output = run.output().unwrap();
    let (report, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{report}{errors}");
    assert!(report.contains("stop (plan.mdle:4)  <- range(template module) = "), "{report}{errors}");
}
