//! End-to-end tests of the real program through its public interfaces: the binary listens on a free port and is
//! driven over HTTP and the command line. The rules of the core are tested beside the core and in `simulation`; these
//! tests check that the effects of those rules reach the clients.

#[path = "service/access.rs"]
mod access;
#[path = "service/archives.rs"]
mod archives;
#[path = "service/areas.rs"]
mod areas;
#[path = "service/bundles.rs"]
mod bundles;
#[path = "service/clock.rs"]
mod clock;
#[path = "service/coap.rs"]
mod coap;
#[path = "service/coap_clients/mod.rs"]
mod coap_clients;
#[path = "service/commands.rs"]
mod commands;
#[path = "service/damage.rs"]
mod damage;
#[path = "service/data_files.rs"]
mod data_files;
#[path = "service/earlier.rs"]
mod earlier;
#[path = "service/exercise.rs"]
mod exercise;
#[path = "service/explore.rs"]
mod explore;
#[path = "service/few_descriptors.rs"]
mod few_descriptors;
#[path = "service/formats.rs"]
mod formats;
#[path = "service/halls.rs"]
mod halls;
#[path = "service/http_attacks.rs"]
mod http_attacks;
#[path = "service/journal.rs"]
mod journal;
#[path = "service/judges.rs"]
mod judges;
#[path = "service/kill.rs"]
mod kill;
#[path = "service/last_word.rs"]
mod last_word;
#[path = "service/line_robots/mod.rs"]
mod line_robots;
#[path = "service/log.rs"]
mod log;
#[path = "service/malformed.rs"]
mod malformed;
#[path = "service/map_files.rs"]
mod map_files;
#[path = "service/metrics.rs"]
mod metrics;
#[path = "service/missions.rs"]
mod missions;
#[path = "service/mqtt_attacks/mod.rs"]
mod mqtt_attacks;
#[path = "service/mqtt_clients/mod.rs"]
mod mqtt_clients;
#[path = "service/mqtt_external/mod.rs"]
mod mqtt_external;
#[path = "service/old_console.rs"]
mod old_console;
#[path = "service/openapi.rs"]
mod openapi;
#[path = "service/program.rs"]
mod program;
#[path = "service/receipts.rs"]
mod receipts;
#[path = "service/replica.rs"]
mod replica;
#[path = "service/reports.rs"]
mod reports;
#[path = "service/retrieval.rs"]
mod retrieval;
#[path = "service/robots.rs"]
mod robots;
#[path = "service/sensors.rs"]
mod sensors;
#[path = "service/shutdown.rs"]
mod shutdown;
#[path = "service/simulator.rs"]
mod simulator;
#[path = "service/start.rs"]
mod start;
#[path = "service/stop_again.rs"]
mod stop_again;
#[path = "service/stop_floods.rs"]
mod stop_floods;
#[path = "service/stop_words.rs"]
mod stop_words;
#[path = "service/stops.rs"]
mod stops;
#[path = "service/store_faults.rs"]
mod store_faults;
#[path = "service/stream.rs"]
mod stream;
#[path = "service/third_party.rs"]
mod third_party;
#[path = "service/tls.rs"]
mod tls;
#[path = "service/trees.rs"]
mod trees;
#[path = "service/verdicts.rs"]
mod verdicts;
#[path = "service/virtual_robots/mod.rs"]
mod virtual_robots;
