//! What tests of many rooms use of the interface: made-up snapshots, and the tables of the pages. The tests themselves are
//! beside what they test.

pub(crate) mod documented;
pub(crate) mod fixture;
