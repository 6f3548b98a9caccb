//! Resources that each server is asked for: a temperature of about the same length, and 50 kB. The rivals get
//! resources like those of hallsweep.

use std::time::{Duration, Instant};

use crate::blocks::BLOCKS;
use crate::client::{BLOCK, Client};
use crate::datagram::CONTENT;
use crate::server::{Kind, Server};

/// Resource that is observed and changed.
pub(crate) const RESOURCE: &str = "/temperature";

/// Length in bytes of the rivals' resource, equal to that of hallsweep's idle robot.
const LENGTH: usize = 119;

/// Time limit for hallsweep's robot to find and photograph a piece of luggage.
const SEARCH: Duration = Duration::from_secs(30);

/// Resource that is read repeatedly. It must not change during the run, and hallsweep's temperature does.
pub(crate) const fn read(kind: Kind) -> &'static str {
    match kind {
        Kind::Hallsweep => "/robot",
        Kind::Libcoap | Kind::LibcoapNon | Kind::CoapRs | Kind::Bare => RESOURCE,
    }
}

/// Sets the temperature and returns the answer to a GET of the measured resource; `None` after a printed reason when
/// the temperature cannot be set.
pub(crate) fn prepared(server: &Server) -> Option<Vec<u8>> {
    let mut client = Client::new(server.address);
    let answer = client.put(RESOURCE, &reading(server.kind, 10.0));
    let is_set = answer.as_ref().is_some_and(|(code, _)| code >> 5 == 2);
    match client.get(read(server.kind)) {
        Some((CONTENT, body)) if is_set => Some(body),
        got => {
            server.kind.left_out(&format!("PUT {RESOURCE} gives {answer:?}, GET {got:?}"));
            None
        }
    }
}

/// Payload of a PUT that changes the temperature; rivals return it unchanged.
pub(crate) fn reading(kind: Kind, celsius: f64) -> String {
    if kind == Kind::Hallsweep {
        return format!("{{\"celsius\":{celsius:.1}}}");
    }
    let start = format!("{{\"celsius\":{celsius:.1},\"status\":\"");
    let filled = LENGTH.saturating_sub(start.len() + 2);
    format!("{start}{:o<filled$}\"}}", "")
}

/// A resource of at least 50 kB: its path and its first 49 blocks; `None` after a printed reason when there is none.
pub(crate) fn photo(server: &Server) -> Option<(&'static str, Vec<u8>)> {
    let mut client = Client::new(server.address);
    let path = match server.kind {
        Kind::Hallsweep => searched(&mut client),
        Kind::Libcoap | Kind::LibcoapNon => given(&mut client),
        Kind::CoapRs | Kind::Bare => "/large",
    };
    let bytes = client.blocks(path, BLOCKS);
    let is_whole = bytes.len() == BLOCKS as usize * BLOCK;
    if !is_whole {
        server.kind.left_out(&format!("{path} gave {} bytes of 50 kB", bytes.len()));
    }
    is_whole.then_some((path, bytes))
}

/// Path of the photo of the first piece, after a search that finds it.
fn searched(client: &mut Client) -> &'static str {
    let path = "/luggage/1/photo";
    let since = Instant::now();
    client.post("/commands/start");
    while since.elapsed() < SEARCH && client.get(path).is_none_or(|(code, _)| code != CONTENT) {
        std::thread::sleep(Duration::from_millis(50));
    }
    path
}

fn given(client: &mut Client) -> &'static str {
    let bytes: Vec<u8> = (0..BLOCKS as usize * BLOCK).map(|at| (at % 251) as u8).collect();
    client.put_blocks("/large", &bytes);
    "/large"
}
