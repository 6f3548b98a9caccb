//! `hallsweep serve`: starts the program and says where it is.

use super::{Failure, Serve};
use crate::app;

/// Serves until a signal ends it.
///
/// # Errors
/// Wrong settings, a bad hall file, a port that cannot be had, or a loop that ended by itself.
pub fn run(flags: &Serve) -> Result<(), Failure> {
    let settings = super::settings(&flags.sources())?;
    app::serve(&settings, |address| {
        // Whoever closed standard output does not want to know; the program serves all the same.
        let _ = super::print(&format!("hallsweep is at http://{address}"));
    })?;
    Ok(())
}
