//! A family of figures with labels. All values of the labels are known from the start. The library's own families
//! would take a lock, and create a new series for every unknown label value.

use std::fmt;
use std::sync::Arc;

use prometheus_client::encoding::{EncodeMetric, MetricEncoder};
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::{MetricType, TypedMetric};

/// Label value for everything that has no label value of its own.
pub const OTHER: &str = "other";

/// One metric for each combination of the values of `N` labels. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Series<const N: usize, M> {
    labels: [&'static str; N],
    all: Arc<[([String; N], M)]>,
}

impl<const N: usize, M: Default> Series<N, M> {
    pub fn new<'a>(labels: [&'static str; N], values: impl IntoIterator<Item = [&'a str; N]>) -> Series<N, M> {
        Series::of(labels, values.into_iter().map(|values| (values, M::default())))
    }
}

impl<const N: usize, M> Series<N, M> {
    pub fn of<'a>(labels: [&'static str; N], all: impl IntoIterator<Item = ([&'a str; N], M)>) -> Series<N, M> {
        Series { labels, all: all.into_iter().map(|(values, metric)| (values.map(str::to_owned), metric)).collect() }
    }

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

pub fn flag(is_so: bool) -> Gauge {
    let gauge = Gauge::default();
    gauge.set(i64::from(is_so));
    gauge
}
