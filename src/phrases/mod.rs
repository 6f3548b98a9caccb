//! The texts of the pages in all languages: THE PHRASES. Each language has a folder of files with one line for each
//! phrase ([Fluent](https://projectfluent.org)). Texts for programs stay English, and are not here. `said` turns the
//! core's values into phrases.

mod language;
mod phrase;
mod said;

pub use language::Language;
#[cfg(test)]
pub(crate) use phrase::said_here;
pub use phrase::{Markup, Phrase};
