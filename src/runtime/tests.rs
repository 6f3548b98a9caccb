//! What the tests of several modules use of the runtime: a loop without a mission, an archive with gaps, and waits
//! with a time limit. The tests themselves are beside the code that they test.

pub(crate) mod obedient;
pub(crate) mod partial_archive;
pub(crate) mod within;
