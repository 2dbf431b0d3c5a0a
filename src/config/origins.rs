//! The setting `cors-origins`: which web pages may send requests.

use std::fmt;
use std::str::FromStr;

use super::authority::Authority;
use crate::fault::shortened;

/// Maximum number of origins in the list, since each response searches all of them.
const MAX_ORIGINS: usize = 64;

/// The web pages that may send requests, by their origins.
#[derive(Clone, PartialEq, Eq, Default)]
pub enum CorsOrigins {
    /// Pages of this machine if the service listens on a loopback address; otherwise none.
    #[default]
    Usual,
    /// No pages.
    None,
    /// Pages of this machine: any port of `localhost` and of loopback addresses.
    Loopback,
    /// All pages.
    Any,
    /// Pages of the origins in this list.
    Listed(Vec<String>),
}

impl CorsOrigins {
    /// Returns whether pages of an origin may send requests to a service that listens on `address`.
    pub fn allows(&self, origin: &str, address: std::net::IpAddr) -> bool {
        match self {
            Self::Usual => address.is_loopback() && is_loopback(origin),
            Self::None => false,
            Self::Loopback => is_loopback(origin),
            Self::Any => true,
            Self::Listed(origins) => origins.iter().any(|known| known == origin),
        }
    }

    /// Reads the entries of the setting.
    fn of<'a>(entries: impl Iterator<Item = &'a str>) -> Result<Self, String> {
        let entries: Vec<&str> = entries.map(str::trim).take(MAX_ORIGINS + 1).collect();
        match entries.as_slice() {
            ["*"] => Ok(Self::Any),
            ["none"] => Ok(Self::None),
            ["loopback"] => Ok(Self::Loopback),
            [] => Err("it names no origin; give none, loopback, *, or origins like https://example.org".to_owned()),
            entries if entries.len() > MAX_ORIGINS => {
                Err(format!("it names more than {MAX_ORIGINS} origins; name fewer, or give *"))
            }
            entries => entries.iter().map(|entry| origin(entry)).collect::<Result<_, _>>().map(Self::Listed),
        }
    }
}

/// Returns an origin as browsers write it: in lower case, without the default port of `http` or `https`.
fn origin(entry: &str) -> Result<String, String> {
    let remedy = "write none, loopback, *, or origins like https://example.org or http://localhost:3000";
    let wrong = || format!("\"{}\" is no origin; {remedy}", shortened(entry));
    let (scheme, rest) = entry.split_once("://").ok_or_else(wrong)?;
    let is_scheme = scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
    let authority = Authority::parse(rest).filter(|_| is_scheme).ok_or_else(wrong)?;
    let scheme = scheme.to_ascii_lowercase();
    let host = authority.host.to_ascii_lowercase();
    let host = if host.contains(':') { format!("[{host}]") } else { host };
    Ok(match (scheme.as_str(), authority.port) {
        (_, None) | ("http", Some(80)) | ("https", Some(443)) => format!("{scheme}://{host}"),
        (_, Some(port)) => format!("{scheme}://{host}:{port}"),
    })
}

fn is_loopback(origin: &str) -> bool {
    let rest = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    rest.and_then(Authority::parse).is_some_and(|authority| authority.is_loopback())
}

impl FromStr for CorsOrigins {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::of(text.split(','))
    }
}

/// Writes the origins as in the setting.
impl fmt::Debug for CorsOrigins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usual => f.write_str("loopback on a loopback address, else none"),
            Self::None => f.write_str("none"),
            Self::Loopback => f.write_str("loopback"),
            Self::Any => f.write_str("*"),
            Self::Listed(origins) => f.write_str(&origins.join(",")),
        }
    }
}
