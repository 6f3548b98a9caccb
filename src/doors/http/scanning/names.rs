//! The routes that are always STOP, for all methods except those that change nothing. A path with a fault (an extra
//! slash, another case, blanks, escapes) still names its route. Bodies are not read here.

use crate::api::halt::bare;
use hallsweep_core::hall::HallId;

/// The routes that are STOP, as in the table of routes.
pub const STOPS: [&str; 4] = ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"];

/// Other paths that people try, and the routes that these paths mean.
const OTHERWISE: [(&str, &str); 3] = [("/api/v1/commands/h", STOPS[0]), ("/console/h", STOPS[1]), ("/stop", STOPS[2])];

/// The routes that are STOP if the body of the request contains the word for STOP.
pub const BY_BODY: [&str; 2] = ["/api/v1/commands/move", "/console/move"];

/// Methods that change nothing (RFC 9110, section 9.2.1).
const SAFE: [&[u8]; 4] = [b"GET", b"HEAD", b"OPTIONS", b"TRACE"];

/// Returns the STOP route that a request names. `hall` says whose STOP it is.
pub fn stop(method: &[u8], path: &[u8]) -> Option<&'static str> {
    if is_safe(method) {
        return None;
    }
    let (_, named) = split(path);
    let mut routes = STOPS.into_iter().map(|route| (route, route)).chain(OTHERWISE);
    routes.find(|(name, _)| is_at(&named, name)).map(|(_, route)| route)
}

/// Returns the route that a request names, if the body decides whether this request is a STOP.
pub fn says_by_body(method: &[u8], path: &[u8]) -> Option<&'static str> {
    if is_safe(method) {
        return None;
    }
    let (_, named) = split(path);
    BY_BODY.into_iter().find(|route| is_at(&named, route))
}

fn is_safe(method: &[u8]) -> bool {
    SAFE.iter().any(|safe| method.eq_ignore_ascii_case(safe))
}

/// Whether a path names the route for MQTT over WebSocket.
pub fn is_upgrade(path: &[u8]) -> bool {
    is_at(&split(path).1, "/mqtt")
}

/// Returns the hall that a path names; `None` for the default hall.
pub fn hall(path: &[u8]) -> Option<HallId> {
    split(path).0
}

/// Splits a path into the hall that it names, and the other segments.
fn split(path: &[u8]) -> (Option<HallId>, Vec<String>) {
    let mut named = segments(path);
    let at = if named.starts_with(&["api", "v1"].map(str::to_owned)) { 2 } else { 0 };
    let hall = named.get(at).filter(|first| *first == "halls").and_then(|_| HallId::new(named.get(at + 1)?));
    if hall.is_some() {
        named.drain(at..at + 2);
    }
    (hall, named)
}

/// Returns the segments of a path in lower case, because the routes here are in lower case.
fn segments(path: &[u8]) -> Vec<String> {
    let path = String::from_utf8_lossy(&unescaped(path)).to_ascii_lowercase();
    path.split('/').map(bare).filter(|segment| !segment.is_empty() && *segment != ".").map(str::to_owned).collect()
}

fn is_at(named: &[String], route: &str) -> bool {
    named.iter().map(String::as_str).eq(route.split('/').skip(1))
}

/// Decodes the escapes of a path (RFC 3986, section 2.1), escaped slashes included. A byte that was escaped twice
/// stays escaped once.
fn unescaped(path: &[u8]) -> Vec<u8> {
    let mut plain = Vec::with_capacity(path.len());
    let mut rest = path;
    while let Some((&byte, behind)) = rest.split_first() {
        let digit = |place: usize| behind.get(place).and_then(|byte| char::from(*byte).to_digit(16));
        match (byte, digit(0), digit(1)) {
            (b'%', Some(high), Some(low)) => {
                plain.extend(u8::try_from(high * 16 + low));
                rest = &behind[2..];
            }
            (_, _, _) => {
                plain.push(byte);
                rest = behind;
            }
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::Need;
    use crate::doors::http::routes::table;

    /// Safety S1, S8.
    #[test]
    fn every_route_that_is_stop_names_it_and_no_other_does() {
        let is_said_by_body = |path: &str| path.ends_with("/move");
        for row in table() {
            let is_stop = row.need == Need::Stop && !is_said_by_body(&row.path);
            let may_be = row.need == Need::Stop && is_said_by_body(&row.path);
            assert_eq!(stop(b"POST", row.path.as_bytes()), is_stop.then_some(&*row.path), "{}", row.path);
            assert_eq!(says_by_body(b"POST", row.path.as_bytes()), may_be.then_some(&*row.path), "{}", row.path);
            for method in ["GET", "HEAD", "OPTIONS", "TRACE", "get"] {
                assert_eq!(stop(method.as_bytes(), row.path.as_bytes()), None, "{method} changes nothing");
                assert_eq!(says_by_body(method.as_bytes(), row.path.as_bytes()), None, "{method} changes nothing");
            }
        }
    }

    /// Safety S8.
    #[test]
    fn a_path_with_a_fault_names_stop_all_the_same() {
        for path in [
            "/api/v1/commands/stop/",
            "//api/v1//commands/stop",
            "api/v1/commands/stop",
            "/API/v1/commands/Stop",
            "/api/v1/commands/stop%20",
            "/api/v1/commands/stop%00",
            "/api%2Fv1%2fcommands/stop%2f",
            "/api/v1/commands/%0A%09stop%0d%c2%a0",
            "/api/v1/commands/h",
            "/./api/v1/commands/stop",
            "/api/v1/commands/%73top",
            "/api/v1/commands/st%6Fp",
        ] {
            assert_eq!(stop(b"POST", path.as_bytes()), Some(STOPS[0]), "{path}");
        }
        for method in ["PUT", "DELETE", "post", "FETCH", "", "\u{7f}"] {
            assert_eq!(stop(method.as_bytes(), b"/h"), Some("/h"), "{method:?}");
            assert_eq!(stop(method.as_bytes(), b"/Stop"), Some("/h"), "{method:?}");
            assert_eq!(says_by_body(method.as_bytes(), b"/Console//move/"), Some("/console/move"), "{method:?}");
        }
    }

    #[test]
    fn what_is_not_named_is_not_stop() {
        for path in [
            "",
            "/",
            "*",
            "/stops",
            "/api/v1/commands",
            "/api/v1/commands/stop/now",
            "/hh",
            "/h%00h",
            "/%68%68",
            "/%2568",
            "/h%3Fx",
            "/x/../h",
            "/%",
            "//h/x",
        ] {
            assert_eq!(stop(b"POST", path.as_bytes()), None, "{path}");
        }
        assert!(is_upgrade(b"/mqtt") && !is_upgrade(b"/"));
    }
}
