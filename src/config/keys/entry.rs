//! What is known of a key.

use serde::Deserialize;
use subtle::ConstantTimeEq;

use super::secret::Token;
use crate::fault::shortened;

/// The name of the tenant whose keys share results, jobs and uploads with everybody who has such a key.
pub const SHARED: &str = "shared";
/// Longest name of a tenant, characters. Twice of it fits into no column of a list; half of it is too short for the
/// names of hosts.
const MOST_NAME: usize = 32;

/// What a key allows; each role also allows what those before it do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// To read results, jobs, events and uploads of its tenant.
    Read,
    /// To send jobs and files, to cancel and to forget.
    Render,
    /// To read the metrics of the service as well.
    Admin,
}

impl Role {
    /// Its name.
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
    /// Twelve hexadecimal digits, which the key begins with.
    pub id: String,
    /// Whose results, jobs and uploads it opens.
    pub tenant: String,
    /// What it allows.
    pub role: Role,
    /// Hash of the whole key, hexadecimal.
    pub hash: String,
    /// What signs its links, hexadecimal.
    pub link: String,
    /// When it was made, seconds since 1970.
    pub created: u64,
    /// When it ends, seconds since 1970.
    pub expires: Option<u64>,
    /// Most requests a minute that ask for work, in place of the setting.
    pub requests_per_minute: Option<u64>,
    /// Most such requests that are answered at once, in place of the setting.
    pub in_flight: Option<u64>,
}

impl KeyEntry {
    /// Whether this is the key, compared in a time that does not depend on where it differs.
    pub fn is(&self, token: &Token) -> bool {
        self.hash.as_bytes().ct_eq(token.hash().as_bytes()).into()
    }

    /// Whether it has come to its end.
    pub fn has_expired(&self, now_s: u64) -> bool {
        self.expires.is_some_and(|end| end <= now_s)
    }

    /// Its number, by which clients with keys are told apart.
    pub fn number(&self) -> u64 {
        u64::from_str_radix(&self.id, 16).unwrap_or(u64::MAX)
    }

    /// What is wrong with it.
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

/// What is wrong with the name of a tenant.
pub fn tenant_fault(name: &str) -> Option<String> {
    let is_plain = |b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-');
    let is_fit = (1..=MOST_NAME).contains(&name.len()) && name.bytes().all(is_plain) && !name.starts_with('-');
    (!is_fit).then(|| {
        let name = shortened(name);
        format!("\"{name}\" is no name of a tenant; take 1 to {MOST_NAME} of a to z, 0 to 9 and -, and no - at first")
    })
}
