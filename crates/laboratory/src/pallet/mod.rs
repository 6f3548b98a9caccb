//! The pallet scenario in simulated time. A yard, the simulated pair of robots, its three behaviour trees and a
//! simulated operator are joined in one plain loop (`run`). The same seed gives the same run. The trees are described
//! in `hallsweep_core::retrieval`.
//!
//! ```text
//!   team ── proposals ─► gate ── orders ─► pair          every 100 ms, unless the robots must stand still
//!    ▲  └── sayings ─► operator (acknowledges, START)      │
//!    └────────── view ◄── crew (what is known) ◄── reports ┘
//! ```

mod crew;
mod drawing;
mod json;
mod mishap;
mod operator;
mod record;
mod report;
mod run;
mod shown;
mod words;
mod yard;

pub use drawing::{TITLE, drawing};
pub use json::PalletJson;
pub use mishap::{AskedFault, BeyondError, FaultError, Mishap, Missed, asked, missed, parcel_number};
pub use record::{Entry, Figures, Frame, News, PalletFault, Phase};
pub use report::ReportJson;
pub use run::{Asked, PalletRun};
pub use shown::Pallet;
pub use words::{kind, rows, words};
pub use yard::{MOST_PARCELS, ParcelsError, Yard};
// Callers need this type to read `Figures::holding`.
pub use hallsweep_sim::pair::Spread;
