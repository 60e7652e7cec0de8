//! Parses the text of the file of `--link` (docs/src/many_robots.md).

use std::collections::BTreeSet;

use mdle_engine::link::LinkSettings;
use mdle_runtime::{Pose, Printable};
use mdle_sim::Start;
use serde::Deserialize;

use crate::link_addresses::Addresses;
use crate::robot_name::{FORM, is_robot_name};

/// Minimum length, in bytes, of a key that is hard to guess.
const SHORTEST: usize = 16;

/// A link file, as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenLink {
    name: String,
    listen: Option<String>,
    router: Option<String>,
    key: String,
    start: Option<String>,
    #[serde(default)]
    shares: Vec<String>,
    robot: Vec<WrittenPeer>,
}

/// Another robot, as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenPeer {
    name: String,
    address: Option<String>,
    /// Key that only the two robots know, for plans that they send to each other; `None` if they do not exchange plans.
    plans: Option<String>,
}

/// Contents of a link file.
#[derive(Debug)]
pub(crate) struct LinkText {
    pub(crate) link: LinkSettings,
    pub(crate) addresses: Addresses,
    /// Pose, in the coordinates that all robots share, at which the robot's odometry is zero.
    pub(crate) start: Pose,
    /// Names of the modules whose attributes the robot shares.
    pub(crate) shares: Vec<String>,
    /// Warnings about keys that are easy to guess.
    pub(crate) warnings: Vec<String>,
}

impl LinkText {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// Fails with a message if the text is not a link file.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let WrittenLink { name, listen, router, key, start, shares, robot } =
            toml::from_str(text).map_err(|error| refused(text, &error))?;
        check_names(&name, &robot)?;
        if key.is_empty() {
            return Err("the key is empty: write the same one for all robots".to_owned());
        }
        let plans = plans(&robot, &key)?;
        let keys = [("the key".to_owned(), &key)].into_iter();
        let warnings = keys
            .chain(plans.iter().map(|(robot, key)| (format!("the key `plans` of `{robot}`"), key)))
            .filter(|(_, key)| key.len() < SHORTEST)
            .map(|(which, _)| format!("{which} is short, so that others may find it by trying\nhelp: {GOOD_KEY}"))
            .collect();
        let robots: Vec<_> = robot.iter().map(|robot| (robot.name.as_str(), robot.address.as_deref())).collect();
        let addresses = Addresses::read(listen.as_deref(), router.as_deref(), &robots)?;
        let peers = robot.into_iter().map(|robot| robot.name).collect();
        let start = start.map_or(Ok(Start(Pose::ORIGIN)), |start| start.parse());
        let Start(start) = start.map_err(|error| format!("start: {error}"))?;
        Ok(Self { link: LinkSettings { name, peers, key, plans }, addresses, start, shares, warnings })
    }
}

/// Help text with a command that generates a key that is hard to guess.
const GOOD_KEY: &str = "`openssl rand -hex 16` writes a good one";

/// Checks the names of the robot and of all other robots.
///
/// # Errors
/// Fails with a message if a name is invalid, or if two robots have the same name.
fn check_names(own: &str, robots: &[WrittenPeer]) -> Result<(), String> {
    let mut names = BTreeSet::new();
    for name in robots.iter().map(|robot| robot.name.as_str()).chain([own]) {
        if !is_robot_name(name) {
            return Err(format!("`{}` is no name of a robot\nhelp: {FORM}", Printable(name)));
        }
        if !names.insert(name) {
            return Err(format!("two robots have the name `{name}`"));
        }
    }
    Ok(())
}

/// Returns the name of each robot with which plans are exchanged, and the key that this robot shares with it.
///
/// # Errors
/// Fails with a message if a key is empty, or if a third robot knows the key.
fn plans(robots: &[WrittenPeer], key: &str) -> Result<Vec<(String, String)>, String> {
    let mut plans: Vec<(String, String)> = Vec::new();
    for WrittenPeer { name, plans: own, .. } in robots {
        let Some(own) = own else { continue };
        if own.is_empty() || own == key {
            return Err(format!("the key `plans` of `{name}` has to be one that only these two robots know"));
        }
        if let Some((other, _)) = plans.iter().find(|(_, known)| known == own) {
            return Err(format!(
                "`{other}` and `{name}` have the same key `plans`, so that one could write as the other"
            ));
        }
        plans.push((name.clone(), own.clone()));
    }
    Ok(plans)
}

/// Returns the error message for a text that is not a link file. The message quotes nothing from the file, because a
/// quotation could reveal a key.
fn refused(text: &str, error: &toml::de::Error) -> String {
    let before = text.get(..error.span().map_or(0, |span| span.start)).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    let message = error.message().replace('\n', "; ");
    let message = match message.split_once("expected ") {
        Some((before, expected)) if before.starts_with("invalid ") => format!("expected {expected}"),
        Some(_) | None => message,
    };
    format!("line {line}: {message}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "name = \"ada\"\nlisten = \"127.0.0.1:7401\"\nkey = \"k\"\nstart = \"1, 0, 90\"\nshares = [\"heading\"]\n\
                        [[robot]]\nname = \"bob\"\naddress = \"[::1]:7402\"\n";

    #[test]
    fn a_file_names_the_robots_and_their_addresses() {
        let LinkText { link, addresses, start, shares, .. } = LinkText::read(GOOD).unwrap();
        assert_eq!(
            (link.name.as_str(), &link.peers, start.x.0, shares),
            ("ada", &vec!["bob".to_owned()], 1.0, vec!["heading".to_owned()])
        );
        let [listen, bob] = ["127.0.0.1:7401", "[::1]:7402"].map(|text| text.parse().unwrap());
        assert_eq!(addresses, Addresses::Tcp { listen, addresses: vec![bob] });
    }

    #[test]
    fn a_wrong_file_is_refused() {
        let two = "[[robot]]\nname = \"eve\"\naddress = \"[::1]:7403\"\nplans = \"of two\"\n[[robot]]";
        for (from, to, words) in [
            ("127.0.0.1:7401", "localhost:7401", "`localhost:7401` is no address"),
            ("[::1]:7402", "10.0.0.1", "`10.0.0.1` is no address"),
            ("\"bob\"", "\"ada\"", "two robots have the name `ada`"),
            ("\"bob\"", "\"\"", "`` is no name of a robot\nhelp: a name is a letter, then letters, digits and `_`"),
            ("\"ada\"", "\"ada\\n\"", "is no name of a robot"),
            ("\"k\"", "\"\"", "the key is empty"),
            ("1, 0, 90", "1, 0", "start: expected x,y,heading"),
            (
                "7402\"",
                "7402\"\nplans = \"k\"",
                "the key `plans` of `bob` has to be one that only these two robots know",
            ),
            (
                "7402\"",
                "7402\"\nplans = \"\"",
                "the key `plans` of `bob` has to be one that only these two robots know",
            ),
            ("listen", "listens", "line 2: unknown field `listens`"),
        ] {
            let refused = LinkText::read(&GOOD.replace(from, to)).unwrap_err();
            assert!(refused.contains(words), "{to}: {refused}");
        }
        let shared = GOOD.replace("[[robot]]", two).replace("7402\"", "7402\"\nplans = \"of two\"");
        let refused = LinkText::read(&shared).unwrap_err();
        assert_eq!(refused, "`eve` and `bob` have the same key `plans`, so that one could write as the other");
    }

    #[test]
    fn a_message_contains_no_key() {
        for key in ["\"0123secret", "0123secret", "[\"0123secret\"]", "\"0123secret\" = 5", "98765"] {
            let refused = LinkText::read(&GOOD.replace("\"k\"", key)).unwrap_err();
            assert!(refused.starts_with("line 3: "), "{refused}");
            assert!(!refused.contains("secret") && !refused.contains("98765"), "{refused}");
        }
    }

    #[test]
    fn a_short_key_causes_a_warning() {
        let text = GOOD.replace("7402\"", "7402\"\nplans = \"0123456789abcde\"");
        let warnings = LinkText::read(&text).unwrap().warnings;
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(
            warnings[0].starts_with("the key is short") && warnings[1].starts_with("the key `plans` of `bob` is short")
        );
        let good = text.replace("\"k\"", "\"0123456789abcdef\"").replace("0123456789abcde\"", "0123456789abcde-\"");
        assert_eq!(LinkText::read(&good).unwrap().warnings, Vec::<String>::new());
    }
}
