//! The image in an engine: started as its documentation says, used through its published port, ended, killed, upgraded, and put on
//! volumes as clusters make them. What the program does behind its doors is tested in `service`.
//!
//! `.ci/image` builds the image and says which engine runs it. Without one the tests say so and pass; with
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
