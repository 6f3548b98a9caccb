//! `hallsweep table`: the mission table as it is in the program, for the documentation.

use super::Failure;
use hallsweep_core::mission::table_markdown;

/// Prints the table as markdown.
///
/// # Errors
/// Standard output that cannot be written.
pub fn run() -> Result<(), Failure> {
    super::print(table_markdown().trim_end())
}
