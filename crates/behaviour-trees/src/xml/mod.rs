//! Trees as files: the XML of BehaviorTree.CPP 4, as its graphical editor reads and writes it. Text in, text out: who opens the file
//! and knows its name is elsewhere.

mod read;
#[cfg(test)]
mod refusals;
mod write;

pub use self::read::{LONGEST_FILE, read, read_with};
pub use self::write::write;
