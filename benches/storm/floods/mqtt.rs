//! Floods of the MQTT door over TCP, all by one viewer. The same floods are sent to mosquitto, which has no
//! viewers and accepts all messages.

use std::io::{self, ErrorKind};
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::sleep;
use std::time::Duration;

use crate::course::{Course, OPERATOR, SECOND, VIEWER};
use crate::http::{near, somewhere};
use crate::packets::{PINGREQ, PUBACK, RETAIN, SUBACK, UNSUBACK, connect, packet, publish, subscribe, text};
use crate::wire::{Wire, login};

/// Time limit of every socket operation.
const PATIENCE: Duration = Duration::from_secs(2);

/// Number of concurrent clients.
const CLIENTS: usize = 8;

/// Packets per write.
const BURST: usize = 200;

/// Interval between two checks of all held connections.
const LOOK: Duration = Duration::from_millis(20);

/// Number of messages that the operators have retained, and number of levels of their topics.
const KEPT: usize = 8000;
const LEVELS: usize = 31;

/// Commands that a viewer may not give.
pub(super) fn refused(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| pour(viewer(course, n)?, course, &command(), BURST));
}

/// Terms of 4 KB that are invalid, or that a viewer may not send.
pub(super) fn terms(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        let depth = 4000 / 3;
        let inner = if n.is_multiple_of(2) { "f(".repeat(depth) + "x" + &")".repeat(depth) } else { "x".repeat(4000) };
        let term = format!("msg(userCmd,dispatch,js,robotmind,userCmd({inner}),1)");
        pour(viewer(course, n)?, course, &publish("unibo/qak/robotmind", term.as_bytes(), 0, 0, 0), BURST / 10)
    });
}

pub(super) fn pings(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| pour(viewer(course, n)?, course, &PINGREQ, 10 * BURST));
}

/// Repeated packets with 80,000 filters each.
pub(super) fn unsubscribe(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        let mut wire = viewer(course, n)?;
        let filters = [&7_u16.to_be_bytes()[..], &text("a").repeat(80_000)].concat();
        let packet = packet(0xA2, &filters);
        while course.goes_on() {
            wire.say(&packet)?;
            course.did(1);
            wire.until(UNSUBACK)?;
        }
        Ok(())
    });
}

/// Packets with 64 filters of 31 levels, over 8,000 retained messages.
pub(super) fn filters(course: &Arc<Course>) {
    course.prepare(keep);
    course.clients(CLIENTS, |course, n| {
        if !course.is_prepared() {
            sleep(LOOK);
            return Ok(());
        }
        let mut wire = viewer(course, n)?;
        let filter = |z: u16| [text(&format!("{}z{z}", "+/".repeat(LEVELS - 1))), vec![0]].concat();
        let filters: Vec<u8> = (0..64).flat_map(filter).collect();
        wire.say(&packet(0x82, &[&9_u16.to_be_bytes()[..], &filters].concat()))?;
        course.did(1);
        wire.until(SUBACK).map(drop)
    });
}

/// Retains all these messages from two operators, because one operator may retain only half of them.
fn keep(course: &Course) -> io::Result<()> {
    for (who, name, token) in [(0, OPERATOR, &course.doors.operator), (1, SECOND, &course.doors.second)] {
        let connect = login(&format!("keeper-{name}"), name, token);
        let mut wire = Wire::let_in(course.doors.mqtt, Ipv4Addr::LOCALHOST, &connect, PATIENCE)?;
        for n in 0..KEPT / 2 {
            let topic = format!("{}k{n}-{who}", "k/".repeat(LEVELS - 1));
            wire.say(&publish(&topic, b"kept", 1, RETAIN, n as u16 + 1))?;
            if n % 100 == 99 {
                (0..100).try_for_each(|_| wire.until(PUBACK).map(drop))?;
            }
        }
    }
    Ok(())
}

/// New topic names, in publications and in filters.
pub(super) fn topics(course: &Arc<Course>) {
    static NAMED: AtomicU64 = AtomicU64::new(0);
    course.clients(CLIENTS, |course, n| {
        let mut wire = viewer(course, n)?;
        wire.read_idly()?;
        while course.goes_on() {
            let first = NAMED.fetch_add(BURST as u64, Ordering::Relaxed);
            let named = |number: u64| match number % 4 {
                0 => subscribe(1, &format!("named/{number}"), 0),
                1 => publish(&format!("hallsweep/discovery/command/named-{number}"), b"{}", 0, 0, 0),
                _ => publish(&format!("unibo/qak/named-{number}"), b"msg(a,event,b,none,c,1)", 0, 0, 0),
            };
            let packets: Vec<u8> = (first..first + BURST as u64).flat_map(named).collect();
            wire.say(&packets)?;
            course.did(BURST);
        }
        Ok(())
    });
}

/// 300 connections of one viewer.
pub(super) fn sessions(course: &Arc<Course>) {
    course.clients(4, |course, n| {
        hold(
            course,
            75,
            |course, session| {
                let connect = login(&format!("session-{session}"), VIEWER, &course.doors.viewer);
                Wire::let_in(course.doors.mqtt, somewhere(session), &connect, PATIENCE)
            },
            n,
        )
    });
}

/// Subscribers to all topics that have stopped reading, and refused commands whose results they should receive.
pub(super) fn stalled(course: &Arc<Course>) {
    course.clients(1, |course, _| {
        hold(
            course,
            12,
            |course, n| {
                let mut wire = viewer(course, 100 + n)?;
                wire.say(&subscribe(1, "#", 1))?;
                Ok(wire)
            },
            0,
        )
    });
    course.clients(CLIENTS / 2, |course, n| pour(viewer(course, n)?, course, &command(), BURST));
}

/// Clients that send requests constantly and never read an answer.
pub(super) fn deaf(course: &Arc<Course>) {
    course.clients(4 * CLIENTS, |course, n| {
        let mut wire = viewer(course, n)?;
        let asked = [&PINGREQ.repeat(50)[..], &subscribe(1, "hallsweep/#", 0), &publish("a", b"", 1, 0, 1)].concat();
        while course.goes_on() {
            // A client whose packets are not read any more stays until the broker disconnects it.
            match wire.say(&asked) {
                Ok(()) => course.did(52),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => course.did(1),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    });
}

/// Connections that send no CONNECT, or only half of one.
pub(super) fn halves(course: &Arc<Course>) {
    course.clients(4, |course, n| hold(course, 100, |course, session| half(course, somewhere(session), session), n));
}

/// The flood `halves` from the operator's own address.
pub(super) fn halves_near(course: &Arc<Course>) {
    course.clients(4, |course, n| hold(course, 100, |course, session| half(course, near(session), session), n));
}

fn half(course: &Course, from: Ipv4Addr, session: usize) -> io::Result<Wire> {
    let mut wire = Wire::silent(course.doors.mqtt, from, PATIENCE)?;
    let connect = connect(&format!("half-{session}"), 60);
    wire.say(&connect[..session % connect.len()])?;
    Ok(wire)
}

/// Clients that connect, are accepted, and leave.
pub(super) fn comings(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        viewer(course, n)?;
        course.did(1);
        Ok(())
    });
}

/// A command that a viewer may not give.
pub(super) fn command() -> Vec<u8> {
    publish("hallsweep/discovery/command/start", b"{}", 0, 0, 0)
}

/// Connection of a viewer that the broker has accepted.
fn viewer(course: &Course, n: usize) -> io::Result<Wire> {
    let connect = login(&format!("viewer-{n}"), VIEWER, &course.doors.viewer);
    Wire::let_in(course.doors.mqtt, somewhere(n), &connect, PATIENCE)
}

/// Sends a packet as fast as it is accepted, and reads and discards what comes.
pub(super) fn pour(mut wire: Wire, course: &Course, packet: &[u8], burst: usize) -> io::Result<()> {
    wire.read_idly()?;
    let packets = packet.repeat(burst);
    while course.goes_on() {
        wire.say(&packets)?;
        course.did(burst);
    }
    Ok(())
}

/// Holds `count` connections open; a closed connection is replaced.
pub(super) fn hold(course: &Course, count: usize, open: fn(&Course, usize) -> io::Result<Wire>, thread: usize) -> io::Result<()> {
    let mut held: Vec<Option<Wire>> = (0..count).map(|_| None).collect();
    while course.goes_on() {
        for (place, wire) in held.iter_mut().enumerate() {
            if wire.as_mut().is_some_and(Wire::is_over) {
                *wire = None;
            }
            if wire.is_none() && course.goes_on() {
                *wire = open(course, thread * count + place).ok();
                course.did(1);
            }
        }
        sleep(LOOK);
    }
    Ok(())
}
