//! The signals that end the program. What ending means is `app`'s business.

use std::future::Future;
use std::io;

/// Listens from now on; the future ends with the name of the first signal that asks the program to end.
#[cfg(unix)]
pub(super) fn listen() -> io::Result<impl Future<Output = &'static str>> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => "SIGTERM",
            _ = interrupt.recv() => "SIGINT",
        }
    })
}

/// The same where there is only Ctrl-C.
#[cfg(not(unix))]
pub(super) fn listen() -> io::Result<impl Future<Output = &'static str>> {
    Ok(async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
        "Ctrl-C"
    })
}
