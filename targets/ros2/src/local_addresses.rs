//! Reads the addresses of this computer, and checks that the only network that the driver may use is among them.

use std::fs;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};

/// File that lists the routes of this computer, including the routes to its own addresses.
const ROUTES: &str = "/proc/net/fib_trie";

/// Parses the value `text` of the key `network`, which is an address. Returns `None` if `text` is empty, which means
/// all networks.
///
/// # Errors
/// Returns a sentence with the reason and the addresses of this computer if `text` is not an address, if no computer
/// can have this address, or if the middleware cannot use it.
pub(crate) fn read(text: &str) -> Result<Option<Ipv4Addr>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    let why = match text.parse() {
        Ok(IpAddr::V4(address)) if address.is_unspecified() => {
            "which stands for all addresses; leave `network` empty for all networks"
        }
        Ok(IpAddr::V4(address)) if address.is_multicast() => "which is an address of multicast",
        Ok(IpAddr::V4(address)) if address.is_broadcast() => "which is an address of broadcast",
        Ok(IpAddr::V4(address)) => return Ok(Some(address)),
        Ok(IpAddr::V6(_)) => "which is an address of IPv6, and the driver uses only IPv4",
        Err(_) => "and has to be an address of IPv4, such as 192.168.1.5",
    };
    Err(refusal(text, why, &Routes::of_this_computer()))
}

/// Checks that `address` belongs to this computer.
///
/// # Errors
/// Returns a sentence that lists the addresses of this computer.
pub(crate) fn check(address: Ipv4Addr) -> Result<(), String> {
    Routes::of_this_computer().check(address)
}

/// Returns the error message about the value of the key `network`; `why` is the reason.
fn refusal(network: &str, why: &str, routes: &Routes) -> String {
    let own: Vec<_> = routes.own.iter().map(Ipv4Addr::to_string).collect();
    let has = if own.is_empty() { "none of IPv4".to_owned() } else { own.join(", ") };
    let network = mdle_serial::shortened(network);
    format!("`network` is `{network}`, {why}; this computer has {has}")
}

/// Addresses in the routing table of a computer.
struct Routes {
    /// Addresses of the computer's network interfaces.
    own: Vec<Ipv4Addr>,
    /// Broadcast addresses of the computer's networks.
    broadcast: Vec<Ipv4Addr>,
}

impl Routes {
    fn of_this_computer() -> Self {
        Self::of(&fs::read_to_string(ROUTES).unwrap_or_default())
    }

    /// Parses the addresses in `text`, the contents of the file [`ROUTES`].
    fn of(text: &str) -> Self {
        let lines: Vec<_> = text.lines().map(str::trim).collect();
        let of_kind = |kind: &str| {
            let pairs = lines.windows(2).filter_map(|pair| match pair {
                [leaf, route] if *route == kind => leaf.strip_prefix("|-- ")?.parse().ok(),
                [..] => None,
            });
            let mut addresses: Vec<_> = pairs.collect();
            addresses.sort();
            addresses.dedup();
            addresses
        };
        Self { own: of_kind("/32 host LOCAL"), broadcast: of_kind("/32 link BROADCAST") }
    }

    fn check(&self, address: Ipv4Addr) -> Result<(), String> {
        // Without a routing table, the system can tell: it lets a program bind only to the computer's own addresses.
        if self.own.contains(&address) || (self.own.is_empty() && UdpSocket::bind((address, 0)).is_ok()) {
            return Ok(());
        }
        let is_broadcast = self.broadcast.contains(&address);
        let what = if is_broadcast { "an address of broadcast" } else { "no address of this computer" };
        Err(refusal(&address.to_string(), &format!("which is {what}"), self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "Main:\n  +-- 0.0.0.0/0 3 0 5\n     |-- 0.0.0.0\n        /0 universe UNICAST\n     |-- 127.0.0.0\n        \
                        /8 host LOCAL\n     |-- 192.168.1.5\n        /32 host LOCAL\n     |-- 192.168.1.255\n        /32 \
                        link BROADCAST\n     |-- 127.0.0.1\n        /32 host LOCAL\nLocal:\n     |-- 192.168.1.5\n        \
                        /32 host LOCAL\n";

    #[test]
    fn own_addresses_are_local_routes_to_one_host() {
        let routes = Routes::of(TEXT);
        assert_eq!(routes.own, [Ipv4Addr::LOCALHOST, Ipv4Addr::new(192, 168, 1, 5)]);
        assert_eq!(routes.broadcast, [Ipv4Addr::new(192, 168, 1, 255)]);
    }

    #[test]
    fn addresses_of_others_are_refused() {
        let refused = |address: [u8; 4]| Routes::of(TEXT).check(address.into()).err();
        assert_eq!(refused([192, 168, 1, 5]), None);
        for (address, what) in [
            ([203, 0, 113, 9], "no address of this computer"),
            // The system lets a program bind to this address, but the middleware finds no interface for it.
            ([127, 0, 0, 2], "no address of this computer"),
            ([192, 168, 1, 255], "an address of broadcast"),
        ] {
            let address: Ipv4Addr = address.into();
            let expected =
                format!("`network` is `{address}`, which is {what}; this computer has 127.0.0.1, 192.168.1.5");
            assert_eq!(refused(address.octets()), Some(expected));
        }
        assert_eq!(check(Ipv4Addr::LOCALHOST), Ok(()));
    }

    #[test]
    fn addresses_that_no_computer_has_are_refused() {
        assert_eq!((read(""), read("127.0.0.1")), (Ok(None), Ok(Some(Ipv4Addr::LOCALHOST))));
        for (text, why) in [
            ("0.0.0.0", "which stands for all addresses; leave `network` empty for all networks; this computer has "),
            ("224.0.0.1", "which is an address of multicast; this computer has "),
            ("255.255.255.255", "which is an address of broadcast; this computer has "),
            ("::1", "which is an address of IPv6, and the driver uses only IPv4; this computer has "),
            ("::ffff:127.0.0.1", "which is an address of IPv6"),
            ("ff02::1", "which is an address of IPv6"),
            ("fe80::dead", "which is an address of IPv6"),
            ("robot.local", "and has to be an address of IPv4, such as 192.168.1.5; this computer has "),
        ] {
            let refused = read(text).unwrap_err();
            assert!(refused.starts_with(&format!("`network` is `{text}`, {why}")), "{refused}");
        }
    }
}
