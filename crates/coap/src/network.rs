//! The network of a peer: the unit by which requests, observations and waiting datagrams are counted. Identities of
//! clients are not known here.

use std::net::{IpAddr, Ipv6Addr};

/// One IPv4 address, or one /64 of IPv6: a sender that has one address of a /64 can use all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Network(IpAddr);

impl Network {
    pub(super) fn of(address: IpAddr) -> Network {
        Network(match address.to_canonical() {
            IpAddr::V4(address) => IpAddr::V4(address),
            IpAddr::V6(Ipv6Addr::LOCALHOST) => IpAddr::V6(Ipv6Addr::LOCALHOST),
            IpAddr::V6(address) => {
                let [a, b, c, d, ..] = address.segments();
                IpAddr::V6(Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0))
            }
        })
    }

    pub(super) const fn is_loopback(&self) -> bool {
        self.0.is_loopback()
    }
}

/// Whether an address is a loopback address, in any notation: an IPv4 address may also be written as IPv6.
pub(super) fn is_this_machine(address: IpAddr) -> bool {
    Network::of(address).is_loopback()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(address: &str) -> Network {
        Network::of(address.parse().unwrap())
    }

    #[test]
    fn addresses_that_one_machine_can_take_are_one_network() {
        assert_eq!(of("2001:db8:1:2::3"), of("2001:db8:1:2:ffff::9"));
        assert_ne!(of("2001:db8:1:2::3"), of("2001:db8:1:3::3"));
        assert_ne!(of("192.0.2.1"), of("192.0.2.2"));
        assert_eq!(of("::ffff:192.0.2.1"), of("192.0.2.1"));
    }

    #[test]
    fn this_machine_is_known_in_every_writing() {
        assert!(of("127.0.0.1").is_loopback() && of("::1").is_loopback() && of("::ffff:127.0.0.1").is_loopback());
        assert!(!of("192.0.2.1").is_loopback() && !of("::").is_loopback());
    }
}
