//! Names of a program that runs a plan, as `--help` and `--version` show them.

/// Names of a program that runs a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Program<'a> {
    /// Name of the plan, which `--help` shows.
    pub plan: &'a str,
    /// Text that `--version` prints after the plan's name. If the text is empty, the executable has no option
    /// `--version`.
    pub version: &'a str,
}

impl<'a> From<&'a str> for Program<'a> {
    /// Returns a program with this plan name, without a version.
    fn from(plan: &'a str) -> Self {
        Self { plan, version: "" }
    }
}
