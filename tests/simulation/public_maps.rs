//! Public maps in a folder `shared/maps` beside this project or above it, searched by every strategy with a camera
//! that often cannot identify an obstacle and with failing photos. A note is printed when there are no maps.
//! `HALLSWEEP_MAPS=all` also runs every goal, sensing and costs. A failure prints map and seed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hallsweep_core::command::Strategy;
use hallsweep_core::settings::Settings;
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Hall, SimSettings};

use crate::random_halls::in_turn;

/// Number of turns that combine every strategy with every sensing, goal and costs.
const TURNS: u64 = 4 * 2 * 3;

fn maps() -> Vec<PathBuf> {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|folder| folder.join("shared").join("maps"));
    let Some(folder) = above.into_iter().find(|folder| folder.is_dir()) else {
        eprintln!("public maps are left out: there is no folder shared/maps beside this project");
        return Vec::new();
    };
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_map = |file: &PathBuf| file.extension().is_some_and(|extension| extension == "map" || extension == "yaml");
    let mut maps: Vec<PathBuf> = files.filter(is_map).collect();
    maps.sort();
    maps
}

/// Searches every map with every strategy on two threads: with one combination of sensing, goal and costs, or with
/// all of them.
fn on_every_map(search: impl Fn(&Arc<Hall>, u64) + Sync) {
    let halls: Vec<Arc<Hall>> = maps().iter().map(|map| Arc::new(Hall::named_or_file(map.to_str().unwrap()).unwrap())).collect();
    let turns = if std::env::var("HALLSWEEP_MAPS").is_ok_and(|asked| asked == "all") { TURNS } else { 1 };
    let (strategies, count) = (Strategy::ALL.len() as u64, halls.len() as u64);
    let next = AtomicU64::new(0);
    let worker = || {
        loop {
            let n = next.fetch_add(1, Ordering::Relaxed);
            if n >= count * strategies * turns {
                return;
            }
            let (map, turn) = (n / strategies % count, n / strategies / count);
            // Each map begins with another combination.
            search(&halls[usize::try_from(map).unwrap()], (map + turn) * strategies + n % strategies);
        }
    };
    std::thread::scope(|scope| {
        let workers = [scope.spawn(worker), scope.spawn(worker)];
        workers.into_iter().for_each(|worker| worker.join().expect("a map failed; which one is printed above"));
    });
}

#[test]
fn public_maps_are_searched_completely_by_every_strategy() {
    on_every_map(|hall, seed| {
        let (sim, settings, strategy) = in_turn(seed, Settings::default());
        let sim = SimSettings { unknown_rate: 0.3, photo_failure_rate: 0.2, ..sim };
        let figures = explore(hall, sim, settings, strategy, Verdicts::AllSafe, |_| {});
        let of = format!("{} by {}, seed {seed}", hall.name(), strategy.name());
        assert_eq!(figures.stuck, None, "{of}");
        assert!(figures.complete && figures.home, "{of}: complete {}, home {}", figures.complete, figures.home);
    });
}
