//! Shared by tests of many parts of the program: the folder of one test. The tests of the storage are beside the code
//! that they test.

pub(crate) mod scratch;
