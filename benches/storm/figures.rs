//! Results of a run as a table, and the goals that it met.

use std::time::Duration;

use crate::stops::Way;

/// Goals of safety S6, for floods whose senders have a lower priority than the program.
pub(crate) const P99: Duration = Duration::from_millis(50);
pub(crate) const WORST: Duration = Duration::from_millis(100);

/// Largest ratio, at equal priority, to the time of a message through mosquitto under the same flood.
const BESIDE: f64 = 2.0;

/// The STOPs of one run.
#[derive(Default)]
pub(crate) struct Stops {
    /// Way of each STOP, and its time from the request to the robot's port; `None` when it did not reach the robot.
    pub(crate) took: Vec<(Way, Option<Duration>)>,
    /// Epoch of the last STOP.
    pub(crate) epoch: u64,
    /// Number of STOPs before which the robot could not be started.
    pub(crate) unstarted: usize,
    /// Number of STOPs that were refused or not answered in time.
    pub(crate) unanswered: usize,
    pub(crate) is_cut_short: bool,
    pub(crate) whys: Vec<String>,
}

/// One row of the table.
pub(crate) struct Row {
    what: String,
    pub(crate) stops: Stops,
    /// Number of lost persistent connections of the operator.
    pub(crate) cut: usize,
    /// Actions of the floods, and their refusals.
    pub(crate) done: u64,
    pub(crate) away: u64,
    /// Messages that the honest clients received, and their lost connections.
    pub(crate) seen: u64,
    pub(crate) honest_cut: u64,
    pub(crate) memory_mib: u64,
    /// Log lines that no storm may cause.
    pub(crate) broke: Vec<String>,
    /// Reason why the run did not take place.
    pub(crate) failed: Option<String>,
}

/// Distribution of times.
pub(crate) struct Spread {
    pub(crate) p50: Duration,
    pub(crate) p99: Duration,
    pub(crate) worst: Duration,
}

impl Spread {
    /// Distribution of these times; `None` when there are none.
    pub(crate) fn of(mut took: Vec<Duration>) -> Option<Spread> {
        took.sort_unstable();
        let at = |percent: usize| took.get((took.len() * percent / 100).min(took.len().saturating_sub(1))).copied();
        Some(Spread { p50: at(50)?, p99: at(99)?, worst: at(100)? })
    }
}

impl Row {
    pub(crate) fn new(what: &str) -> Row {
        Row {
            what: what.to_owned(),
            stops: Stops::default(),
            cut: 0,
            done: 0,
            away: 0,
            seen: 0,
            honest_cut: 0,
            memory_mib: 0,
            broke: Vec::new(),
            failed: None,
        }
    }

    /// Distribution of the times of the STOPs that came in these ways.
    pub(crate) fn spread(&self, ways: &[Way]) -> Option<Spread> {
        Spread::of(self.stops.took.iter().filter(|(way, _)| ways.contains(way)).filter_map(|(_, took)| *took).collect())
    }

    fn lost(&self, ways: &[Way]) -> (usize, usize) {
        let of_these = self.stops.took.iter().filter(|(way, _)| ways.contains(way));
        of_these.fold((0, 0), |(lost, all), (_, took)| (lost + usize::from(took.is_none()), all + 1))
    }

    /// Failures other than late STOPs: a STOP that did not arrive, or an incomplete run.
    pub(crate) fn shortcomings(&self) -> Vec<String> {
        let (lost, _) = self.lost(&Way::ALL);
        let Stops { unstarted, unanswered, is_cut_short, .. } = self.stops;
        let counts = [
            (lost, "STOPs never came to the robot"),
            (unanswered, "STOPs were not answered"),
            (unstarted, "times the robot could not be started"),
            (self.cut, "kept connections of the operator were lost"),
            (usize::from(is_cut_short), "time ran out before all were pressed"),
        ];
        let mut found: Vec<String> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        found.extend(self.broke.iter().take(3).cloned());
        found
    }

    /// Goals of safety S6 that the run missed.
    pub(crate) fn misses(&self) -> Vec<String> {
        let late = |spread: Spread| {
            let (p99, worst) = (spread.p99 > P99, spread.worst > WORST);
            [(p99, format!("p99 is over {P99:?}")), (worst, format!("the worst is over {WORST:?}"))]
        };
        let late = self.spread(&Way::ALL).map(late).into_iter().flatten().filter(|(is_late, _)| *is_late);
        late.map(|(_, what)| what).collect()
    }

    /// Prints the row and remarks on it.
    pub(crate) fn print(&self, by_way: bool) {
        if let Some(why) = &self.failed {
            println!("  {:<18} did not run: {why}", self.what);
        }
        self.line(&self.what, &Way::ALL);
        if by_way {
            Way::ALL.iter().for_each(|way| self.line(&format!("  {}", way.name()), &[*way]));
        }
        for shortcoming in self.shortcomings() {
            println!("      {shortcoming}");
        }
        let mut whys = self.stops.whys.clone();
        whys.dedup();
        whys.iter().take(5).for_each(|why| println!("      {why}"));
    }

    fn line(&self, what: &str, ways: &[Way]) {
        let Some(Spread { p50, p99, worst }) = self.spread(ways) else { return };
        let (lost, all) = self.lost(ways);
        let mut line = format!("  {what:<18} {} {} {}  {:>4} of {all:<4}", ms(p50), ms(p99), ms(worst), all - lost);
        if ways.len() > 1 {
            let slowest = self.stops.took.iter().max_by_key(|(_, took)| *took).map_or("", |(way, _)| way.name());
            line += &format!(
                " {slowest:<11} {:>9} {:>7} {:>7} {:>3} {:>4}",
                self.done, self.away, self.seen, self.honest_cut, self.memory_mib
            );
        }
        println!("{}", line.trim_end());
    }
}

/// Prints the heading of the table.
pub(crate) fn head() {
    println!(
        "  {:<18} {:>9} {:>9} {:>9}  {:>4}    {:<4} {:<11} {:>9} {:>7} {:>7} {:>3} {:>4}",
        "flood", "p50 ms", "p99 ms", "worst ms", "came", "", "slowest", "sent", "away", "seen", "cut", "MiB"
    );
}

/// Prints a run at equal priority beside the same flood at mosquitto, and returns whether the goal is met.
pub(crate) fn beside(row: &Row, other: &Spread) -> bool {
    let Some(own) = row.spread(&[Way::MqttKept]) else {
        println!("  {:<18} no STOP came", row.what);
        return false;
    };
    let ratio = own.p99.as_secs_f64() / other.p99.as_secs_f64().max(1e-9);
    let is_met = ratio <= BESIDE;
    println!(
        "  {:<18} {} {} {}  mosquitto {} {} {}  {ratio:>5.2} × (at most {BESIDE}): {}",
        row.what,
        ms(own.p50),
        ms(own.p99),
        ms(own.worst),
        ms(other.p50),
        ms(other.p99),
        ms(other.worst),
        if is_met { "met" } else { "missed" }
    );
    is_met
}

fn ms(duration: Duration) -> String {
    format!("{:>9.2}", duration.as_secs_f64() * 1e3)
}
