//! The signals that end the program. `app` decides how it ends.

use std::future::Future;
use std::io;

/// Starts to listen at once. The future returns the name of the first signal that asks the program to end.
#[cfg(unix)]
pub(super) fn listen() -> io::Result<impl Future<Output = &'static str>> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let hang_up = if ignores_hang_up() { None } else { Some(signal(SignalKind::hangup())?) };
    let hung_up = async move {
        match hang_up {
            Some(mut hang_up) => hang_up.recv().await,
            None => std::future::pending().await,
        }
    };
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => "SIGTERM",
            _ = interrupt.recv() => "SIGINT",
            _ = hung_up => "SIGHUP",
        }
    })
}

/// Whether the program was started with SIGHUP ignored, as by `nohup`. Only Linux reports this.
#[cfg(unix)]
fn ignores_hang_up() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    // Signal number 1 (SIGHUP) is the lowest bit.
    ignored.is_some_and(|ignored| ignored & 1 == 1)
}

/// Listens for Ctrl-C, the only such signal on systems other than Unix.
#[cfg(not(unix))]
pub(super) fn listen() -> io::Result<impl Future<Output = &'static str>> {
    Ok(async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
        "Ctrl-C"
    })
}
