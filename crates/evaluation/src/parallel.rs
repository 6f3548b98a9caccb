//! Parallel work. The results are in the order of the items, no matter which thread was faster.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};

use hallsweep_core::search::ways::Ways;

/// Calls `work` for the items 0 to `count` − 1, on all processors. Each worker thread has its own memory for route
/// planning.
pub(crate) fn each<R: Send>(count: usize, work: impl Fn(usize, &mut Ways) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let (mut ways, mut done) = (Ways::default(), Vec::new());
        loop {
            let n = next.fetch_add(1, Ordering::Relaxed);
            if n >= count {
                return done;
            }
            done.push((n, work(n, &mut ways)));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get).min(count);
    let mut all: Vec<(usize, R)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("the work does not panic")).collect()
    });
    all.sort_unstable_by_key(|(n, _)| *n);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_things() {
        assert_eq!(each(1000, |n, _| n * n), (0..1000).map(|n| n * n).collect::<Vec<_>>());
        assert!(each(0, |n, _| n).is_empty());
    }
}
