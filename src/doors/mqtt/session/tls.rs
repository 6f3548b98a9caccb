//! Chooses which certificates of another broker are trusted, for `mqtts`. Our own broker is reached on loopback,
//! without TLS.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustls::crypto::ring;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::{self, PemObject};
use rustls::{ClientConfig, RootCertStore};

#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    #[error(
        "setting mqtt.certificates = {:?}: {problem}; name a PEM file that contains BEGIN CERTIFICATE and that the user of \
         hallsweep can read, or leave the setting empty for the certificates of this system", .path.display().to_string()
    )]
    File { path: PathBuf, problem: String },
    #[error(
        "this system has no certificate to verify a broker with{0}; install the package ca-certificates, or name a PEM file in \
         mqtt.certificates"
    )]
    System(String),
    #[error("connections to a broker cannot be encrypted: {0}")]
    Rustls(#[from] rustls::Error),
}

/// Reads the trusted certificates, and returns the settings for TLS 1.2 and 1.3. The broker's chain of certificates
/// must lead to a certificate in `file`. Without `file`, it must lead to one of the system's certificates.
pub fn believing(file: Option<&Path>) -> Result<Arc<ClientConfig>, TlsError> {
    let roots = file.map_or_else(of_the_system, of_file)?;
    let provider = Arc::new(ring::default_provider());
    let versions = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions()?;
    Ok(Arc::new(versions.with_root_certificates(roots).with_no_client_auth()))
}

/// Reads all certificates of the file. A damaged certificate is an error, because the operator chose this file.
fn of_file(path: &Path) -> Result<RootCertStore, TlsError> {
    let wrong = |problem: String| TlsError::File { path: path.to_owned(), problem };
    let certificates = CertificateDer::pem_file_iter(path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let certificates = certificates.map_err(|error| wrong(in_words(&error)))?;
    let mut roots = RootCertStore::empty();
    for certificate in certificates {
        roots.add(certificate).map_err(|error| wrong(format!("a certificate in the file is damaged: {error}")))?;
    }
    if roots.is_empty() { Err(wrong("the file contains no certificate".to_owned())) } else { Ok(roots) }
}

/// Reads the certificates of the system. Damaged ones are skipped, because many systems have old damaged certificates
/// that nobody needs.
fn of_the_system() -> Result<RootCertStore, TlsError> {
    let found = rustls_native_certs::load_native_certs();
    let mut roots = RootCertStore::empty();
    let (added, _) = roots.add_parsable_certificates(found.certs);
    if added > 0 {
        return Ok(roots);
    }
    Err(TlsError::System(found.errors.first().map(|error| format!(" ({error})")).unwrap_or_default()))
}

fn in_words(error: &pem::Error) -> String {
    if let pem::Error::Io(error) = error {
        return format!("the file cannot be read: {error}");
    }
    "the file is damaged, or is no PEM file".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls");

    #[test]
    fn a_certificate_is_believed() {
        assert!(believing(Some(&Path::new(FOLDER).join("test-only-certificate.pem"))).is_ok());
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said_with_its_name_and_what_to_do() {
        for (name, problem) in [("no-such.pem", "cannot be read"), ("test-only-key.pem", "the file contains no certificate")] {
            let said = believing(Some(&Path::new(FOLDER).join(name))).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(["mqtt.certificates", name, problem, "BEGIN CERTIFICATE"].iter().all(|words| said.contains(words)), "{said}");
        }
    }
}
