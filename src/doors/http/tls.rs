//! Encrypted connections with rustls. The settings name the files of the certificate and the key. The time limit of a
//! handshake is in `hearing::connection`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustls::ServerConfig;
use rustls::crypto::ring;
use rustls::pki_types::pem::{self, PemObject};
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::TlsAcceptor;

/// What a door needs for TLS 1.2 and 1.3. Cheap to clone.
#[derive(Clone)]
pub struct Tls(pub(super) TlsAcceptor);

#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    #[error("setting {setting} = {:?}: {problem}; {advice}", .path.display().to_string())]
    File { setting: &'static str, path: PathBuf, problem: String, advice: &'static str },
    /// The certificate and the key do not belong together, or their kind is unknown.
    #[error(
        "the certificate in {} and the key in {} cannot be used together: {problem}; name the key of this certificate, and \
         put the certificate first in its file", .certificate.display(), .key.display()
    )]
    Pair { certificate: PathBuf, key: PathBuf, problem: String },
}

impl Tls {
    /// Reads the certificate and the key. Both files must be PEM.
    pub fn load(certificate: &Path, key: &Path) -> Result<Tls, TlsError> {
        let chain = CertificateDer::pem_file_iter(certificate).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let chain = chain.and_then(|chain| if chain.is_empty() { Err(pem::Error::NoItemsFound) } else { Ok(chain) });
        let chain = chain.map_err(|error| TlsError::File {
            setting: "http.tls_certificate",
            path: certificate.to_owned(),
            problem: in_words(&error, "the file contains no certificate"),
            advice: "name a PEM file that contains BEGIN CERTIFICATE and that the user of hallsweep can read",
        })?;
        let secret = PrivateKeyDer::from_pem_file(key).map_err(|error| TlsError::File {
            setting: "http.tls_key",
            path: key.to_owned(),
            problem: in_words(&error, "the file contains no private key that can be read without a password"),
            advice: "name a PEM file that contains BEGIN PRIVATE KEY and that the user of hallsweep can read",
        })?;
        let config = config(chain, secret).map_err(|error| TlsError::Pair {
            certificate: certificate.to_owned(),
            key: key.to_owned(),
            problem: error.to_string(),
        })?;
        Ok(Tls(TlsAcceptor::from(Arc::new(config))))
    }
}

fn config(chain: Vec<CertificateDer<'static>>, key: PrivateKeyDer<'static>) -> Result<ServerConfig, rustls::Error> {
    let provider = Arc::new(ring::default_provider());
    let versions = ServerConfig::builder_with_provider(provider).with_safe_default_protocol_versions()?;
    let mut config = versions.with_no_client_auth().with_single_cert(chain, key)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(config)
}

/// Returns what is wrong with a file. The text never quotes the file, because the file may be the secret key.
fn in_words(error: &pem::Error, empty: &str) -> String {
    if let pem::Error::Io(error) = error {
        return format!("the file cannot be read: {error}");
    }
    if matches!(error, pem::Error::NoItemsFound) { empty.to_owned() } else { "the file is damaged, or is no PEM file".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls");

    fn said(certificate: &str, key: &str) -> String {
        let path = |name: &str| Path::new(FOLDER).join(name);
        Tls::load(&path(certificate), &path(key)).err().map(|error| error.to_string()).unwrap_or_default()
    }

    #[test]
    fn a_certificate_and_its_key_are_taken() {
        assert_eq!(said("test-only-certificate.pem", "test-only-key.pem"), "");
    }

    #[test]
    fn what_is_wrong_is_said_with_the_setting_the_file_and_what_to_do() {
        let cases = [
            ("no-such.pem", "test-only-key.pem", ["http.tls_certificate", "no-such.pem", "cannot be read"]),
            ("test-only-key.pem", "test-only-key.pem", ["http.tls_certificate", "no certificate", "BEGIN CERTIFICATE"]),
            ("test-only-certificate.pem", "no-such.pem", ["http.tls_key", "no-such.pem", "cannot be read"]),
            ("test-only-certificate.pem", "test-only-certificate.pem", ["http.tls_key", "no private key", "BEGIN PRIVATE KEY"]),
            ("test-only-certificate.pem", "test-only-other-key.pem", ["test-only-other-key.pem", "together", "name the key"]),
        ];
        for (certificate, key, wanted) in cases {
            let said = said(certificate, key);
            assert!(wanted.iter().all(|words| said.contains(words)), "{said}");
        }
    }
}
