//! Floods of the MQTT door by WebSocket.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use super::mqtt::{command, hold, pour};
use crate::course::{Course, VIEWER};
use crate::http::somewhere;
use crate::packets::{PINGREQ, connect};
use crate::wire::{Wire, login};

/// How long anything is waited for.
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

/// Connections that never say who they are, or only half of it.
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

/// A viewer that has said who it is.
fn viewer(course: &Course, n: usize) -> io::Result<Wire> {
    let mut wire = Wire::web(course.doors.http, somewhere(n), PATIENCE)?;
    wire.say(&login(&format!("web-{n}"), VIEWER, &course.doors.viewer))?;
    Ok(wire)
}
