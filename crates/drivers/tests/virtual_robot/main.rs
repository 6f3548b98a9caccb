//! Whole missions of the virtual robot, with doubles of its page and its servers, in simulated time.

mod adversities;
mod lost;
mod missions;
mod page;
mod rig;
mod rooms;
mod server;
