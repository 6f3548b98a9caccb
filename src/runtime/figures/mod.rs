//! What the program counts and measures about itself since its start, for monitoring. Every number is atomic, and
//! every series exists from the start. So counting never waits and never allocates, whatever arrives from outside.
//! `handed` counts what is on record. The format is that of `prometheus_client`. A door decides who may read the
//! figures.

mod handed;
mod latency;
mod series;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::{Registry, Unit};

use super::clock::Clock;
use super::store::StoreStatus;
use hallsweep_core::command::{Command, Door, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::CODES;
use hallsweep_core::units::WallTime;

pub use handed::HandedPages;
pub use latency::Latency;
pub use series::{OTHER, Series, flag};

/// Doors whose connections are counted, by their names in records.
pub const DOORS: [&str; 3] = ["http", "mqtt", "coap"];

/// Number of lines of the program's log that were lost. The counter is static, because the log exists before the
/// figures.
pub static LOG_LINES_LOST: LazyLock<Counter> = LazyLock::new(Counter::default);

const OUTCOMES: [&str; 2] = ["accepted", "refused"];

/// All figures of a program. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Figures(Arc<Families>);

#[derive(Debug)]
struct Families {
    clock: Clock,
    started: WallTime,
    missions_begun: Counter,
    missions_ended: Series<1, Counter>,
    phases: Series<1, Counter>,
    steps: Counter,
    turns: Counter,
    stops: Counter,
    commands: Series<2, Counter>,
    refusals: Series<1, Counter>,
    luggage: Counter,
    photos: Counter,
    verdicts: Series<1, Counter>,
    alarms: Counter,
    connections: Series<1, Gauge>,
    journal_last_entry: Gauge,
    store_failing: Gauge,
    store_losses: Counter,
    /// Time from handing a page to the store until the store reports it as stored.
    records: Latency,
    /// Time from when the loop takes a command until it answers.
    answers: Latency,
    /// Time from when a STOP halts the robots until the loop handles it.
    stopping: Latency,
    /// Time at which the oldest unhandled STOP was raised, in nanoseconds since the start; 0 if the loop has handled
    /// every STOP.
    unheard: AtomicU64,
}

/// Counts a connection as open until this value is dropped.
#[derive(Debug)]
pub struct Connected(Gauge);

impl Default for Families {
    fn default() -> Families {
        let clock = Clock::default();
        let phases = || Series::new(["phase"], PhaseName::ALL.map(|phase| [phase.name()]));
        let commands = Command::CODES.into_iter().chain([OTHER]);
        let codes = CODES.into_iter().map(|(code, _)| code).chain([OTHER]);
        Families {
            clock,
            started: clock.now().wall,
            missions_begun: Counter::default(),
            missions_ended: phases(),
            phases: phases(),
            steps: Counter::default(),
            turns: Counter::default(),
            stops: Counter::default(),
            commands: Series::new(
                ["command", "outcome"],
                commands.flat_map(|command| OUTCOMES.map(|outcome| [command, outcome])),
            ),
            refusals: Series::new(["code"], codes.map(|code| [code])),
            luggage: Counter::default(),
            photos: Counter::default(),
            verdicts: Series::new(["verdict"], [Verdict::Safe, Verdict::Danger].map(|verdict| [verdict.name()])),
            alarms: Counter::default(),
            connections: Series::new(["door"], DOORS.map(|door| [door])),
            journal_last_entry: Gauge::default(),
            store_failing: Gauge::default(),
            store_losses: Counter::default(),
            records: Latency::default(),
            answers: Latency::default(),
            stopping: Latency::default(),
            unheard: AtomicU64::new(0),
        }
    }
}

impl Figures {
    #[must_use = "it counts as long as this lives"]
    pub fn connected(&self, door: Door) -> Connected {
        let open = self.0.connections.at([door.0]).cloned().unwrap_or_default();
        open.inc();
        Connected(open)
    }

    /// Notes that a STOP is raised. Must be called before the loop can see the STOP.
    pub(super) fn raise_stop(&self) {
        self.0.stops.inc();
        // Keeps the time of an earlier unhandled STOP, because that STOP has waited longer.
        let now = nanos(self.0.clock.since_start()).max(1);
        let _ = self.0.unheard.compare_exchange(0, now, Ordering::Relaxed, Ordering::Relaxed);
    }

    /// Measures how long the oldest STOP has waited. Must be called when the loop has handled every raised STOP.
    pub(super) fn hear_stops(&self) {
        let raised = self.0.unheard.swap(0, Ordering::Relaxed);
        if raised != 0 {
            let now = self.0.clock.since_start();
            self.0.stopping.observe(now.saturating_sub(Duration::from_nanos(raised)));
        }
    }

    pub(super) fn answered(&self, after: Duration) {
        self.0.answers.observe(after);
    }

    /// Notes the status of the store. `losses` is the number of losses since the last status, not the total.
    pub(super) fn hear_store(&self, word: &StoreStatus, losses: u64) {
        self.0.journal_last_entry.set(i64::try_from(word.kept.0).unwrap_or(i64::MAX));
        self.0.store_failing.set(i64::from(word.failure.is_some()));
        self.0.store_losses.inc_by(losses);
    }

    pub fn register(&self, registry: &mut Registry) {
        self.register_program(registry);
        self.register_mission(registry);
        self.register_doors_and_store(registry);
    }

    fn register_program(&self, to: &mut Registry) {
        let build = Info::new([("version", env!("CARGO_PKG_VERSION"))]);
        to.register("build", "The version of the program", build);
        let started = Gauge::<f64, AtomicU64>::default();
        #[expect(clippy::cast_precision_loss, reason = "a millisecond of this century is exact")]
        started.set(self.0.started.unix_ms as f64 / 1000.0);
        to.register_with_unit("start_time", "When the program was started, in seconds since 1970", Unit::Seconds, started);
        let lost = "Log lines that could not be written to standard error";
        to.register("log_lines_lost", lost, LOG_LINES_LOST.clone());
    }

    fn register_mission(&self, to: &mut Registry) {
        let all = &*self.0;
        to.register("missions_begun", "Missions begun", all.missions_begun.clone());
        let ended = "Missions archived, by their last phase";
        to.register("missions_ended", ended, all.missions_ended.clone());
        to.register("phases", "Times that a mission entered a phase, by phase", all.phases.clone());
        to.register("steps", "Moves of the searching robot from one cell to the next", all.steps.clone());
        to.register("turns", "Quarter turns of the searching robot", all.turns.clone());
        to.register("stops", "STOPs received, from every sender", all.stops.clone());
        to.register("commands", "Commands recorded, by command and outcome", all.commands.clone());
        to.register("refusals", "Refused commands recorded, by code of the refusal", all.refusals.clone());
        to.register("luggage", "Pieces of luggage recorded", all.luggage.clone());
        to.register("photos", "Photos recorded", all.photos.clone());
        to.register("verdicts", "Verdicts recorded, by verdict", all.verdicts.clone());
        to.register("alarms", "Alarms recorded", all.alarms.clone());
    }

    fn register_doors_and_store(&self, to: &mut Registry) {
        let all = &*self.0;
        let connections = "Open HTTP connections that have sent a request, clients of hallsweep's own MQTT broker, and CoAP \
                           observations, by door";
        to.register("connections", connections, all.connections.clone());
        to.register("journal_last_entry", "Number of the last stored entry of the journal", all.journal_last_entry.clone());
        to.register("store_failing", "1 while the store cannot write, else 0", all.store_failing.clone());
        to.register("store_losses", "Write failures of the store that lost entries", all.store_losses.clone());
        let record = "Time from when the store receives a page of entries until the store reports the page as stored";
        to.register_with_unit("record", record, Unit::Seconds, all.records.clone());
        let command = "Time from when the loop receives a command until the loop answers, including the wait for the record";
        to.register_with_unit("command", command, Unit::Seconds, all.answers.clone());
        let stop = "Time from when a STOP halts the robots until the loop handles the STOP; if several STOPs wait, the first one \
                    counts";
        to.register_with_unit("stop", stop, Unit::Seconds, all.stopping.clone());
    }
}

#[cfg(test)]
impl Figures {
    pub(crate) fn text(&self) -> String {
        let mut registry = Registry::default();
        self.register(&mut registry);
        let mut text = String::new();
        prometheus_client::encoding::text::encode(&mut text, &registry).unwrap();
        text
    }

    /// The value of one series, such as `steps_total`.
    pub(crate) fn value(&self, series: &str) -> f64 {
        let text = self.text();
        let line = text.lines().find_map(|line| line.strip_prefix(series)?.strip_prefix(' '));
        line.unwrap_or_else(|| panic!("no {series} in\n{text}")).parse().unwrap()
    }
}

impl Drop for Connected {
    fn drop(&mut self) {
        self.0.dec();
    }
}

fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Seq;

    #[test]
    fn a_connection_counts_as_long_as_it_lives_and_at_its_own_door() {
        let figures = Figures::default();
        let open = |door: &str| figures.value(&format!("connections{{door=\"{door}\"}}"));
        let connections: Vec<_> = (0..3).map(|_| figures.connected(Door("mqtt"))).collect();
        let other = figures.connected(Door("http"));
        assert_eq!((open("http"), open("mqtt"), open("coap")), (1.0, 3.0, 0.0));
        drop((connections, other));
        assert_eq!((open("http"), open("mqtt")), (0.0, 0.0));
    }

    #[test]
    fn every_stop_counts_and_those_that_are_heard_together_are_measured_once() {
        let figures = Figures::default();
        figures.hear_stops();
        assert_eq!((figures.value("stops_total"), figures.value("stop_seconds_count")), (0.0, 0.0));
        for heard in [1.0, 2.0] {
            (0..3).for_each(|_| figures.raise_stop());
            figures.hear_stops();
            figures.hear_stops();
            assert_eq!((figures.value("stops_total"), figures.value("stop_seconds_count")), (3.0 * heard, heard));
        }
    }

    /// The clock of the test is paused, so only the test's own waits take time.
    #[tokio::test(start_paused = true)]
    async fn of_several_stops_that_are_unheard_the_first_is_measured() {
        let figures = Figures::default();
        figures.raise_stop();
        tokio::time::sleep(Duration::from_secs(5)).await;
        figures.raise_stop();
        figures.hear_stops();
        let within = |bound: &str| figures.value(&format!("stop_seconds_bucket{{le=\"{bound}\"}}"));
        assert_eq!((within("2.5"), within("10.0")), (0.0, 1.0));
    }

    #[test]
    fn the_word_of_the_store_is_shown() {
        let figures = Figures::default();
        let store = || ["journal_last_entry", "store_failing", "store_losses_total"].map(|series| figures.value(series));
        let failed = StoreStatus { kept: Seq(7), failure: Some("full".into()), losses: 5, kept_back: 0 };
        figures.hear_store(&failed, 2);
        assert_eq!(store(), [7.0, 1.0, 2.0]);
        figures.hear_store(&StoreStatus { kept: Seq(9), failure: None, ..failed }, 0);
        assert_eq!(store(), [9.0, 0.0, 2.0]);
    }

    #[test]
    fn a_door_that_nobody_knows_makes_no_series() {
        let figures = Figures::default();
        let before = figures.text();
        let _connected = figures.connected(Door("smoke signals"));
        assert_eq!(figures.text(), before);
    }
}
