//! Trees as files: the XML of BehaviorTree.CPP 4, as its graphical editor reads and writes it. Text in, text out:
//! opening files is left to the program.

mod read;
#[cfg(test)]
mod refusals_tests;
mod write;

pub use self::read::{LONGEST_FILE, read, read_with};
pub use self::write::write;
