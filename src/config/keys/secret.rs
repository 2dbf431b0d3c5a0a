//! The secret of a key, and what is made of it.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use sha2::{Digest, Sha256};

/// What every key begins with, so that people and scanners of repositories know one when they see it.
const PREFIX: &str = "planish_";
/// Bytes of a secret: 256 bits cannot be guessed, so that a plain hash protects them.
const SECRET_BYTES: usize = 32;
/// Bytes of an id.
const ID_BYTES: usize = 6;
/// Longest text that is looked at as a key. Half of it is shorter than keys are; twice of it is hashed for nothing.
const MOST_TOKEN: usize = 128;

/// Fills bytes with numbers that nobody can foretell; where that fails, says why.
pub type Random = fn(&mut [u8]) -> Result<(), String>;

/// A key as its client shows it: `planish_`, its id, `_`, and its secret.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Token({PREFIX}{}_...)", self.id())
    }
}

impl Token {
    /// A new key.
    ///
    /// # Errors
    /// When the system has no random numbers.
    pub fn new(random: Random) -> Result<Self, String> {
        let (mut id, mut secret) = ([0; ID_BYTES], [0; SECRET_BYTES]);
        random(&mut id)?;
        random(&mut secret)?;
        Ok(Self(format!("{PREFIX}{}_{}", hex::encode(id), URL_SAFE_NO_PAD.encode(secret))))
    }

    /// Reads what a client shows; `None` where that is no key.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, secret) = text.strip_prefix(PREFIX)?.split_once('_')?;
        let is_id = id.len() == 2 * ID_BYTES && id.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'));
        (is_id && !secret.is_empty() && text.len() <= MOST_TOKEN).then(|| Self(text.to_owned()))
    }

    /// Its id, which is no secret.
    pub fn id(&self) -> &str {
        self.0.get(PREFIX.len()..PREFIX.len() + 2 * ID_BYTES).unwrap_or_default()
    }

    /// The whole key, to be told once.
    pub fn tell(&self) -> &str {
        &self.0
    }

    /// What is kept of it: SHA-256 of `planish key`, a line break, and the key, in hexadecimal.
    pub fn hash(&self) -> String {
        self.hashed("planish key")
    }

    /// What its links are signed with: SHA-256 of `planish link`, a line break, and the key, in hexadecimal. The key
    /// itself cannot be found from it.
    pub fn link_secret(&self) -> String {
        self.hashed("planish link")
    }

    fn hashed(&self, purpose: &str) -> String {
        hex::encode(Sha256::digest(format!("{purpose}\n{}", self.0)))
    }
}
