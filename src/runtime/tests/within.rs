//! For tests: waits with a time limit. A test awaits everything in a task through `within`. So broken code fails the
//! test with a message instead of hanging it. `within` does not test how long something takes.

use std::time::Duration;

/// Time limit. It is longer than anything takes on an overloaded machine, and longer than any timeout of the program.
/// Tests of such timeouts use paused time.
const PATIENCE: Duration = Duration::from_secs(180);

/// Awaits `coming`. If the time limit passes, the test fails with "waited in vain for" and `what`. Needs a runtime
/// with time.
pub(crate) async fn within<T>(what: &str, coming: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, coming).await.unwrap_or_else(|_| panic!("waited in vain for {what}"))
}
