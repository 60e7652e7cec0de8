//! Reports the results of the checks to the author of a robot.

use std::format;

use core::fmt;

/// Capabilities for which there are checks.
const KNOWN: [&str; 6] = ["diff_drive", "odometry", "bumper", "sonar[16]", "paths", "power"];

/// Result of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// The robot passes the check.
    Holds,
    /// The alphabet has no such quark or signal, so no plan can use it.
    NotOffered,
    /// The robot has a defect; contains a message for its author.
    Broken(String),
}

/// Converts a description of a defect to a verdict.
impl From<String> for Verdict {
    fn from(sentence: String) -> Self {
        Self::Broken(sentence)
    }
}

/// A check that has run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// Capability to which the check belongs.
    pub capability: &'static str,
    /// Name of the requirement in the report.
    pub name: &'static str,
    /// The result of the check.
    pub verdict: Verdict,
}

/// Results of all checks. Its text has a line for each check, and the reason below each check that fails.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    checked: Vec<Checked>,
    /// Messages about capabilities that are claimed but were not checked, or were checked but are not claimed.
    claims: Vec<String>,
    /// Claimed capabilities for which there are no checks.
    unknown: Vec<&'static str>,
}

impl Report {
    /// Creates a report of the results `checked` of the capabilities `asked`, for a robot whose alphabet claims the
    /// capabilities `claimed`.
    pub(super) fn new(checked: Vec<Checked>, asked: &[&str], claimed: &[&'static str]) -> Self {
        let method = |capability: &str| format!(".{}()", capability.trim_end_matches("[16]"));
        let missing = claimed.iter().filter(|claim| KNOWN.contains(claim) && !asked.contains(claim));
        let missing = missing.map(|claim| {
            format!("the alphabet claims `{claim}`, and nothing of it was checked: add {} to the suite", method(claim))
        });
        let more = asked.iter().filter(|asked| !claimed.contains(asked));
        let more = more.map(|asked| {
            format!(
                "`{asked}` was checked, and the alphabet does not claim it: add it behind `capability` and run \
                 `mdlec bind`, or take {} away",
                method(asked)
            )
        });
        let unknown = claimed.iter().copied().filter(|claim| !KNOWN.contains(claim)).collect();
        Self { checked, claims: missing.chain(more).collect(), unknown }
    }

    /// Returns `true` if no check failed, and the checked capabilities are those that the alphabet claims.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.claims.is_empty() && !self.checked.iter().any(|checked| matches!(checked.verdict, Verdict::Broken(_)))
    }

    /// Returns the checks that have run.
    #[must_use]
    pub fn checked(&self) -> &[Checked] {
        &self.checked
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Checked { capability, name, verdict } in &self.checked {
            match verdict {
                Verdict::Holds => writeln!(f, "holds        {capability:<10}  {name}")?,
                Verdict::NotOffered => writeln!(f, "not offered  {capability:<10}  {name}")?,
                Verdict::Broken(why) => writeln!(f, "BROKEN       {capability:<10}  {name}\n             {why}")?,
            }
        }
        for claim in &self.claims {
            writeln!(f, "BROKEN       {claim}")?;
        }
        for claim in &self.unknown {
            writeln!(f, "no checks    {claim}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;
    use std::vec;

    use super::*;

    #[test]
    fn what_is_claimed_has_to_be_checked_and_what_is_checked_claimed() {
        let report = Report::new(Vec::new(), &["diff_drive", "bumper"], &["diff_drive", "sonar[16]", "state_link"]);
        assert!(!report.holds());
        assert_eq!(
            report.to_string(),
            "BROKEN       the alphabet claims `sonar[16]`, and nothing of it was checked: add .sonar() to the suite\n\
             BROKEN       `bumper` was checked, and the alphabet does not claim it: add it behind `capability` and run \
             `mdlec bind`, or take .bumper() away\n\
             no checks    state_link\n"
        );
        assert!(Report::new(Vec::new(), &["bumper"], &["bumper", "state_link"]).holds());
    }

    #[test]
    fn what_is_not_offered_breaks_nothing() {
        let with = |verdict| Report::new(vec![Checked { capability: "bumper", name: "b", verdict }], &[], &[]);
        assert!(with(Verdict::NotOffered).holds() && with(Verdict::Holds).holds());
        assert!(!with(Verdict::Broken("why".into())).holds());
    }
}
