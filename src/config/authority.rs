//! Hosts with ports, as the headers `Host` and `Origin` write them (RFC 3986, section 3.2; RFC 9110, section 7.2).

use std::net::{IpAddr, Ipv6Addr};

/// A host with an optional port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Authority<'a> {
    /// The host: a name or an address; IPv6 addresses have no brackets.
    pub host: &'a str,
    /// The port, if given.
    pub port: Option<u16>,
}

impl<'a> Authority<'a> {
    /// Reads `host [":" port]`. Returns `None` for anything else, such as an empty host, user information, or a port
    /// above 65,535.
    pub fn parse(text: &'a str) -> Option<Self> {
        let (host, after) = if let Some(rest) = text.strip_prefix('[') {
            rest.split_once(']').filter(|(host, _)| host.parse::<Ipv6Addr>().is_ok())?
        } else {
            let (host, after) = text.split_at(text.find(':').unwrap_or(text.len()));
            (!host.is_empty() && host.bytes().all(is_of_names)).then_some((host, after))?
        };
        // a colon without a port is valid, and means the default port of the scheme
        let digits = if after.is_empty() { "" } else { after.strip_prefix(':')? };
        let port = match digits {
            "" => None,
            digits if digits.bytes().all(|byte| byte.is_ascii_digit()) => Some(digits.parse().ok()?),
            _ => return None,
        };
        Some(Self { host, port })
    }

    /// Returns whether the host is this machine: `localhost`, or an address like `127.0.0.1` or `::1`.
    pub fn is_loopback(&self) -> bool {
        self.host.eq_ignore_ascii_case("localhost") || self.host.parse().is_ok_and(|ip: IpAddr| ip.is_loopback())
    }
}

/// Returns whether a host name may contain a byte.
fn is_of_names(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"-._~!$&'()*+,;=%".contains(&byte)
}
