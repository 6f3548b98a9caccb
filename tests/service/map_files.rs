//! A viewer requests the map of a large hall as files without end. STOP and reads of the state are served
//! meanwhile, and the map is served afterwards.

use std::fs::write;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::access::Site;
use crate::http_attacks::connected;

const FILES: [&str; 5] = ["toml", "map", "yaml", "pgm", "txt"];

/// Connections that read the answers. The same number of connections hang up instead.
const READERS: usize = 8;

/// Interval between two checks whether the map is large.
const GLANCE: Duration = Duration::from_millis(20);

/// Number of STOPs by an operator during the requests.
const STOPS: u64 = 20;

/// A robot in an empty hall of 800 by 800 cells, in whose map the outer walls are visible from the start corner.
fn large() -> Site {
    let hall = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("large-{}.toml", std::process::id()));
    write(&hall, "width = 800\nheight = 800\n").expect("a file can be written");
    let site = Site::in_hall("map-files", &["HTTP__REQUIRE_TOKEN"], hall.to_str().expect("a path in UTF-8"), "max");
    site.command("start");
    while !site.map("hall.map").contains("height 802\nwidth 80") {
        sleep(GLANCE);
    }
    site
}

impl Site {
    fn command(&self, name: &str) {
        let bearer = format!("Bearer {}", self.operator);
        self.program.post_with(&format!("/api/v1/commands/{name}"), &[("authorization", &bearer)], "").accepted();
    }

    fn read(&self, path: &str, header: (&str, &str)) -> crate::program::Answer {
        let bearer = format!("Bearer {}", self.operator);
        self.program.read(path, &[("authorization", &bearer), header])
    }

    fn map(&self, name: &str) -> String {
        self.read(&format!("/api/v1/map/{name}"), ("accept", "*/*")).text()
    }

    /// Requests for all files, ten times, for a single write.
    fn asked(&self) -> String {
        let asked = |name| {
            let viewer = &self.viewer;
            format!("GET /api/v1/map/hall.{name} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {viewer}\r\n\r\n")
        };
        FILES.map(asked).concat().repeat(10)
    }
}

/// Safety S1, S7, S9.
#[test]
fn a_viewer_who_asks_for_the_map_of_a_large_hall_without_end_keeps_no_stop_out() {
    let (site, is_over) = (large(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        for _ in 0..READERS {
            scope.spawn(|| {
                let mut bytes = vec![0; 1 << 20];
                while !is_over.load(Ordering::SeqCst) {
                    let mut stream = connected(&site.program, &site.asked());
                    let mut read = 1;
                    while read > 0 && !is_over.load(Ordering::SeqCst) {
                        read = stream.read(&mut bytes).unwrap_or(0);
                    }
                }
            });
            scope.spawn(|| {
                while !is_over.load(Ordering::SeqCst) {
                    drop(connected(&site.program, &site.asked()).write_all(b"\r\n"));
                }
            });
        }
        let before = site.read("/api/v1/mission", ("accept", "*/*")).json()["epoch"].as_u64().expect("an epoch");
        for stop in 1..=STOPS {
            site.command("start");
            site.command("stop");
            let state = site.read("/api/v1/state", ("accept", "*/*")).json();
            assert_eq!((&state["mission"]["epoch"], &state["robot"]["halting"]), (&(before + stop).into(), &false.into()));
        }
        is_over.store(true, Ordering::SeqCst);
    });
    let file = site.read("/api/v1/map/hall.pgm", ("accept", "*/*"));
    assert_eq!(file.status, 200);
    let again = site.read("/api/v1/map/hall.pgm", ("if-none-match", file.header("etag")));
    assert_eq!((again.status, again.header("etag")), (304, file.header("etag")));
}
