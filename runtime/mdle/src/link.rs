//! The file of `--link`: the robot's name, its address and key, and the other robots (docs/src/many_robots.md).

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::link::{LinkSettings, StateLink, Tcp, TcpSettings};
use mdle_files::Group;
use mdle_host::Refusal;
use mdle_runtime::Pose;
use mdle_sim::Start;
use serde::Deserialize;

use crate::failure::Failure;

/// Maximum size of the file, in bytes.
const LARGEST: u64 = 1_000_000;

/// A link file, as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkText {
    name: String,
    listen: String,
    key: String,
    start: Option<String>,
    #[serde(default)]
    shares: Vec<String>,
    robot: Vec<PeerText>,
}

/// Another robot, as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PeerText {
    name: String,
    address: String,
    /// Key that only the two robots have, with which they send each other plans.
    plans: Option<String>,
}

/// A link file that has been read.
#[derive(Debug)]
pub(crate) struct LinkFile {
    path: PathBuf,
    settings: TcpSettings,
    /// Pose at which the robot's odometry begins, in the axes that all robots share.
    start: Pose,
    /// Names of the modules whose attributes the robot shares.
    shares: Vec<String>,
}

impl LinkFile {
    /// Reads the file.
    ///
    /// # Errors
    /// Fails if the file cannot be read, or is no link file.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display();
        let unread = |error| Failure::Usage(format!("the file {name} of the link cannot be read: {error}"));
        let text = mdle_host::read_text(path, LARGEST).map_err(unread)?;
        let read = read(&text).map_err(|sentence| Failure::Usage(format!("{name}: {sentence}")))?;
        let (settings, start, shares) = read;
        Ok(Self { path: path.to_owned(), settings, start, shares })
    }

    /// Returns the path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the name of the plan that this robot runs of the plan of a group.
    ///
    /// # Errors
    /// The robot is not in the group.
    pub(crate) fn part(&self, group: &Group) -> Result<String, Failure> {
        let own = &self.settings.link.name;
        group.plan_of(own).ok_or_else(|| {
            Failure::Usage(format!(
                "{} is the link of the robot `{own}`, which is not in the group `{}`\nhelp: its robots are {}",
                self.path.display(),
                group.name,
                group.robots.join(", ")
            ))
        })
    }

    /// Checks that the link knows the robots that a plan names.
    ///
    /// # Errors
    /// Fails if the link does not know a robot.
    pub(crate) fn check(&self, robots: &[&str]) -> Result<(), Failure> {
        let names: Vec<&str> = self.settings.link.peers.iter().map(String::as_str).collect();
        let Some(unknown) = robots.iter().find(|robot| !names.contains(*robot)) else { return Ok(()) };
        let near = did_you_mean(unknown, &names);
        Err(Failure::Usage(format!(
            "the plan names the robot `{unknown}`, which is not in {}{near}\nhelp: its robots are {}",
            self.path.display(),
            names.join(", ")
        )))
    }

    /// Returns `true` if the robot takes plans of another robot.
    pub(crate) fn takes_plans(&self) -> bool {
        !self.settings.link.plans.is_empty()
    }

    /// Opens the link.
    ///
    /// # Errors
    /// Fails if the robot cannot listen at the address, or the system cannot create threads (exit status 2).
    pub(crate) fn open(&self) -> Result<StateLink, Refusal> {
        let LinkSettings { name, plans, .. } = &self.settings.link;
        let refused = |sentence| Refusal::Usage(format!("{}: {sentence}", self.path.display()));
        let link = Tcp::open(&self.settings).map_err(refused)?;
        let names: Vec<_> = plans.iter().map(|(name, _)| name.clone()).collect();
        let link = StateLink::new(Box::new(link), name, self.start).sharing(&self.shares);
        Ok(link.exchanging_plans(names.clone(), names))
    }
}

/// Returns the refusal of a plan that names robots without a link.
pub(crate) fn missing(robot: &str) -> Failure {
    Failure::Usage(format!(
        "the plan names the robot `{robot}`, and there is no link to it\nhelp: `--link FILE.toml` names the robots and their \
         addresses; `mdle run SCENARIO.toml` runs several simulated robots"
    ))
}

/// Reads the text of a file.
///
/// # Errors
/// Fails with a sentence if the text is no link file.
fn read(text: &str) -> Result<(TcpSettings, Pose, Vec<String>), String> {
    let file: LinkText = toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
    let LinkText { name, listen, key, start, shares, robot } = file;
    let listen = address(&listen)?;
    let (mut peers, mut addresses) = (Vec::<String>::new(), Vec::new());
    let mut keys: Vec<(String, String)> = Vec::new();
    for PeerText { name: other, address: at, plans } in robot {
        if other == name || peers.contains(&other) {
            return Err(format!("two robots have the name `{other}`"));
        }
        match plans {
            Some(own) if own.is_empty() || own == key => {
                return Err(format!("the key `plans` of `{other}` has to be one that only these two robots know"));
            }
            Some(own) => keys.push((other.clone(), own)),
            None => {}
        }
        peers.push(other);
        addresses.push(address(&at)?);
    }
    if key.is_empty() {
        return Err("the key is empty: write the same one for all robots".to_owned());
    }
    let start = start.map_or(Ok(Start(Pose::ORIGIN)), |start| start.parse());
    let Start(start) = start.map_err(|error| format!("start: {error}"))?;
    let link = LinkSettings { name, peers, key, plans: keys };
    Ok((TcpSettings { link, listen, addresses }, start, shares))
}

/// Reads a literal address. A host name is refused, as its lookup may take long.
fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| format!("`{text}` is no address: write numbers and a port, as in `192.168.1.7:7400`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "name = \"ada\"\nlisten = \"127.0.0.1:7401\"\nkey = \"k\"\nstart = \"1, 0, 90\"\nshares = [\"heading\"]\n\
                        [[robot]]\nname = \"bob\"\naddress = \"[::1]:7402\"\n";

    #[test]
    fn a_file_names_the_robots_and_their_addresses() {
        let (settings, start, shares) = read(GOOD).unwrap();
        assert_eq!(
            (settings.link.name.as_str(), settings.link.peers.len(), start.x.0, shares),
            ("ada", 1, 1.0, vec!["heading".to_owned()])
        );
    }

    #[test]
    fn a_wrong_file_is_refused() {
        for (from, to, words) in [
            ("127.0.0.1:7401", "localhost:7401", "`localhost:7401` is no address"),
            ("[::1]:7402", "10.0.0.1", "`10.0.0.1` is no address"),
            ("\"bob\"", "\"ada\"", "two robots have the name `ada`"),
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
            ("listen", "listens", "unknown field `listens`"),
        ] {
            let refused = read(&GOOD.replace(from, to)).unwrap_err();
            assert!(refused.contains(words), "{to}: {refused}");
        }
    }
}
