//! Addresses at the HTTP door. Those of the default hall name no hall.

use hallsweep_core::hall::HallId;

/// Returns the address of something in a hall. `path` is its address in the default hall.
pub fn address(hall: Option<&HallId>, path: &str) -> String {
    hall.map_or_else(|| path.to_owned(), |hall| format!("/halls/{hall}{path}"))
}
