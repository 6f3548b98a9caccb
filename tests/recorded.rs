//! Everything that every door shows and answers, byte for byte, in missions that a seed determines. It is compared
//! with the files of `tests/recorded/`, so that moving and renaming code changes nothing that a client sees.
//! `HALLSWEEP_RENEW=1` writes these files again; `HALLSWEEP_RECORD=FOLDER` writes many missions in full into a
//! folder, for comparison with another version. Sockets, blocks, acknowledgements and dates are not included.

#[path = "recorded/book.rs"]
mod book;
#[path = "recorded/coap.rs"]
mod coap;
#[path = "recorded/doors.rs"]
mod doors;
#[path = "recorded/http.rs"]
mod http;
#[path = "recorded/mqtt.rs"]
mod mqtt;
#[path = "recorded/play.rs"]
mod play;
#[path = "recorded/scenes.rs"]
mod scenes;
#[path = "recorded/table.rs"]
mod table;
#[path = "recorded/test_app.rs"]
mod test_app;
#[path = "recorded/wire.rs"]
mod wire;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use book::{Book, Size};
use doors::Camera;
use play::Play;

/// Folder of the recorded files.
const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recorded");

/// Mission of the recorded files.
const SHORT: Play = Play { hall: "seed", seed: 2, steps: 70, one_in: 12, with_table: false, camera: Camera::Stub };

/// Time zone of the recorded pages and streams.
const ZONE: &str = "UTC";

#[test]
fn every_door_shows_and_answers_what_it_did_before() {
    if std::env::var("TZ").is_ok_and(|zone| zone == ZONE) {
        return recorded();
    }
    // A program reads its time zone when it starts, so the test starts itself again.
    let itself = std::env::current_exe().expect("a program knows where it is");
    let mut there = Command::new(itself);
    there.args(["--exact", "every_door_shows_and_answers_what_it_did_before", "--nocapture"]);
    let ended = there.env("TZ", ZONE).status().expect("it starts again");
    assert!(ended.success(), "what differs stands above");
}

#[tokio::main(flavor = "current_thread", start_paused = true)]
async fn recorded() {
    if let Some(folder) = std::env::var_os("HALLSWEEP_RECORD") {
        return at_length(Path::new(&folder)).await;
    }
    let mut book = Book::new(Size::Short(4_000));
    play::at_the_doors(&mut book).await;
    scenes::play(&mut book, false).await;
    play::play(&mut book, SHORT).await;
    if std::env::var_os("HALLSWEEP_RENEW").is_some() {
        return book.save(Path::new(KEPT));
    }
    let differences = book.differences(Path::new(KEPT));
    assert!(
        differences.is_empty(),
        "clients would see something else; if that is meant, look at it and write the files anew with\n  \
         HALLSWEEP_RENEW=1 cargo test --test recorded\n\n{}\n",
        differences.join("\n")
    );
}

/// Records many missions: a few in full, most as digests.
async fn at_length(folder: &Path) {
    let mut outcomes: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    let mut in_full = Book::new(Size::Long(120));
    play::at_the_doors(&mut in_full).await;
    let patterns = scenes::play(&mut in_full, true).await;
    let long = [("seed", 1, 0, false), ("seed", 2, 8, true), ("seed-9x8", 3, 5, false)];
    for (hall, seed, one_in, with_table) in long {
        let of = Play { hall, seed, steps: 150, one_in, with_table, camera: Camera::Stub };
        add(&mut outcomes, play::play(&mut in_full, of).await);
    }
    in_full.save(&folder.join("full"));
    let mut in_short = Book::new(Size::Long(2));
    for seed in 10..26 {
        let hall = ["seed", "airport", "seed-9x8", "empty-8x8"][seed as usize % 4];
        let camera = if seed % 10 == 0 { Camera::Rendered } else { Camera::Stub };
        let of =
            Play { hall, seed, steps: 300, one_in: [0, 4, 10, 30, 100][seed as usize % 5], with_table: seed % 4 == 1, camera };
        add(&mut outcomes, play::play(&mut in_short, of).await);
    }
    in_short.save(&folder.join("digests"));
    let mut page = String::new();
    for (command, [accepted, refused]) in outcomes {
        writeln!(page, "{accepted:6} accepted {refused:6} refused  {command}").expect("a text takes everything");
    }
    patterns.iter().for_each(|line| writeln!(page, "{line}").expect("a text takes everything"));
    std::fs::write(folder.join("outcomes.txt"), page).expect("the folder can be written to");
}

fn add(all: &mut BTreeMap<String, [usize; 2]>, more: BTreeMap<String, [usize; 2]>) {
    for (command, [accepted, refused]) in more {
        let known = all.entry(command).or_default();
        *known = [known[0] + accepted, known[1] + refused];
    }
}
