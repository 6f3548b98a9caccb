//! Tests of what the loop counts and measures about itself, with the robot and the store of the loop's other tests.

use super::*;

/// The clock of the test is paused, so only the test's own waits take time.
#[tokio::test(start_paused = true)]
async fn what_is_on_record_is_counted_and_how_long_it_took_is_measured() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let starting = giving(&handle, Command::Start);
    tokio::time::sleep(Duration::from_secs(5)).await;
    let figures = handle.figures();
    let started = "commands_total{command=\"start\",outcome=\"accepted\"}";
    assert_eq!((figures.value("missions_begun_total"), figures.value(started)), (0.0, 0.0), "nothing is kept yet");
    word.send_modify(|word| word.kept = Seq(1000));
    starting.await.unwrap().unwrap().unwrap();
    assert_eq!((figures.value("missions_begun_total"), figures.value(started)), (1.0, 1.0));
    assert_eq!(figures.value("journal_last_entry"), 1000.0);
    for name in ["record", "command"] {
        let within = |bound: &str| figures.value(&format!("{name}_seconds_bucket{{le=\"{bound}\"}}"));
        assert!(within("10.0") > within("2.5"), "{name}");
    }
}

#[tokio::test]
async fn a_stop_is_counted_when_it_is_raised_and_measured_when_it_is_heard() {
    let (handle, task, robot) = task();
    handle.halter().stop();
    let figures = handle.figures().clone();
    assert_eq!((figures.value("stops_total"), figures.value("stop_seconds_count")), (1.0, 0.0));
    let (handle, _robot, _close) = start(handle, task, robot).await;
    give(&handle, Command::Stop).await.unwrap().unwrap();
    assert_eq!(figures.value("stops_total"), 2.0);
    assert!(figures.value("stop_seconds_count") >= 1.0);
}

#[tokio::test]
async fn what_the_store_lost_is_not_counted_and_that_it_was_lost_is() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let starting = giving(&handle, Command::Start);
    seen(&handle, "the link", |state| !state.mission.holds.contains(&Hold::RobotLink)).await;
    word.send_modify(|word| (word.losses, word.failure) = (3, Some("the disk is on strike".into())));
    starting.await.unwrap().unwrap().unwrap_err();
    let figures = handle.figures();
    assert_eq!((figures.value("store_losses_total"), figures.value("store_failing")), (3.0, 1.0));
    word.send_modify(|word| (word.kept, word.failure) = (Seq(1000), None));
    seen(&handle, "the store", |state| state.mission.store_failure.is_none()).await;
    assert_eq!((figures.value("store_failing"), figures.value("missions_begun_total")), (0.0, 0.0));
}
