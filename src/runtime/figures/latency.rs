//! A histogram of durations, made of atomic numbers. The library's histogram holds a lock while all buckets are
//! written out. On a busy machine, the loop would then wait for a thread of the lowest priority (safety S7).

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use prometheus_client::encoding::{EncodeMetric, MetricEncoder, NoLabelSet};
use prometheus_client::metrics::{MetricType, TypedMetric};

use super::nanos;

/// Upper bounds of the buckets, in nanoseconds. The first bound is the time that a fast thread needs. A disk that
/// hangs counts as failed before the last bound.
const BOUNDS: [u64; 14] = [
    10_000,
    25_000,
    100_000,
    250_000,
    1_000_000,
    2_500_000,
    5_000_000,
    10_000_000,
    25_000_000,
    100_000_000,
    250_000_000,
    1_000_000_000,
    2_500_000_000,
    10_000_000_000,
];

/// Upper bound of the last bucket, in the form that the library requires.
const UNBOUNDED: f64 = f64::MAX;

#[derive(Clone, Debug, Default)]
pub struct Latency(Arc<Buckets>);

#[derive(Debug, Default)]
struct Buckets {
    /// One number for each bound, and one for all longer durations.
    counts: [AtomicU64; BOUNDS.len() + 1],
    nanos: AtomicU64,
}

impl Latency {
    pub fn observe(&self, took: Duration) {
        let took = nanos(took);
        let bucket = BOUNDS.partition_point(|bound| *bound < took);
        self.0.counts[bucket].fetch_add(1, Ordering::Relaxed);
        self.0.nanos.fetch_add(took, Ordering::Relaxed);
    }
}

impl EncodeMetric for Latency {
    fn encode(&self, mut encoder: MetricEncoder<'_>) -> fmt::Result {
        let seconds = |nanos: u64| Duration::from_nanos(nanos).as_secs_f64();
        let bounds = BOUNDS.into_iter().map(seconds).chain([UNBOUNDED]);
        let counts = self.0.counts.iter().map(|count| count.load(Ordering::Relaxed));
        let buckets: Vec<(f64, u64)> = bounds.zip(counts).collect();
        // The count is the sum of the buckets just read, so that the count and the buckets agree even if other
        // threads add values meanwhile.
        let count = buckets.iter().map(|(_, count)| count).sum();
        encoder.encode_histogram::<NoLabelSet>(seconds(self.0.nanos.load(Ordering::Relaxed)), count, &buckets, None)
    }

    fn metric_type(&self) -> MetricType {
        Latency::TYPE
    }
}

impl TypedMetric for Latency {
    const TYPE: MetricType = MetricType::Histogram;
}

#[cfg(test)]
mod tests {
    use prometheus_client::encoding::text::encode;
    use prometheus_client::registry::Registry;

    use super::*;

    #[test]
    fn what_is_observed_is_in_every_bucket_from_its_own_on() {
        let latency = Latency::default();
        for nanos in [0, 10_000, 10_001, 1_000_000, 1_000_001, 10_000_000_000, 10_000_000_001] {
            latency.observe(Duration::from_nanos(nanos));
        }
        let mut registry = Registry::default();
        registry.register("took", "How long it took", latency);
        let mut text = String::new();
        encode(&mut text, &registry).unwrap();
        let at = |bucket: &str| {
            let line = text.lines().find_map(|line| line.strip_prefix(bucket)?.strip_prefix(' '));
            line.unwrap_or_else(|| panic!("no {bucket} in\n{text}")).to_owned()
        };
        let below = |bound: &str| at(&format!("took_bucket{{le=\"{bound}\"}}"));
        assert_eq!(["0.00001", "0.000025", "0.001", "0.0025"].map(below), ["2", "3", "4", "5"]);
        assert_eq!(["2.5", "10.0", "+Inf"].map(below), ["5", "6", "7"]);
        assert_eq!((at("took_count"), at("took_sum").parse::<f64>().unwrap()), ("7".to_owned(), 20.002_020_003));
    }
}
