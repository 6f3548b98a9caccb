//! What the pages say to people, in every language of theirs: THE PHRASES, a folder of files for each language, a line for a phrase
//! ([Fluent](https://projectfluent.org)). What programs read stays English, and has none here.
//! How something that the core says is put into a phrase stands in `said`.

mod language;
mod phrase;
mod said;

pub use language::Language;
#[cfg(test)]
pub(crate) use phrase::said_here;
pub use phrase::{Markup, Phrase};
