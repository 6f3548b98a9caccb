//! For tests: waiting that ends. Whatever a test waits for in a task, it waits for it here, so that broken code fails the test with
//! words instead of hanging it. How long something takes is not tested by this.

use std::time::Duration;

/// Longer than anything takes on a machine that is far too busy, and than any patience of the program: tests wait for that in
/// simulated time.
const PATIENCE: Duration = Duration::from_secs(180);

/// What comes of `coming`, which a sentence names that goes on after "waited in vain for". Needs a runtime with time.
pub(crate) async fn within<T>(what: &str, coming: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, coming).await.unwrap_or_else(|_| panic!("waited in vain for {what}"))
}
