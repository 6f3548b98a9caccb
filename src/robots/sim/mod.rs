//! The simulated robot: `hallsweep_sim` says what it does; here are the link that joins it to the loop, and the diary by which it is
//! as it was left.

mod diary;
mod link;

pub use diary::{Diary, DiaryError};
pub use link::run;
