//! How many files and connections the system lets this program have open at once. Most systems begin with few and allow more to
//! whoever asks; HTTP and MQTT together may need more than the few.

/// Enough for every place of every door, and for files beside them.
const WANTED: u64 = 4096;

/// Asks for more, as far as the system allows; how many there are then.
pub(super) fn raise() -> u64 {
    match rlimit::increase_nofile_limit(WANTED) {
        Ok(most) => most,
        Err(error) => {
            tracing::debug!(%error, "the number of open files and connections cannot be raised");
            rlimit::getrlimit(rlimit::Resource::NOFILE).map_or(WANTED, |(soft, _)| soft)
        }
    }
}
