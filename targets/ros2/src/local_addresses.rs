//! The addresses of this computer, one of which may be the only network that the driver uses.

use std::fs;
use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};

/// File with the routes of this computer, among them those to its own addresses.
const ROUTES: &str = "/proc/net/fib_trie";

/// Checks that `address` belongs to this computer.
///
/// # Errors
/// Returns a sentence that lists the addresses of this computer.
pub(crate) fn check(address: IpAddr) -> Result<(), String> {
    let bound = UdpSocket::bind((address, 0));
    if !bound.is_err_and(|error| error.kind() == ErrorKind::AddrNotAvailable) {
        return Ok(());
    }
    let addresses = own(&fs::read_to_string(ROUTES).unwrap_or_default());
    let addresses: Vec<_> = addresses.iter().map(Ipv4Addr::to_string).collect();
    let has = match addresses.as_slice() {
        [] => "it has none for IPv4".to_owned(),
        [..] => format!("it has {}", addresses.join(", ")),
    };
    Err(format!("`network` is `{address}`, which is no address of this computer; {has}"))
}

/// Returns the computer's own addresses among the routes in `text`.
fn own(text: &str) -> Vec<Ipv4Addr> {
    let lines: Vec<_> = text.lines().map(str::trim).collect();
    let pairs = lines.windows(2).filter_map(|pair| match pair {
        [leaf, "/32 host LOCAL"] => leaf.strip_prefix("|-- ")?.parse().ok(),
        [..] => None,
    });
    let mut addresses: Vec<_> = pairs.collect();
    addresses.sort();
    addresses.dedup();
    addresses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_addresses_are_local_routes_to_one_host() {
        let text = "Main:\n  +-- 0.0.0.0/0 3 0 5\n     |-- 0.0.0.0\n        /0 universe UNICAST\n     |-- 192.168.1.5\n        \
                    /32 host LOCAL\n     |-- 192.168.1.255\n        /32 link BROADCAST\n     |-- 127.0.0.1\n        /32 \
                    host LOCAL\nLocal:\n     |-- 192.168.1.5\n        /32 host LOCAL\n";
        assert_eq!(own(text), [Ipv4Addr::LOCALHOST, Ipv4Addr::new(192, 168, 1, 5)]);
    }

    #[test]
    fn an_address_of_documentation_is_not_of_this_computer() {
        assert_eq!(check(IpAddr::V4(Ipv4Addr::LOCALHOST)), Ok(()));
        let refused = check(IpAddr::V4(Ipv4Addr::new(203, 0, 113, 9))).unwrap_err();
        assert!(
            refused.starts_with("`network` is `203.0.113.9`, which is no address of this computer; it has 127.0.0.1")
        );
    }
}
