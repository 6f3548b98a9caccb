//! What tests of many rooms use of the runtime: a loop without a mission, an archive with gaps, and waits with an end. The
//! tests themselves are beside what they test.

pub(crate) mod obedient;
pub(crate) mod partial_archive;
pub(crate) mod within;
