//! Limit of open file descriptors of the test process, which plays crowds of clients.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Raises the soft limit to `wanted` descriptors, or to the hard limit if that is lower. Returns the resulting limit.
pub(crate) fn raised(wanted: u64) -> u64 {
    let limit = getrlimit(Resource::Nofile);
    let wanted = limit.maximum.map_or(wanted, |most| most.min(wanted));
    match limit.current {
        Some(current) if current < wanted => {
            setrlimit(Resource::Nofile, Rlimit { current: Some(wanted), ..limit }).expect("a process may raise its soft limit");
            wanted
        }
        current => current.unwrap_or(u64::MAX),
    }
}
