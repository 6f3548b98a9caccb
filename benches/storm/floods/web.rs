//! Floods of the MQTT door over WebSocket.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use super::mqtt::{command, hold, pour};
use crate::course::{Course, VIEWER};
use crate::http::somewhere;
use crate::packets::{PINGREQ, connect};
use crate::wire::{Wire, login};

/// Time limit of every socket operation.
const PATIENCE: Duration = Duration::from_secs(2);

/// Commands that a viewer may not give, and pings.
pub(super) fn refused(course: &Arc<Course>) {
    course.clients(8, |course, n| {
        let packets = if n.is_multiple_of(2) { command() } else { PINGREQ.to_vec() };
        pour(viewer(course, n)?, course, &packets, 100)
    });
}

/// 300 connections of one viewer.
pub(super) fn sessions(course: &Arc<Course>) {
    course.clients(4, |course, n| hold(course, 75, viewer, n));
}

/// Connections that send no CONNECT, or only half of one.
pub(super) fn halves(course: &Arc<Course>) {
    course.clients(4, |course, n| {
        hold(
            course,
            100,
            |course, session| {
                let mut wire = Wire::web(course.doors.http, somewhere(session), PATIENCE)?;
                let connect = connect(&format!("half-{session}"), 60);
                wire.say(&connect[..session % connect.len()])?;
                Ok(wire)
            },
            n,
        )
    });
}

/// Connection of a viewer that has sent its CONNECT.
fn viewer(course: &Course, n: usize) -> io::Result<Wire> {
    let mut wire = Wire::web(course.doors.http, somewhere(n), PATIENCE)?;
    wire.say(&login(&format!("web-{n}"), VIEWER, &course.doors.viewer))?;
    Ok(wire)
}
