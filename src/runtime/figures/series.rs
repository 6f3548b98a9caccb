//! A family of figures that are told apart by labels, all of which are known from the start. The library's own families make a new
//! series for whatever they are asked for, behind a lock.

use std::fmt;
use std::sync::Arc;

use prometheus_client::encoding::{EncodeMetric, MetricEncoder};
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::{MetricType, TypedMetric};

/// The value of a label for all that has no value of its own.
pub const OTHER: &str = "other";

/// A metric for each of some values of `N` labels. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Series<const N: usize, M> {
    labels: [&'static str; N],
    all: Arc<[([String; N], M)]>,
}

impl<const N: usize, M: Default> Series<N, M> {
    /// All of them at their beginning.
    pub fn new<'a>(labels: [&'static str; N], values: impl IntoIterator<Item = [&'a str; N]>) -> Series<N, M> {
        Series::of(labels, values.into_iter().map(|values| (values, M::default())))
    }
}

impl<const N: usize, M> Series<N, M> {
    /// Those that are there already.
    pub fn of<'a>(labels: [&'static str; N], all: impl IntoIterator<Item = ([&'a str; N], M)>) -> Series<N, M> {
        Series { labels, all: all.into_iter().map(|(values, metric)| (values.map(str::to_owned), metric)).collect() }
    }

    /// The one with these values, if they are among those of the start.
    pub(super) fn at(&self, values: [&str; N]) -> Option<&M> {
        self.all.iter().find(|(known, _)| *known == values).map(|(_, metric)| metric)
    }
}

impl<const N: usize, M: EncodeMetric + TypedMetric> EncodeMetric for Series<N, M> {
    fn encode(&self, mut encoder: MetricEncoder<'_>) -> fmt::Result {
        self.all.iter().try_for_each(|(values, metric)| {
            let labels: Vec<(&str, &str)> = self.labels.into_iter().zip(values.iter().map(String::as_str)).collect();
            metric.encode(encoder.encode_family(&labels)?)
        })
    }

    fn metric_type(&self) -> MetricType {
        M::TYPE
    }
}

/// 1 where something is so, else 0.
pub fn flag(is_so: bool) -> Gauge {
    let gauge = Gauge::default();
    gauge.set(i64::from(is_so));
    gauge
}
