//! Floods of the HTTP door, with a viewer's key and without one.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use crate::course::Course;
use crate::http::{Kept, connected, near, request, somewhere};

/// Time limit of every socket operation.
const PATIENCE: Duration = Duration::from_secs(1);

/// Threads that hold connections open, and connections per thread.
const HOLDING: usize = 4;
const EACH: usize = 500;

/// Interval between two checks of a thread's connections.
const LOOK: Duration = Duration::from_millis(10);

/// Checks between two letters of a slow sender.
const LETTER: usize = 50;

/// Source address of a connection, and its first bytes.
type Source = fn(usize) -> Ipv4Addr;
type Beginning = fn(&Course, usize) -> Vec<u8>;

/// 2,000 connections that send a head and one byte of the body; a third of them without a key.
pub(super) fn bodies(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "", (somewhere, body)));
}

/// The flood `bodies` from the operator's own address.
pub(super) fn bodies_near(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "", (near, body)));
}

/// 2,000 connections whose heads come letter by letter.
pub(super) fn heads(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "x", (somewhere, head)));
}

/// The flood `heads` from the operator's own address.
pub(super) fn heads_near(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "x", (near, head)));
}

/// Heads of 1 MiB from a client without a key.
pub(super) fn great_heads(course: &Arc<Course>) {
    course.clients(32, |course, n| {
        let mut stream = connected(course.doors.http, somewhere(n), PATIENCE)?;
        let head = format!("GET / HTTP/1.1\r\nHost: {}\r\nX-Long: {}\r\n\r\n", course.doors.http, "x".repeat(1 << 20));
        // The door stops reading before the end, so a failed write also counts.
        stream.write_all(head.as_bytes()).inspect_err(|_| course.did(1))?;
        course.did(1);
        Ok(())
    });
}

/// 2,000 connections that send nothing.
pub(super) fn silence(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "", (somewhere, |_, _| Vec::new())));
}

/// The flood `silence` from the operator's own address.
pub(super) fn silence_near(course: &Arc<Course>) {
    course.clients(HOLDING, |course, n| hold(course, n, "", (near, |_, _| Vec::new())));
}

fn body(course: &Course, n: usize) -> Vec<u8> {
    let token = (!n.is_multiple_of(3)).then_some(&*course.doors.viewer);
    let mut head = request("POST", "/api/v1/commands/goto", course.doors.http, token, &"{".repeat(100));
    head.truncate(head.len() - 99);
    head
}

fn head(course: &Course, n: usize) -> Vec<u8> {
    let token = if !n.is_multiple_of(3) { &*course.doors.viewer } else { "" };
    format!("GET /api/v1/state HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {token}\r\nX-Slow: ", course.doors.http).into()
}

/// Commands that a viewer may not give, on persistent connections.
pub(super) fn refused(course: &Arc<Course>) {
    course.clients(32, |course, n| {
        let goto = request("POST", "/api/v1/commands/goto", course.doors.http, Some(&course.doors.viewer), r#"{"x":1,"y":1}"#);
        again(course, n, &[goto])
    });
}

/// Commands without a key, or with a wrong one.
pub(super) fn strangers(course: &Arc<Course>) {
    course.clients(32, |course, n| {
        let command = |token| request("POST", "/api/v1/commands/start", course.doors.http, token, "");
        again(course, n, &[command(None), command(Some("wrong"))])
    });
}

/// All readable resources, on persistent connections.
pub(super) fn reads(course: &Arc<Course>) {
    course.clients(32, |course, n| {
        let paths = ["state", "map", "missions", "luggage", "missions/1/events"].map(|name| format!("/api/v1/{name}"));
        let read = |path: &String| request("GET", path, course.doors.http, Some(&course.doors.viewer), "");
        again(course, n, &paths.each_ref().map(read))
    });
}

/// Pipelined requests whose answers are not read.
pub(super) fn pipelines(course: &Arc<Course>) {
    course.clients(64, |course, n| {
        let mut stream = connected(course.doors.http, somewhere(n), PATIENCE)?;
        let (key, door) = (Some(&*course.doors.viewer), course.doors.http);
        let asked = if n.is_multiple_of(2) {
            request("GET", "/api/v1/state", door, key, "")
        } else {
            request("POST", "/api/v1/commands/goto", door, key, r#"{"x":1,"y":1}"#)
        };
        let many = asked.repeat(100);
        while course.goes_on() {
            match stream.write_all(&many) {
                Ok(()) => course.did(100),
                // The door has stopped reading; the connection stays open until the door closes it.
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => course.did(1),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    });
}

/// Streams that are opened, read once and closed.
pub(super) fn streams(course: &Arc<Course>) {
    course.clients(32, |course, n| {
        let mut stream = connected(course.doors.http, somewhere(n), PATIENCE)?;
        let path = if n.is_multiple_of(2) { "/api/v1/events" } else { "/console/live" };
        stream.write_all(&request("GET", path, course.doors.http, Some(&course.doors.viewer), ""))?;
        stream.read_exact(&mut [0; 64])?;
        course.did(1);
        Ok(())
    });
}

/// Connections that are opened and closed as fast as the system allows.
pub(super) fn comings(course: &Arc<Course>) {
    course.clients(16, |course, n| {
        let stream = connected(course.doors.http, somewhere(n), PATIENCE)?;
        // A reset leaves no socket in TIME_WAIT, so that ports do not run out.
        socket2::SockRef::from(&stream).set_linger(Some(Duration::ZERO))?;
        course.did(1);
        Ok(())
    });
}

/// Sends the requests in turn, as fast as answers come.
fn again(course: &Course, n: usize, requests: &[Vec<u8>]) -> io::Result<()> {
    let mut kept = Kept::to(course.doors.http, somewhere(n), PATIENCE)?;
    for request in requests.iter().cycle() {
        if !course.goes_on() {
            break;
        }
        kept.ask(request)?;
        course.did(1);
    }
    Ok(())
}

/// Holds connections that begin with `begin` and then send `letter` at intervals; a closed connection is replaced.
fn hold(course: &Course, thread: usize, letter: &str, (from, begin): (Source, Beginning)) -> io::Result<()> {
    let mut held: Vec<Option<TcpStream>> = (0..EACH).map(|_| None).collect();
    for look in 0_usize.. {
        for (place, stream) in held.iter_mut().enumerate() {
            if !course.goes_on() {
                return Ok(());
            }
            match stream {
                None => {
                    let n = thread * EACH + place;
                    let mut opened = connected(course.doors.http, from(n), PATIENCE)?;
                    opened.write_all(&begin(course, n))?;
                    opened.set_nonblocking(true)?;
                    *stream = Some(opened);
                    course.did(1);
                }
                Some(open) => {
                    let speaks = !letter.is_empty() && look % LETTER == place % LETTER;
                    let is_told = !speaks || open.write_all(letter.as_bytes()).is_ok();
                    let waits = open.read(&mut [0; 1024]).is_err_and(|error| error.kind() == ErrorKind::WouldBlock);
                    if !is_told || !waits {
                        *stream = None;
                    }
                }
            }
        }
        sleep(LOOK);
    }
    Ok(())
}
