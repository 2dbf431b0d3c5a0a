//! One key as the service stores it, without the secret.

use serde::Deserialize;
use subtle::ConstantTimeEq;

use super::secret::Token;
use crate::fault::shortened;

/// The name of the tenant whose keys share results, jobs and uploads with everybody who has such a key.
pub const SHARED: &str = "shared";
/// Maximum length of the name of a tenant, in characters. Twice of it would fit into no column of a list; half of it is
/// too short for the names of hosts.
const MAX_TENANT_NAME: usize = 32;

/// What a key allows; each role also allows what those before it do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum KeyRole {
    /// To read results, jobs, events and uploads of its tenant.
    Read,
    /// To send jobs and files, to cancel and to forget.
    Render,
    /// To read the metrics of the service as well.
    Admin,
}

impl KeyRole {
    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Render => "render",
            Self::Admin => "admin",
        }
    }
}

/// A key without its secret.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyEntry {
    /// The id: twelve hexadecimal digits that are part of the key.
    pub id: String,
    /// The tenant whose results, jobs and uploads the key opens.
    pub tenant: String,
    /// The role of the key.
    pub role: KeyRole,
    /// Hash of the whole key, hexadecimal.
    pub hash: String,
    /// Secret with which links are signed, hexadecimal.
    pub link: String,
    /// Time of creation, in seconds since 1970.
    pub created: u64,
    /// Time of expiry, in seconds since 1970.
    pub expires: Option<u64>,
    /// Maximum number of requests for work per minute, in place of the setting.
    pub requests_per_minute: Option<u64>,
    /// Maximum number of requests for work that are answered at once, in place of the setting.
    pub in_flight: Option<u64>,
}

impl KeyEntry {
    /// Returns whether a token is this key, compared in a time that does not depend on where they differ.
    pub fn is(&self, token: &Token) -> bool {
        self.hash.as_bytes().ct_eq(token.hash().as_bytes()).into()
    }

    /// Returns whether the key has expired.
    pub fn has_expired(&self, now_s: u64) -> bool {
        self.expires.is_some_and(|end| end <= now_s)
    }

    /// Returns the id as a number, which identifies clients with keys.
    pub fn number(&self) -> u64 {
        u64::from_str_radix(&self.id, 16).unwrap_or(u64::MAX)
    }

    /// Returns what is wrong with the entry, if anything.
    pub(super) fn fault(&self) -> Option<String> {
        let is_hex = |text: &str, n| text.len() == n && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
        if !is_hex(&self.id, 12) {
            return Some(format!("\"{}\" is no id of a key, which is 12 hexadecimal digits", shortened(&self.id)));
        }
        if !is_hex(&self.hash, 64) || !is_hex(&self.link, 64) {
            return Some(format!("hash and link of the key {} have to be 64 hexadecimal digits each", self.id));
        }
        tenant_fault(&self.tenant)
    }
}

/// Returns what is wrong with the name of a tenant, if anything.
pub fn tenant_fault(name: &str) -> Option<String> {
    let is_plain = |b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-');
    let is_fit = (1..=MAX_TENANT_NAME).contains(&name.len()) && name.bytes().all(is_plain) && !name.starts_with('-');
    (!is_fit).then(|| {
        let name = shortened(name);
        format!(
            "\"{name}\" is no name of a tenant; take 1 to {MAX_TENANT_NAME} of a to z, 0 to 9 and -, and no - at first"
        )
    })
}
