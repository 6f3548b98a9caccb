//! Whole missions in simulated time: seeded, without doors and without waiting. A failure prints its seed and hall.
#![expect(
    clippy::unwrap_used,
    clippy::wildcard_enum_match_arm,
    reason = "all of this is test; clippy only sees it in functions marked so"
)]

mod bare;
mod every_way;
mod halls;
mod mortal;
mod operator;
mod past;
mod public_maps;
mod random_commands;
mod random_halls;
mod random_kills;
mod random_retrievals;
mod random_robots;
mod replay;
mod retrieval;
mod retrieval_alone;
mod retrieval_faults;
mod rules_again;
mod rules_alarms;
mod rules_areas;
mod rules_closing;
mod rules_commands;
mod rules_coverage;
mod rules_crossings;
mod rules_driving;
mod rules_exercise;
mod rules_going_on;
mod rules_handing_over;
mod rules_holds;
mod rules_judges;
mod rules_luggage;
mod rules_phases;
mod rules_record;
mod rules_restart;
mod rules_stops;
mod rules_store;
mod rules_unsure;
mod seeds_early;
mod seeds_luggage;
mod seeds_suspensions;
mod shown;
mod table;
mod time_left;
mod trio;
mod two_robots;
