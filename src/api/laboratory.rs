//! What the laboratory computes, as doors and command line show it: in JSON, in words, as drawings. Nothing of it has to do with the
//! hall. What happens in a run stands in `hallsweep_sim`.

pub mod mishap;
pub mod pallet;
mod pallet_drawing;
mod pallet_json;
pub mod pallet_report;
pub mod roomba;
