//! The secret of a key, and the hashes derived from it.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use sha2::{Digest, Sha256};

/// Prefix of every key, by which people and secret scanners recognise one.
const KEY_PREFIX: &str = "planish_";
/// Length of a secret in bytes: 256 bits cannot be guessed, so that a plain hash protects them.
const SECRET_BYTES: usize = 32;
/// Length of an id in bytes.
const ID_BYTES: usize = 6;
/// Maximum length of a text that is examined as a key. Keys have 64 bytes, so half of it would leave no room; twice of
/// it would be hashed for nothing.
const MAX_TOKEN: usize = 128;

/// Fills bytes with unpredictable random numbers, or returns the reason why it cannot.
pub type Random = fn(&mut [u8]) -> Result<(), String>;

/// A key as its client shows it: `planish_`, the id, `_`, and the secret.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Token({KEY_PREFIX}{}_...)", self.id())
    }
}

impl Token {
    /// Creates a new key.
    ///
    /// # Errors
    /// When the system has no random numbers.
    pub fn new(random: Random) -> Result<Self, String> {
        let (mut id, mut secret) = ([0; ID_BYTES], [0; SECRET_BYTES]);
        random(&mut id)?;
        random(&mut secret)?;
        Ok(Self(format!("{KEY_PREFIX}{}_{}", hex::encode(id), URL_SAFE_NO_PAD.encode(secret))))
    }

    /// Reads a text that a client shows; `None` if it does not have the form of a key.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, secret) = text.strip_prefix(KEY_PREFIX)?.split_once('_')?;
        let is_id = id.len() == 2 * ID_BYTES && id.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
        (is_id && !secret.is_empty() && text.len() <= MAX_TOKEN).then(|| Self(text.to_owned()))
    }

    /// Returns the id, which is not secret.
    pub fn id(&self) -> &str {
        self.0.get(KEY_PREFIX.len()..KEY_PREFIX.len() + 2 * ID_BYTES).unwrap_or_default()
    }

    /// Returns the whole key, which is shown once.
    pub fn expose(&self) -> &str {
        &self.0
    }

    /// Returns the hash that is stored: SHA-256 of `planish key`, a line break, and the key, in hexadecimal.
    pub fn hash(&self) -> String {
        self.hashed("planish key")
    }

    /// Returns the secret that signs links: SHA-256 of `planish link`, a line break, and the key, in hexadecimal. The
    /// key cannot be computed from it.
    pub fn link_secret(&self) -> String {
        self.hashed("planish link")
    }

    fn hashed(&self, purpose: &str) -> String {
        hex::encode(Sha256::digest(format!("{purpose}\n{}", self.0)))
    }
}
