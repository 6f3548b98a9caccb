//! For tests: waits with an end. A test awaits everything in a task through `within`, so that broken code fails the test with a
//! message instead of hanging it. It does not test how long something takes.

use std::time::Duration;

/// Time limit, longer than anything takes on an overloaded machine and than any timeout of the program. Tests of such timeouts
/// use paused time.
const PATIENCE: Duration = Duration::from_secs(180);

/// Awaits `coming`; `what` completes the message "waited in vain for". Needs a runtime with time.
pub(crate) async fn within<T>(what: &str, coming: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, coming).await.unwrap_or_else(|_| panic!("waited in vain for {what}"))
}
