//! One run: a program, a flood or many or none, those who look on, and so many STOPs, each while the robot moves.

use std::time::{Duration, Instant};

use crate::clock::now;
use crate::figures::{Row, Stops};
use crate::floods::Flood;
use crate::stage::{House, Said, Sender};
use crate::stops::{Operator, Way};

/// The flood is there before the first STOP.
const WARM_UP: Duration = Duration::from_secs(2);

/// After so long a START was refused for good, or the robot does not move, or a STOP does not come to it.
const PATIENCE: Duration = Duration::from_secs(10);

/// A run is over after so long, however far it has come.
const LIMIT: Duration = Duration::from_secs(120);

/// Presses STOP so often in each way.
pub(crate) fn run(what: &str, floods: &[&Flood], is_nice: bool, each: usize) -> Row {
    let mut row = Row::new(what);
    let took_place = storm(&mut row, floods, is_nice, each);
    row.failed = took_place.err();
    row
}

fn storm(row: &mut Row, floods: &[&Flood], is_nice: bool, each: usize) -> Result<(), String> {
    let house = House::start()?;
    let mut operator =
        Operator::come(&house.doors, PATIENCE).map_err(|error| format!("the operator does not get in: {error}"))?;
    let honest = Sender::honest(&house.doors)?;
    let senders: Result<Vec<Sender>, String> =
        floods.iter().map(|flood| Sender::flood(flood.name, &house.doors, is_nice)).collect();
    let senders = senders?;
    std::thread::sleep(WARM_UP);
    if std::env::var_os("STORM_HOLD").is_some() {
        eprintln!("the program is process {}", house.id());
    }
    let until = Instant::now() + LIMIT;
    row.stops = stops(&house, &mut operator, each, until);
    row.cut = operator.cut;
    row.memory_mib = house.memory_mib();
    row.broke = house.broke();
    for (flood, sender) in floods.iter().zip(senders) {
        let (done, away) = sender.end();
        (row.done, row.away) = (row.done + done, row.away + away);
        if done == 0 {
            return Err(format!("{} did nothing", flood.name));
        }
    }
    (row.seen, row.honest_cut) = honest.end();
    Ok(())
}

/// The ways take turns, so that all of them meet the same weather.
fn stops(house: &House, operator: &mut Operator, each: usize, until: Instant) -> Stops {
    let mut stops = Stops::default();
    let mut is_driving = false;
    for _ in 0..each {
        for way in Way::ALL {
            if Instant::now() > until {
                stops.is_cut_short = true;
                return stops;
            }
            if !is_driving && let Err(why) = drive(house, operator) {
                stops.unstarted += 1;
                stops.whys.push(why);
                continue;
            }
            let asked = now();
            let answered = operator.stop(way);
            let took = halted(house, stops.epoch).map(|(epoch, at)| {
                stops.epoch = epoch;
                Duration::from_nanos(at.saturating_sub(asked))
            });
            is_driving = took.is_none();
            stops.took.push((way, took));
            if let Err(error) = answered {
                stops.unanswered += 1;
                stops.whys.push(format!("{}: {error}", way.name()));
            }
        }
    }
    stops
}

/// Presses START until the robot moves.
fn drive(house: &House, operator: &mut Operator) -> Result<(), String> {
    let until = Instant::now() + PATIENCE;
    loop {
        let started = operator.start();
        loop {
            let wait = if started.is_ok() { until } else { Instant::now() };
            match house.next(wait) {
                Ok(Said::Moves) => return Ok(()),
                Ok(_) => {}
                Err(_) if started.is_ok() => return Err("the robot was started and does not move".to_owned()),
                Err(_) => break,
            }
        }
        if Instant::now() > until {
            return Err(format!("START: {}", started.err().map(|error| error.to_string()).unwrap_or_default()));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The halt of a stop later than this epoch: which, and when it came.
fn halted(house: &House, epoch: u64) -> Option<(u64, u64)> {
    let until = Instant::now() + PATIENCE;
    loop {
        match house.next(until).ok()? {
            Said::Halt(later, at) if later > epoch => return Some((later, at)),
            Said::Halt(..) | Said::Moves | Said::Doors(_) => {}
        }
    }
}
