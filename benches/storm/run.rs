//! One run: a program, any number of floods, honest clients, and STOPs that are each given while the robot moves.

use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use crate::clock::now;
use crate::figures::{Row, Stops};
use crate::floods::{Door, Flood};
use crate::stage::{Said, Sender, TestApp};
use crate::stops::{Operator, Way};

/// Time from the beginning of the floods to the first STOP.
const WARM_UP: Duration = Duration::from_secs(1);

/// Time limit for an accepted START, for the robot's first movement, and for a STOP to reach the robot.
const PATIENCE: Duration = Duration::from_secs(10);

/// Time after which a START is repeated when the robot does not move.
const AGAIN: Duration = Duration::from_secs(2);

/// Pause before a refused START is sent again.
const PAUSE: Duration = Duration::from_millis(20);

/// Time limit of a run: a fixed part, and a part for each STOP of a way; both are many times what the run takes.
const LIMIT: Duration = Duration::from_secs(60);
const LIMIT_EACH: Duration = Duration::from_millis(300);

/// Presses STOP `each` times in each way.
pub(crate) fn run(what: &str, floods: &[&Flood], is_nice: bool, each: usize) -> Row {
    let mut row = Row::new(what);
    let took_place = storm(&mut row, floods, is_nice, each);
    row.failed = took_place.err();
    row
}

fn storm(row: &mut Row, floods: &[&Flood], is_nice: bool, each: usize) -> Result<(), String> {
    let app = TestApp::start()?;
    let mut operator = Operator::come(&app.doors, PATIENCE).map_err(|error| format!("the operator does not get in: {error}"))?;
    let honest = Sender::honest(&app.doors)?;
    let senders: Result<Vec<Sender>, String> =
        floods.iter().map(|flood| Sender::flood(flood.name, &app.doors, is_nice)).collect();
    let senders = senders?;
    std::thread::sleep(WARM_UP);
    let until = Instant::now() + LIMIT + LIMIT_EACH * u32::try_from(each).unwrap_or(u32::MAX);
    // A START can be delayed by the flood at its door. When HTTP is flooded but CoAP is not, START is sent over CoAP.
    let over_coap = floods.len() > 1 && floods.iter().all(|flood| flood.door != Door::Coap);
    row.stops = stops(&app, &mut operator, (each, over_coap), until);
    row.cut = operator.cut;
    row.memory_mib = app.memory_mib();
    row.broke = app.broke();
    for (flood, sender) in floods.iter().zip(senders) {
        let (done, away) = sender.end();
        (row.done, row.away) = (row.done + done, row.away + away);
        // A flood that was always refused is possible beside others; a flood that runs alone must have done
        // something.
        if done == 0 && (away == 0 || floods.len() == 1) {
            return Err(format!("{} did nothing", flood.name));
        }
    }
    (row.seen, row.honest_cut) = honest.end();
    Ok(())
}

/// Takes turns among the ways, so that the conditions are the same for all of them.
fn stops(app: &TestApp, operator: &mut Operator, (each, over_coap): (usize, bool), until: Instant) -> Stops {
    let mut stops = Stops::default();
    let mut is_driving = false;
    for _ in 0..each {
        for way in Way::ALL {
            if Instant::now() > until {
                stops.is_cut_short = true;
                return stops;
            }
            if !is_driving && let Err(why) = drive(app, operator, over_coap) {
                stops.unstarted += 1;
                stops.whys.push(why);
                continue;
            }
            let asked = now();
            let answered = operator.stop(way);
            let took = halted(app, stops.epoch).map(|(epoch, at)| {
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

/// Sends START until the robot moves.
fn drive(app: &TestApp, operator: &mut Operator, over_coap: bool) -> Result<(), String> {
    let until = Instant::now() + PATIENCE;
    loop {
        let started = operator.start(over_coap);
        let glance = Instant::now() + if started.is_ok() { AGAIN } else { PAUSE };
        loop {
            match app.next(glance) {
                Ok(Said::Moves) => return Ok(()),
                Ok(Said::Halt(..) | Said::Doors(_)) => {}
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return Err("the program has ended".to_owned()),
            }
        }
        if Instant::now() > until {
            let refused = started.err().map(|error| format!("START: {error}"));
            return Err(refused.unwrap_or_else(|| "the robot was started and does not move".to_owned()));
        }
    }
}

/// Epoch and time of the next halt after this epoch.
fn halted(app: &TestApp, epoch: u64) -> Option<(u64, u64)> {
    let until = Instant::now() + PATIENCE;
    loop {
        match app.next(until).ok()? {
            Said::Halt(later, at) if later > epoch => return Some((later, at)),
            Said::Halt(..) | Said::Moves | Said::Doors(_) => {}
        }
    }
}
