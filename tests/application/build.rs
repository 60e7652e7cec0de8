//! Makes Rust of the plan.

fn main() {
    mdlec::embed::plan("plans/round.mdle").target("sim").write();
}
