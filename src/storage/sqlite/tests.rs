//! Tests of the store on disk, through the traits `Store` and `Archive` and by looking at the files themselves.

mod archives;
mod chain;
mod crash;
mod faults;
mod files;
mod kept;
mod memory;
mod missions;
mod mounts;
mod photos;
mod starts;
mod testing;
mod unpacked;
