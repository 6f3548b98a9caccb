//! What the tests of several modules use of the API: made-up snapshots, and the comparison of tables in `docs/`. The
//! tests themselves are beside the code that they test.

pub(crate) mod documented;
pub(crate) mod fixture;
