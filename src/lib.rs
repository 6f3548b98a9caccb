//! hallsweep: a robot searches an evacuated airport hall for dangerous luggage. START HERE.
//!
//! ```text
//!  browser ─ HTTP ─► Command ─► Handle ─► Sweep::handle_command ─► Effect ─► RobotLink ─► robot or simulator
//!     ▲                                        ▲                     │                        │
//!     │                                        └─── handle_event ◄───┼──── RobotEvent ◄───────┘
//!     └────── watch<Arc<Snapshot>> ◄── World ──┘                     └─► Record ─► store ─► Recorded ─► handle_event
//! ```
//! Writes travel right, facts travel left. The rule of the house, held by `tests/tidy.rs`: `core` knows nobody; `runtime` knows
//! `core`; doors (`inbound`, through `wire`) and adapters (`outbound`) know `runtime` and `core`, never one another; only `app`
//! and the command line know them all. Read `docs/architecture.md` next, then `core::mission::table`.

pub mod access;
pub mod app;
pub mod cli;
pub mod config;
pub mod core;
pub mod headless;
pub mod inbound;
pub mod outbound;
pub mod runtime;
pub mod telemetry;
pub mod wire;
