//! Tests of the STOP file: it survives kills, damage and arbitrary bytes. They are in a separate file because they
//! are long.

use std::path::PathBuf;

use proptest::prelude::*;

use super::*;
use crate::runtime::halt::Halter;
use crate::runtime::tests::within::within;
use crate::storage::tests::scratch::Scratch;

fn file_in(scratch: &Scratch) -> PathBuf {
    names::STOPS.within(&scratch.0)
}

fn bytes_in(scratch: &Scratch) -> Vec<u8> {
    std::fs::read(file_in(scratch)).expect("it is there")
}

/// Safety S4.
#[test]
fn the_last_stop_is_read_again() {
    let scratch = Scratch::new();
    assert_eq!(Stops::open(&scratch.0).epoch(), Epoch(0));
    assert_eq!(bytes_in(&scratch).len(), SIZE, "there is room for every stop to come");
    for last in [1, 2, 3, 7, 8, 1_000_000_007] {
        let mut stops = Stops::open(&scratch.0);
        stops.keep(Epoch(last));
        stops.keep(Epoch(last - 1));
        assert_eq!(stops.epoch(), Epoch(last), "an older stop takes nothing back");
        assert_eq!(Stops::open(&scratch.0).epoch(), Epoch(last));
    }
    let mut stops = Stops::open(&scratch.0);
    (2_000_000_000..2_000_000_009).for_each(|epoch| stops.keep(Epoch(epoch)));
    assert_eq!(Stops::open(&scratch.0).epoch(), Epoch(2_000_000_008));
    assert_eq!(bytes_in(&scratch).len(), SIZE);
}

#[test]
fn a_line_that_was_cut_short_costs_only_itself_and_leaves_a_doubt() {
    let scratch = Scratch::new();
    let mut stops = Stops::open(&scratch.0);
    stops.keep(Epoch(4));
    stops.keep(Epoch(5));
    let whole = bytes_in(&scratch);
    let newer = usize::from(understood(&whole).expect("it was just written").line == 1) * LINE;
    for cut in 0..LINE {
        let mut torn = whole.clone();
        torn[newer + cut] ^= 0x20;
        std::fs::write(file_in(&scratch), &torn).unwrap();
        let mut stops = Stops::open(&scratch.0);
        assert_eq!(stops.epoch(), Epoch(4), "byte {cut}");
        assert!(stops.damaged().is_some(), "byte {cut}: the line may have named a later stop");
        assert_eq!(std::fs::read(names::STOPS_DAMAGED.within(&scratch.0)).unwrap(), torn, "what was there is set aside");
        stops.keep(Epoch(6));
        let again = Stops::open(&scratch.0);
        assert_eq!((again.epoch(), again.damaged()), (Epoch(6), None));
    }
    // After reopening, the older line is overwritten. So a kill in the middle of the write loses no earlier stop.
    for epochs in [[7, 6], [6, 7]] {
        std::fs::write(file_in(&scratch), epochs.map(|epoch| line(Epoch(epoch))).concat()).unwrap();
        Stops::open(&scratch.0).keep(Epoch(8));
        let mut left: Vec<_> = bytes_in(&scratch).chunks(LINE).map(epoch_of).collect();
        left.sort();
        assert_eq!(left, [Some(Epoch(7)), Some(Epoch(8))]);
    }
}

#[test]
fn a_file_that_says_nothing_is_begun_anew() {
    let never = line(Epoch(u64::MAX)).repeat(2);
    for bytes in [&b""[..], b"stop", &[0; SIZE], &[b'x'; SIZE + 1], never.as_bytes()] {
        let scratch = Scratch::new();
        std::fs::write(file_in(&scratch), bytes).unwrap();
        let mut stops = Stops::open(&scratch.0);
        assert_eq!((stops.epoch(), bytes_in(&scratch).len()), (Epoch(0), SIZE));
        assert_eq!(stops.damaged(), Some((&*file_in(&scratch), true)), "nobody knows what it said");
        stops.keep(Epoch(3));
        assert_eq!(Stops::open(&scratch.0).epoch(), Epoch(3));
    }
}

#[cfg(unix)]
#[test]
fn it_is_for_its_owner_alone_and_nothing_else_is_left_there() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    Stops::open(&scratch.0).keep(Epoch(1));
    assert_eq!(std::fs::metadata(file_in(&scratch)).unwrap().permissions().mode() & 0o777, 0o600);
    assert_eq!(std::fs::read_dir(&scratch.0).unwrap().count(), 1);
}

/// The folder does not exist yet, or no longer exists. The stop is written once the folder exists.
#[tokio::test(start_paused = true)]
async fn what_could_not_be_written_is_written_as_soon_as_it_can_be() {
    let scratch = Scratch::new();
    let folder = scratch.0.join("later");
    let halter = Halter::new(Epoch(41));
    let following = tokio::spawn(follow(Stops::open(&folder), halter.clone()));
    assert_eq!(halter.stop(), Epoch(42));
    tokio::time::sleep(10 * WRITTEN_AGAIN).await;
    std::fs::create_dir(&folder).unwrap();
    let written = async {
        while !names::STOPS.within(&folder).exists() {
            tokio::time::sleep(WRITTEN_AGAIN).await;
        }
        halter.stop();
        while Stops::open(&folder).epoch() < Epoch(43) {
            tokio::time::sleep(WRITTEN_AGAIN).await;
        }
    };
    within("both stops in the file", written).await;
    following.abort();
}

/// Safety S4: an answered stop is in the file.
#[tokio::test(start_paused = true)]
async fn a_stop_that_was_noted_stands_in_the_file() {
    let scratch = Scratch::new();
    let halter = Halter::new(Epoch(0));
    let following = tokio::spawn(follow(Stops::open(&scratch.0), halter.clone()));
    // One yield lets the task begin.
    tokio::task::yield_now().await;
    for _ in 0..100 {
        let epoch = halter.stop();
        within("the note", halter.until_noted(epoch)).await;
        assert_eq!(Stops::open(&scratch.0).epoch(), epoch);
    }
    following.abort();
}

proptest! {
    /// Safety A7: arbitrary bytes are read without a panic, and only lines that the program wrote are accepted.
    #[test]
    fn any_bytes_are_read(bytes in prop::collection::vec(any::<u8>(), 0..2 * SIZE), epoch in 0..=GREATEST, at in 0..SIZE) {
        prop_assert_eq!(understood(&bytes), None);
        let mut bytes: Vec<u8> = bytes.into_iter().chain(std::iter::repeat(0)).take(SIZE).collect();
        bytes[..LINE].copy_from_slice(line(Epoch(epoch)).as_bytes());
        prop_assert_eq!(understood(&bytes), Some(FoundStop { epoch: Epoch(epoch), line: 0, is_sure: false }));
        bytes[at] ^= 1;
        let whole = Some(FoundStop { epoch: Epoch(epoch), line: 0, is_sure: false });
        prop_assert_eq!(understood(&bytes), if at < LINE { None } else { whole });
    }
}
