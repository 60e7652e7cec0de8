//! Capabilities that a robot has because of its configuration, and the check that a plan needs no missing capability.

use std::fmt;

use crate::choices::BumperSource;
use crate::config::Config;

/// Alphabet files that declare this robot's quarks: its own alphabet and the shared one.
const DECLARATIONS: [&str; 2] = [include_str!("../alphabet.mdle"), include_str!("../../../atoms/alphabet.mdle")];

/// Optional capabilities. Each entry contains the name, `true` if the configuration provides the capability, and the
/// configuration keys that would provide it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Capabilities {
    optional: [(&'static str, bool, &'static str); 3],
}

impl Capabilities {
    /// Returns the capabilities of a robot with this configuration.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        let ranges = !config.scan.is_empty() || !config.ranges.0.is_empty();
        Self {
            optional: [
                ("sonar[16]", ranges, "`scan` or `ranges`"),
                ("bumper", config.bumper_type != BumperSource::None, "`bumper-type`"),
                ("power", !config.battery.is_empty(), "`battery`"),
            ],
        }
    }

    /// Checks that the laws and conditions of a plan, given as `texts`, need no missing capability.
    ///
    /// # Errors
    /// Returns a sentence that names the quark, the missing capability, and the configuration key that provides it.
    pub fn suffice(&self, texts: &[&str]) -> Result<(), String> {
        for (capability, _, key) in self.optional.iter().filter(|(_, is_there, _)| !is_there) {
            let needing = quarks(capability);
            let used = texts.iter().flat_map(|text| words(text)).find(|word| needing.contains(word));
            if let Some(quark) = used {
                return Err(format!(
                    "the plan uses `{quark}`, which needs {capability}, and this configuration gives the robot none; \
                     set {key} in the file of --config"
                ));
            }
        }
        Ok(())
    }
}

/// Prints the capabilities that the robot has, and the capabilities that it lacks, as TOML comments that follow the
/// configuration.
impl fmt::Display for Capabilities {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let given = self.optional.iter().filter(|(_, is_there, _)| *is_there).map(|(name, _, _)| *name);
        let all: Vec<_> = ["diff_drive", "odometry", "paths"].into_iter().chain(given).collect();
        writeln!(f, "# capabilities: {}", all.join(", "))?;
        for (capability, _, key) in self.optional.iter().filter(|(_, is_there, _)| !is_there) {
            let quarks = quarks(capability).join(", ");
            writeln!(f, "# without {capability}, no plan can use {quarks}; {key} gives it")?;
        }
        Ok(())
    }
}

/// Returns the names of the quarks that need a capability, in the order of their declarations.
fn quarks(capability: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for line in DECLARATIONS.iter().flat_map(|text| text.lines()).filter(|line| !line.starts_with("//")) {
        let Some((before, needs)) = line.split_once(" needs ") else { continue };
        let needs_it = needs.trim_end_matches(';').split(", ").any(|need| need == capability);
        let name = before.split_once(' ').map(|(_, rest)| words(rest).next().unwrap_or_default());
        names.extend(name.filter(|name| needs_it && !names.contains(name)));
    }
    names
}

/// Returns the words of `text` outside quotes. The sonar `r3` yields its quark `r`.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_inside = |letter: char| letter.is_alphanumeric() || letter == '_';
    let words = text.split('"').step_by(2).flat_map(move |part| part.split(move |letter| !is_inside(letter)));
    let words = words.filter(|word| word.starts_with(char::is_alphabetic));
    words.map(|word| match word.trim_end_matches(|digit: char| digit.is_ascii_digit()) {
        "r" => "r",
        _ => word,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configured;

    fn capabilities(change: impl Fn(&mut Config)) -> Capabilities {
        let mut config = Configured::read(None).unwrap().config;
        change(&mut config);
        Capabilities::of(&config)
    }

    #[test]
    fn quarks_are_read_from_the_alphabets() {
        assert_eq!(quarks("sonar[16]"), ["goAvoid", "atIsection", "align", "lead", "r", "age"]);
        assert_eq!(quarks("bumper"), ["bumper"]);
        assert_eq!(quarks("power"), ["lowBattery", "charger", "battery"]);
        assert!(quarks("diff_drive").starts_with(&["go", "advance", "goAvoid"]));
    }

    #[test]
    fn a_plan_needs_what_its_quarks_need() {
        let blind = capabilities(|config| config.scan.clear());
        let refused = |texts: &[&str]| blind.suffice(texts).err();
        assert_eq!(refused(&["go 20 0", "wait 3s", "way > 2m", "path \"align r3\""]), None);
        let sentence = refused(&["go 20 0", "(wait 3s) OR (r12 < 60cm)"]).unwrap();
        assert_eq!(
            sentence,
            "the plan uses `r`, which needs sonar[16], and this configuration gives the robot none; set `scan` or \
             `ranges` in the file of --config"
        );
        assert!(refused(&["goAvoid 90 40 20"]).is_some());
        assert!(refused(&["bumper"]).unwrap().contains("`bumper-type`"));
        let seeing = capabilities(|config| config.bumper_type = BumperSource::Scan);
        assert_eq!(seeing.suffice(&["(bumper) OR (r0 < 1m)"]), Ok(()));
        assert!(seeing.suffice(&["battery < 11V"]).is_err());
    }

    #[test]
    fn the_capabilities_are_printed() {
        let printed = capabilities(|_| {}).to_string();
        let comments: Vec<_> = printed.lines().filter(|line| line.starts_with("# ")).collect();
        let expected = [
            "# capabilities: diff_drive, odometry, paths, sonar[16]",
            "# without bumper, no plan can use bumper; `bumper-type` gives it",
            "# without power, no plan can use lowBattery, charger, battery; `battery` gives it",
        ];
        assert_eq!(comments, expected);
    }
}
