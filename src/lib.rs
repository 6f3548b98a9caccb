//! hallsweep: a robot searches an evacuated airport hall for dangerous luggage. START HERE.
//!
//! ```text
//!  browser ─ HTTP ─► Command ─► Handle ─► Engine::handle_command ─► Effect ─► RobotLink ─► robot or simulator
//!     ▲                                        ▲                     │                        │
//!     │                                        └─── handle_event ◄───┼──── RobotEvent ◄───────┘
//!     └────── watch<Arc<Snapshot>> ◄── World ──┘                     └─► Record ─► store ─► Recorded ─► handle_event
//! ```
//! Commands go from left to right, facts go from right to left. `hallsweep_core` depends on `behaviour-trees` and on
//! no other part of the program, which Cargo enforces. Within the program `tests/tidy.rs` enforces these rules. Doors
//! (HTTP, CoAP, MQTT) use `runtime` and `api`. Robots and storage use `runtime`; robots also use their settings.
//! Doors and robots never use each other, and no door uses another door. Only `app` and the command line use all of
//! these. Read `docs/architecture.md` next, then `hallsweep_core::mission`.

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
