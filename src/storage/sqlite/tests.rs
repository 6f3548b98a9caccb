//! The store on disk, asked through its ports, and what is found on the disk itself.

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
