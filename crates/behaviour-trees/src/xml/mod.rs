//! Trees as files: the XML of BehaviorTree.CPP 4, as its graphical editor reads and writes it. This crate only
//! converts text. The program opens the files.

mod read;
#[cfg(test)]
mod refusals_tests;
mod write;

pub use self::read::{LONGEST_FILE, read, read_with};
pub use self::write::write;
