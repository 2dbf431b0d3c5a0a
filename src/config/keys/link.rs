//! Signed links: addresses that open one thing for a while, to whoever has them.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;

/// Where signed links begin.
pub const LINKS: &str = "/v1/r/";
/// What opens a job whose glTF refers to buffers: this name behind the job. The names of the buffers take its place.
pub const MODEL: &str = "model.gltf";
/// What the names of the buffers end with.
const BUFFER: &str = ".bin";
/// What a link opens that is no job in the link itself.
const BY_NAME: [&str; 3] = ["jobs/", "batches/", "artifacts/"];

/// A link that was signed: `/v1/r/{signature}/{expiry}/{rest}`.
///
/// The signature is the id of a key, a dot, and base64url of HMAC-SHA256 over the lines `GET`, the expiry and the rest
/// of the path, by the link secret of the key. That secret belongs to one key of one tenant, so that both are signed as
/// well.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// The id of the key that signed it.
    pub id: String,
    signature: Vec<u8>,
    /// When it ends, seconds since 1970.
    pub expires: u64,
    /// What it opens.
    pub rest: String,
}

/// Why an address is no signed link that opens something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkFault {
    /// It has not the form of one.
    Form,
    /// Nobody who may has signed it, or it was altered.
    Signature,
    /// Its time is over.
    Expired,
}

fn mac(link_secret: &str, expires: u64, rest: &str) -> Hmac<Sha256> {
    let mut mac = Hmac::<Sha256>::new_from_slice(link_secret.as_bytes()).expect("HMAC takes secrets of any length");
    mac.update(format!("GET\n{expires}\n{rest}").as_bytes());
    mac
}

/// Whether a job stands in the rest of a link, which may have to be done.
pub fn has_job(rest: &str) -> bool {
    !BY_NAME.iter().any(|place| rest.starts_with(place))
}

impl Link {
    /// The path that opens `rest` until it ends.
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

    /// What was signed: with a model its buffers, which stand beside it, so that a loader finds them.
    fn signed_rest(&self) -> Cow<'_, str> {
        match self.rest.split_once('/') {
            Some((job, file)) if has_job(&self.rest) && file.strip_suffix(BUFFER).is_some() => {
                Cow::Owned(format!("{job}/{MODEL}"))
            }
            _ => Cow::Borrowed(&self.rest),
        }
    }

    /// Checks it against the link secret of its key, in a time that does not depend on where the signature differs.
    ///
    /// # Errors
    /// [`LinkFault::Signature`]; [`LinkFault::Expired`] where the signature is right.
    pub fn check(&self, link_secret: &str, now_s: u64) -> Result<(), LinkFault> {
        let signed = mac(link_secret, self.expires, &self.signed_rest()).verify_slice(&self.signature);
        signed.map_err(|_| LinkFault::Signature)?;
        if self.expires <= now_s { Err(LinkFault::Expired) } else { Ok(()) }
    }
}
