//! The certificates that outgoing TLS connections trust: those of the system.

use std::sync::Arc;

use rustls::crypto::ring;
use rustls::{ClientConfig, RootCertStore};

/// Returns a TLS configuration that trusts the certificates of the system, or of the file that `SSL_CERT_FILE` names.
///
/// # Errors
/// When TLS cannot be set up.
pub(crate) fn tls() -> Result<ClientConfig, rustls::Error> {
    let mut roots = RootCertStore::empty();
    // errors are ignored: a plain address needs no certificates, and a TLS connection without them fails with its own
    // error
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    of(roots)
}

/// Returns a TLS configuration that trusts no certificate, for clients of plain addresses.
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
