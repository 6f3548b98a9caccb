//! Waits that the links to robots of every kind share: until a report is taken, and until work on another thread is
//! done. Each wait can be cancelled and repeated safely.

use tokio::sync::mpsc;
use tokio::task::JoinHandle;

use hallsweep_core::event::RobotEvent;

/// Sends the report as soon as there is room. Returns false when nobody receives reports any more.
pub(super) async fn hand_over(reports: &mpsc::Sender<RobotEvent>, report: &mut Option<RobotEvent>) -> bool {
    let Ok(room) = reports.reserve().await else { return false };
    if let Some(report) = report.take() {
        room.send(report);
    }
    true
}

/// Waits for the work under way. Returns its result, or `None` when the work has failed. Without work it waits for
/// ever.
pub(super) async fn done<T>(work: &mut Option<JoinHandle<T>>) -> Option<T> {
    let Some(under_way) = work else { return std::future::pending().await };
    let done = under_way.await.ok();
    *work = None;
    done
}

pub(super) async fn done_for<K: Copy, T>(work: &mut Option<(K, JoinHandle<T>)>) -> (K, Option<T>) {
    let Some((whom, under_way)) = work else { return std::future::pending().await };
    let done = (*whom, under_way.await.ok());
    *work = None;
    done
}
