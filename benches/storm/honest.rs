//! Honest clients during the storm: an operator's page, a screen at the broker and an observer over CoAP. They count
//! the messages that they receive and their lost connections.

use std::io::{self, Read, Write};
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use crate::coap::Coap;
use crate::course::{Course, OPERATOR};
use crate::http::{connected, request};
use crate::packets::{PINGREQ, SUBACK, subscribe};
use crate::wire::{Wire, login};

/// Silence after which a connection counts as lost; the page's stream sends something every second.
const PATIENCE: Duration = Duration::from_secs(10);

pub(crate) fn look_on(course: &Arc<Course>) {
    course.clients(1, page);
    course.clients(1, screen);
    course.clients(1, observer);
}

fn page(course: &Course, _: usize) -> io::Result<()> {
    let mut stream = connected(course.doors.http, Ipv4Addr::LOCALHOST, PATIENCE)?;
    stream.write_all(&request("GET", "/console/live", course.doors.http, Some(&course.doors.operator), ""))?;
    let mut bytes = [0; 64 * 1024];
    while course.goes_on() {
        if stream.read(&mut bytes)? == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        course.did(1);
    }
    Ok(())
}

fn screen(course: &Course, _: usize) -> io::Result<()> {
    let connect = login("honest-screen", OPERATOR, &course.doors.operator);
    let mut wire = Wire::let_in(course.doors.mqtt, Ipv4Addr::LOCALHOST, &connect, PATIENCE)?;
    wire.say(&subscribe(1, "hallsweep/discovery/state/#", 0))?;
    wire.until(SUBACK)?;
    while course.goes_on() {
        wire.next()?;
        wire.say(&PINGREQ)?;
        course.did(1);
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

fn observer(course: &Course, _: usize) -> io::Result<()> {
    let mut client = Coap::at(course.doors.coap);
    client.observe("robot")?;
    while course.goes_on() {
        // A robot that does not move causes no notifications.
        match client.next() {
            Ok(_) => course.did(1),
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
