//! hallsweep: a robot searches an evacuated airport hall for dangerous luggage. START HERE.
//!
//! ```text
//!  browser ─ HTTP ─► Command ─► Handle ─► Engine::handle_command ─► Effect ─► RobotLink ─► robot or simulator
//!     ▲                                        ▲                     │                        │
//!     │                                        └─── handle_event ◄───┼──── RobotEvent ◄───────┘
//!     └────── watch<Arc<Snapshot>> ◄── World ──┘                     └─► Record ─► store ─► Recorded ─► handle_event
//! ```
//! Writes travel right, facts travel left. `hallsweep_core` depends on nobody, which Cargo enforces; within the program
//! `tests/tidy.rs` enforces the rule: doors know `runtime` and `api`; robots and storage know `runtime`, and robots their
//! settings; doors and robots never know each other, nor one door another; only `app` and the command line know them all. Read
//! `docs/architecture.md` next, then `hallsweep_core::mission`.

pub mod access;
pub mod api;
pub mod app;
pub mod cli;
pub mod config;
pub mod doors;
pub mod phrases;
pub mod report;
pub mod robots;
pub mod runtime;
pub mod storage;
pub mod telemetry;
