//! Whom calls over TLS trust: the certificates of the system.

use std::sync::Arc;

use rustls::crypto::ring;
use rustls::{ClientConfig, RootCertStore};

/// TLS that trusts the certificates of the system, or those of the file that `SSL_CERT_FILE` names.
///
/// # Errors
/// When TLS cannot be set up.
pub(crate) fn tls() -> Result<ClientConfig, rustls::Error> {
    let mut roots = RootCertStore::empty();
    // a plain address needs none; a call over TLS says that it trusts nobody
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    of(roots)
}

/// TLS that trusts nobody, for clients of plain addresses.
///
/// # Errors
/// When TLS cannot be set up.
pub(crate) fn none() -> Result<ClientConfig, rustls::Error> {
    of(RootCertStore::empty())
}

fn of(roots: RootCertStore) -> Result<ClientConfig, rustls::Error> {
    let builder = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()));
    Ok(builder.with_safe_default_protocol_versions()?.with_root_certificates(roots).with_no_client_auth())
}
