//! Signed links: addresses that open one thing for a while, to whoever has them.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;

/// Path prefix of signed links.
pub const LINKS: &str = "/v1/r/";
/// File name after the job in a link to a glTF result with buffers; the links to the buffers have their names in its
/// place.
pub const MODEL: &str = "model.gltf";
/// Suffix of the names of the buffers.
const BUFFER_SUFFIX: &str = ".bin";
/// Prefixes of links to things that are stored under a name; all other links contain a job.
const NAMED_PREFIXES: [&str; 3] = ["jobs/", "batches/", "artifacts/"];

/// A signed link: `/v1/r/{signature}/{expiry}/{rest}`.
///
/// The signature is the id of a key, a dot, and base64url of HMAC-SHA256 over the lines `GET`, the expiry and the rest
/// of the path, by the link secret of the key. That secret belongs to one key of one tenant, so that both are signed as
/// well.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// The id of the key that signed the link.
    pub id: String,
    signature: Vec<u8>,
    /// Time of expiry, in seconds since 1970.
    pub expires: u64,
    /// The rest of the path: what the link opens.
    pub rest: String,
}

/// The reason why an address is not a valid signed link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkFault {
    /// The path does not have the form of a signed link.
    Form,
    /// The signature is wrong: no valid key signed the link, or the link was altered.
    Signature,
    /// The link has expired.
    Expired,
}

fn mac(link_secret: &str, expires: u64, rest: &str) -> Hmac<Sha256> {
    let mut mac = Hmac::<Sha256>::new_from_slice(link_secret.as_bytes()).expect("HMAC takes secrets of any length");
    mac.update(format!("GET\n{expires}\n{rest}").as_bytes());
    mac
}

/// Returns whether the rest of a link contains a job, which may have to be computed.
pub fn has_job(rest: &str) -> bool {
    !NAMED_PREFIXES.iter().any(|place| rest.starts_with(place))
}

impl Link {
    /// Returns the path that opens `rest` until it expires.
    pub fn sign(id: &str, link_secret: &str, expires: u64, rest: &str) -> String {
        let signature = URL_SAFE_NO_PAD.encode(mac(link_secret, expires, rest).finalize().into_bytes());
        format!("{LINKS}{id}.{signature}/{expires}/{rest}")
    }

    /// Reads a path.
    ///
    /// # Errors
    /// [`LinkFault::Form`].
    pub fn parse(path: &str) -> Result<Self, LinkFault> {
        let parts = path.strip_prefix(LINKS).and_then(|path| {
            let (signature, path) = path.split_once('/')?;
            let (expires, rest) = path.split_once('/')?;
            let (id, signature) = signature.split_once('.')?;
            let is_number = !expires.starts_with(['0', '+']);
            let expires = expires.parse().ok().filter(|_| is_number)?;
            let signature = URL_SAFE_NO_PAD.decode(signature).ok().filter(|signature| signature.len() == 32)?;
            Some(Self { id: id.to_owned(), signature, expires, rest: rest.to_owned() })
        });
        parts.ok_or(LinkFault::Form)
    }

    /// Returns the rest that was signed: the signature of a model also opens its buffers, whose names a loader puts in
    /// the place of the model's name.
    fn signed_rest(&self) -> Cow<'_, str> {
        match self.rest.split_once('/') {
            Some((job, file)) if has_job(&self.rest) && file.strip_suffix(BUFFER_SUFFIX).is_some() => {
                Cow::Owned(format!("{job}/{MODEL}"))
            }
            _ => Cow::Borrowed(&self.rest),
        }
    }

    /// Checks the link against the link secret of its key, in a time that does not depend on where the signature
    /// differs.
    ///
    /// # Errors
    /// [`LinkFault::Signature`]; [`LinkFault::Expired`] when the signature is right.
    pub fn check(&self, link_secret: &str, now_s: u64) -> Result<(), LinkFault> {
        let signed = mac(link_secret, self.expires, &self.signed_rest()).verify_slice(&self.signature);
        signed.map_err(|_| LinkFault::Signature)?;
        if self.expires <= now_s { Err(LinkFault::Expired) } else { Ok(()) }
    }
}
