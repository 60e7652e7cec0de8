//! Reads the file of `--link`, which contains the robot's name, its address and key, and the other robots
//! (docs/src/many_robots.md).

use std::io;
use std::net::SocketAddr;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::link::{Link, LinkSettings, StateLink, Tcp, TcpSettings};
use mdle_files::RobotGroup;
use mdle_host::Refusal;
use mdle_runtime::Pose;

use crate::failure::{Failure, warning};
use crate::link_addresses::Addresses;
use crate::link_text::LinkText;

/// Maximum size of the file, in bytes.
const LARGEST: u64 = 1_000_000;
/// Permission bits of a file for users other than its owner.
const OTHERS: u32 = 0o077;

/// Error message for a link file that names a router, in a program that cannot open such links.
const NO_ROUTERS: &str = "this `mdle` has no links by a router\nhelp: the one that `cargo build --release` makes in the folder \
                          `runtime/fleet` of a checkout has them";

/// Settings of a link through a router.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RouterSettings {
    /// Names and keys.
    pub link: LinkSettings,
    /// Address of the router.
    pub router: SocketAddr,
    /// File that names the router; messages show it.
    pub file: PathBuf,
}

/// Function that opens a link through a router, without waiting until the router can be reached.
///
/// # Errors
/// Fails if the system cannot create a thread.
pub type OpenRouter = fn(&RouterSettings) -> io::Result<Box<dyn Link>>;

/// Medium of a link, with the addresses that it needs.
#[derive(Debug)]
enum Medium {
    Tcp(TcpSettings),
    Router(RouterSettings, OpenRouter),
}

/// Contents of a link file.
#[derive(Debug)]
pub(crate) struct LinkFile {
    path: PathBuf,
    medium: Medium,
    /// Pose, in the coordinates that all robots share, at which the robot's odometry is zero.
    start: Pose,
    /// Names of the modules whose attributes the robot shares.
    shares: Vec<String>,
}

impl LinkFile {
    /// Reads a link file, and prints warnings about the keys in it. The file may name a router only if `open_router` is
    /// given.
    ///
    /// # Errors
    /// Fails if the file cannot be read, or is not a link file.
    pub(crate) fn read(path: &Path, open_router: Option<OpenRouter>) -> Result<Self, Failure> {
        let name = path.display();
        let unread = |error| Failure::Usage(format!("the file {name} of the link cannot be read: {error}"));
        let text = mdle_host::read_text(path, LARGEST).map_err(unread)?;
        let refused = |sentence| Failure::Usage(format!("{name}: {sentence}"));
        let LinkText { link, addresses, start, shares, warnings } = LinkText::read(&text).map_err(refused)?;
        warnings.iter().for_each(|sentence| warning(&format!("{name}: {sentence}")));
        if std::fs::metadata(path).is_ok_and(|file| file.permissions().mode() & OTHERS != 0) {
            warning(&format!("{name} has keys, and other users of this machine may read it\nhelp: `chmod 600 {name}`"));
        }
        let medium = match addresses {
            Addresses::Tcp { listen, addresses } => Medium::Tcp(TcpSettings { link, listen, addresses }),
            Addresses::Router(router) => {
                let open = open_router.ok_or_else(|| refused(NO_ROUTERS.to_owned()))?;
                Medium::Router(RouterSettings { link, router, file: path.to_owned() }, open)
            }
        };
        Ok(Self { path: path.to_owned(), medium, start, shares })
    }

    /// Returns the names and keys of the link.
    fn link(&self) -> &LinkSettings {
        match &self.medium {
            Medium::Tcp(TcpSettings { link, .. }) | Medium::Router(RouterSettings { link, .. }, _) => link,
        }
    }

    /// Returns the path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the name of this robot's plan, which is one of the plans of the group's robots.
    ///
    /// # Errors
    /// Fails if the robot is not in the group.
    pub(crate) fn part(&self, group: &RobotGroup) -> Result<String, Failure> {
        let own = &self.link().name;
        group.plan_of(own).ok_or_else(|| {
            Failure::Usage(format!(
                "{} is the link of the robot `{own}`, which is not in the group `{}`\nhelp: its robots are {}",
                self.path.display(),
                group.name,
                group.robots.join(", ")
            ))
        })
    }

    /// Checks that the link contains the robots that a plan names.
    ///
    /// # Errors
    /// Fails if the link does not contain one of these robots.
    pub(crate) fn check(&self, robots: &[&str]) -> Result<(), Failure> {
        let names: Vec<&str> = self.link().peers.iter().map(String::as_str).collect();
        let Some(unknown) = robots.iter().find(|robot| !names.contains(*robot)) else { return Ok(()) };
        let near = did_you_mean(unknown, &names);
        Err(Failure::Usage(format!(
            "the plan names the robot `{unknown}`, which is not in {}{near}\nhelp: its robots are {}",
            self.path.display(),
            names.join(", ")
        )))
    }

    /// Returns the names of the other robots.
    pub(crate) fn robots(&self) -> Vec<String> {
        self.link().peers.clone()
    }

    /// Returns `true` if the robot accepts plans from another robot.
    pub(crate) fn takes_plans(&self) -> bool {
        !self.link().plans.is_empty()
    }

    /// Opens the link.
    ///
    /// # Errors
    /// Fails if the robot cannot listen at the address, or the system cannot create threads (exit status 2).
    pub(crate) fn open(&self) -> Result<StateLink, Refusal> {
        let LinkSettings { name, plans, .. } = self.link();
        let refused = |sentence| Refusal::Usage(format!("{}: {sentence}", self.path.display()));
        let link: Box<dyn Link> = match &self.medium {
            Medium::Tcp(settings) => Box::new(Tcp::open(settings).map_err(refused)?),
            Medium::Router(settings, open) => {
                open(settings).map_err(|error| refused(format!("the link cannot be opened: {error}")))?
            }
        };
        let names: Vec<_> = plans.iter().map(|(name, _)| name.clone()).collect();
        let link = StateLink::new(link, name, self.start).sharing(&self.shares);
        Ok(link.exchanging_plans(names.clone(), names))
    }
}

/// Returns the failure for a plan that names another robot although the run has no link.
pub(crate) fn missing(robot: &str) -> Failure {
    Failure::Usage(format!(
        "the plan names the robot `{robot}`, and there is no link to it\nhelp: `--link FILE.toml` names the robots and their \
         addresses; `mdle run SCENARIO.toml` runs several simulated robots"
    ))
}
