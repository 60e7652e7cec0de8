//! The program that runs a plan, as `--help` and `--version` name it.

/// The names of a program that runs a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Program<'a> {
    /// Name of the plan, which `--help` shows.
    pub plan: &'a str,
    /// Answer to `--version` after the name of the plan; if it is empty, the executable has no `--version`.
    pub version: &'a str,
}

impl<'a> From<&'a str> for Program<'a> {
    /// Returns the program of the plan of this name, without a version.
    fn from(plan: &'a str) -> Self {
        Self { plan, version: "" }
    }
}
