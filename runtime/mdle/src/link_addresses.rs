//! Addresses in a link file: the addresses of the robots, or the address of a router (docs/src/many_robots.md).

use std::net::SocketAddr;

/// Error message for a link file without an address.
const NO_ADDRESS: &str = "the address at which the robot listens is missing: write `listen = \"192.168.1.7:7400\"`, or \
                          `router = \"tcp/192.168.1.5:7447\"` for a link by a router";

/// Addresses in a link file.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Addresses {
    /// The robot's own address, and the addresses of its peers; the addresses are in the order of the peers' names.
    Tcp { listen: SocketAddr, addresses: Vec<SocketAddr> },
    /// The router's address.
    Router(SocketAddr),
}

impl Addresses {
    /// Reads the address at which the robot listens, or the address of a router. `robots` contains the names and the
    /// addresses of the other robots.
    ///
    /// # Errors
    /// Fails with a message if an address is missing, invalid or superfluous.
    pub(crate) fn read(
        listen: Option<&str>,
        router: Option<&str>,
        robots: &[(&str, Option<&str>)],
    ) -> Result<Self, String> {
        let Some(router) = router else {
            let listen = listen.ok_or_else(|| NO_ADDRESS.to_owned())?;
            let at = |(name, at): &(&str, Option<&str>)| {
                let help = "write one, as `address = \"192.168.1.7:7400\"`";
                address(at.ok_or_else(|| format!("the robot `{name}` has no `address`\nhelp: {help}"))?)
            };
            let addresses = robots.iter().map(at).collect::<Result<_, _>>()?;
            return Ok(Self::Tcp { listen: address(listen)?, addresses });
        };
        if listen.is_some() {
            return Err("a robot with a `router` does not listen: leave out `listen`, or `router`".to_owned());
        }
        if let Some((name, _)) = robots.iter().find(|(_, at)| at.is_some()) {
            return Err(format!("the router leads to `{name}`: leave out its `address`, or `router`"));
        }
        let help = "write `tcp/`, numbers and a port, as in `tcp/192.168.1.5:7447`";
        let at = router.strip_prefix("tcp/").and_then(|at| at.parse().ok());
        at.map(Self::Router).ok_or_else(|| format!("`{router}` is no address of a router: {help}"))
    }
}

/// Parses an address in numeric form. Host names are refused, because looking them up may take long.
fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| format!("`{text}` is no address: write numbers and a port, as in `192.168.1.7:7400`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_router_stands_for_all_addresses() {
        let router = Addresses::read(None, Some("tcp/127.0.0.1:7447"), &[("bob", None)]);
        assert_eq!(router, Ok(Addresses::Router("127.0.0.1:7447".parse().unwrap())));
    }

    #[test]
    fn a_wrong_address_is_refused() {
        let bob = Some("[::1]:7402");
        for (listen, router, bob, words) in [
            (None, None, bob, "the address at which the robot listens is missing: write `listen = "),
            (Some("127.0.0.1:7401"), None, None, "the robot `bob` has no `address`\nhelp: write one, as"),
            (Some("127.0.0.1:7401"), Some("tcp/1.2.3.4:7447"), None, "a robot with a `router` does not listen"),
            (None, Some("tcp/1.2.3.4:7447"), bob, "the router leads to `bob`: leave out its `address`"),
            (None, Some("udp/1.2.3.4:7447"), None, "`udp/1.2.3.4:7447` is no address of a router: write `tcp/`"),
            (None, Some("1.2.3.4:7447"), None, "`1.2.3.4:7447` is no address of a router"),
            (None, Some("tcp/localhost:7447"), None, "`tcp/localhost:7447` is no address of a router"),
        ] {
            let refused = Addresses::read(listen, router, &[("bob", bob)]).unwrap_err();
            assert!(refused.contains(words), "{refused}");
        }
    }
}
