//! The name of a hall in a process that has several.

use std::sync::Arc;

/// The name of a hall in settings, addresses, topics and keys. The hall file has a name of its own, which people see.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HallId(Arc<str>);

impl HallId {
    /// Maximum length of a name, in bytes. The name appears in a topic, a path and the name of a folder.
    pub const MOST: usize = 32;

    /// Returns `None` unless the text has 1 to `MOST` small letters, digits and hyphens, and begins with a letter.
    #[must_use]
    pub fn new(text: &str) -> Option<HallId> {
        is_plain(text, HallId::MOST).then(|| HallId(Arc::from(text)))
    }

    /// The name of the only hall of a process whose settings give it none.
    ///
    /// # Panics
    /// Never: `main` follows the rule of `new`.
    #[must_use]
    pub fn main() -> HallId {
        HallId::new("main").expect("it has small letters only")
    }

    #[must_use]
    pub fn name(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for HallId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// Whether a text has 1 to `most` small letters, digits and hyphens, and begins with a letter.
pub(super) fn is_plain(text: &str, most: usize) -> bool {
    let usable = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-';
    let begins = text.bytes().next().is_some_and(|first| first.is_ascii_lowercase());
    begins && text.len() <= most && text.bytes().all(usable)
}
