//! What tests of many rooms use of the storage: the folder of one test. The tests themselves are beside what they test.

pub(crate) mod scratch;
