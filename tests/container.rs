//! The image in a container engine: started as documented, used through its published port, ended, killed,
//! upgraded, and run on volumes as clusters create them. `service` tests what the program does.
//!
//! `.ci/image` builds the image and chooses the engine. Without an engine the tests print a note and pass; with
//! `HALLSWEEP_REQUIRE_CLIENTS=1` they fail.

#[path = "container/client.rs"]
mod client;
#[path = "container/contents.rs"]
mod contents;
#[path = "container/deploying.rs"]
mod deploying;
#[path = "container/doors.rs"]
mod doors;
#[path = "container/ends.rs"]
mod ends;
#[path = "container/engine.rs"]
mod engine;
#[path = "container/volumes.rs"]
mod volumes;
