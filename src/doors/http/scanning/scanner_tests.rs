//! Tests of the scanner: the bytes are cut at any place and have faults of every kind.

use proptest::prelude::*;

use super::*;

/// Returns everything that the scanner finds in these bytes, and the scanner. The bytes are read in pieces of this
/// size.
fn heard(bytes: &[u8], piece: usize) -> (Vec<Heard>, Scanner) {
    let (mut scanner, mut all) = (Scanner::new("hallsweep-8080"), Vec::new());
    for mut bytes in bytes.chunks(piece.max(1)) {
        while !bytes.is_empty() {
            let (taken, heard) = scanner.take(bytes);
            assert!(taken > 0, "it goes on");
            bytes = &bytes[taken..];
            all.extend(heard);
        }
    }
    (all, scanner)
}

fn heads(bytes: &[u8]) -> Vec<Head> {
    let all = heard(bytes, usize::MAX).0.into_iter();
    all.filter_map(|heard| if let Heard::Head(head) = heard { Some(head) } else { None }).collect()
}

fn head(text: &str) -> Head {
    let mut all = heads(text.as_bytes());
    assert_eq!(all.len(), 1, "{text:?}");
    all.remove(0)
}

fn fields(head: &Head, field: Field) -> Vec<String> {
    let of_it = head.fields.iter().filter(|(other, _)| *other == field);
    of_it.map(|(_, value)| String::from_utf8_lossy(value).into_owned()).collect()
}

/// A request that follows each tested request. It shows whether the scanner finds the next head.
const NEXT: &str = "POST /next HTTP/1.1\r\nHost: localhost\r\n\r\n";

/// Returns the paths of the requests in these bytes. The last path is that of `NEXT`.
fn paths(request: &str) -> Vec<String> {
    let all = heads(format!("{request}{NEXT}").as_bytes());
    all.iter().map(|head| String::from_utf8_lossy(&head.path).into_owned()).collect()
}

#[test]
fn a_request_says_what_it_names_and_who_asks() {
    let head = head(
        "POST /h?x=1 HTTP/1.1\r\nHost: localhost:8080\r\nOrigin: http://localhost:8080\r\nSec-Fetch-Site: same-origin\r\n\
         Authorization: Bearer abc\r\nCookie: a=b; hallsweep-8080=s1; hallsweep-80801=no\r\nCookie: hallsweep-8080=s2\r\n\
         Idempotency-Key: \"k\"\r\nUser-Agent: x\r\n\r\n",
    );
    assert_eq!((&*head.method, &*head.path), (&b"POST"[..], &b"/h"[..]));
    for (field, values) in [
        (Field::Host, &["localhost:8080"][..]),
        (Field::Origin, &["http://localhost:8080"]),
        (Field::SecFetchSite, &["same-origin"]),
        (Field::Authorization, &["Bearer abc"]),
        (Field::Cookie, &["hallsweep-8080=s1", "hallsweep-8080=s2"]),
        (Field::IdempotencyKey, &["\"k\""]),
    ] {
        assert_eq!(fields(&head, field), values);
    }
    assert!(!head.is_in_doubt && !head.wants_upgrade && head.body == BodyLength::Known(0));
}

/// Safety S8.
#[test]
fn lines_may_end_and_go_on_as_they_like() {
    for text in [
        "\r\n\r\nPOST /h HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "POST /h HTTP/1.1\nHost: localhost\n\n",
        "POST /h HTTP/1.1\r\r\nHost: localhost\r\r\n\r\n",
        "POST /h HTTP/1.1\rHost: localhost\r\n\r\n",
        "POST /h HTTP/1.1\r\nHost:\r\n localhost\r\n\r\n",
        "POST /h HTTP/1.1\r\nHost : localhost\r\n\r\n",
        " POST  /h\t HTTP/1.1\r\nhOST:localhost \r\n\r\n",
        "POST /h\r\nHost: localhost\r\n\r\n",
        "POST /h HTTP/9.9 and more\r\nno header\r\n: none\r\nHost: localhost\r\n\r\n",
    ] {
        let head = head(text);
        assert_eq!((&*head.method, &*head.path), (&b"POST"[..], &b"/h"[..]), "{text:?}");
        assert_eq!(fields(&head, Field::Host), ["localhost"], "{text:?}");
    }
}

/// Safety S8, A2: an absolute address names the same route as its path alone. Its host may contain any characters.
#[test]
fn a_target_that_is_a_whole_address_is_taken_apart() {
    for (target, host, path) in [
        ("http://localhost:8080/h", Some("localhost:8080"), "/h"),
        ("HTTPS://a.example//h/?x", Some("a.example"), "//h/"),
        ("any://a;b~;c/h;x", Some("a;b~;c"), "/h"),
        ("http:///h", Some(""), "/h"),
        ("http://h", Some("h"), ""),
        ("http://a?/h", Some("a"), ""),
        ("http://a#/h", Some("a"), ""),
        ("http://a/http://b/h", Some("a"), "/http://b/h"),
        ("/x://h", None, "/x://h"),
        ("//a/h", None, "//a/h"),
        ("http:/h", None, "http:/h"),
    ] {
        let head = head(&format!("POST {target} HTTP/1.1\r\n\r\n"));
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        assert_eq!((head.host.as_deref().map(text).as_deref(), &*text(&head.path)), (host, path), "{target}");
        assert!(!head.is_in_doubt, "{target}");
    }
    let long = head(&format!("POST http://{}/h HTTP/1.1\r\nHost: localhost\r\n\r\n", "x".repeat(5000)));
    assert_eq!(long.path, b"/h", "however long the host is");
    assert!(long.is_in_doubt, "and whose it is nobody can say");
}

/// Safety S8, A5.
#[test]
fn a_head_of_any_length_is_followed_in_little_memory() {
    let filler = "x".repeat(3_000_000);
    let text = format!(
        "POST /h?{filler} HTTP/1.1\r\nX: {filler}\r\n{filler}: x\r\nCookie: {filler}; hallsweep-8080=late; {filler}\r\n\
         Host: localhost\r\n\r\n"
    );
    let mut scanner = Scanner::new("hallsweep-8080");
    let (mut rest, mut found) = (text.as_bytes(), None);
    while found.is_none() {
        let (taken, heard) = scanner.take(&rest[..rest.len().min(10_000)]);
        rest = &rest[taken..];
        assert!(scanner.head.memory() < 16 * 1024, "{}", scanner.head.memory());
        found = heard;
    }
    let Some(Heard::Head(head)) = found else { panic!("{found:?}") };
    assert_eq!(fields(&head, Field::Cookie), ["hallsweep-8080=late"]);
    assert_eq!(fields(&head, Field::Host), ["localhost"]);
}

/// Safety A2: a host or origin that was not stored does not count as ours.
#[test]
fn hosts_and_origins_that_are_not_kept_leave_doubt() {
    let long = "x".repeat(5000);
    for name in ["Host", "Origin", "Sec-Fetch-Site"] {
        assert!(head(&format!("POST /h HTTP/1.1\r\n{name}: {long}\r\n\r\n")).is_in_doubt, "{name}");
        let many: String = (0..6).map(|number| format!("{name}: {number}\r\n")).collect();
        assert!(head(&format!("POST /h HTTP/1.1\r\n{many}\r\n")).is_in_doubt, "{name}");
        let same: String = (0..60).map(|_| format!("{name}: same\r\n")).collect();
        assert!(!head(&format!("POST /h HTTP/1.1\r\n{same}\r\n")).is_in_doubt, "{name}");
    }
    assert!(!head(&format!("POST /h HTTP/1.1\r\nAuthorization: {long}\r\nCookie: {long}\r\n\r\n")).is_in_doubt);
}

#[test]
fn bodies_are_passed_over_by_their_length_or_their_chunks() {
    for (request, next) in [
        ("POST /a HTTP/1.1\r\n\r\n", true),
        ("POST /a HTTP/1.1\r\nContent-Length: 7\r\n\r\nPOST /b", true),
        ("POST /a HTTP/1.1\r\nContent-Length: 2\r\nContent-Length: 2\r\n\r\n{}", true),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n7\r\nPOST /b\r\nA;x=y\r\n0123456789\r\n0\r\n\r\n", true),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: gzip, Chunked\r\nContent-Length: 9\r\n\r\n0 \r\nT: x\r\n\r\n", true),
        ("POST /a HTTP/1.1\r\nContent-Length: x\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", false),
        ("POST /a HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n{}", false),
        ("POST /a HTTP/1.1\r\nContent-Length: -1\r\n\r\n", false),
        ("POST /a HTTP/1.1\r\nContent-Length:\r\n\r\n", false),
        ("POST /a HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n", false),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked, gzip\r\n\r\n", false),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nx\r\n", false),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n1\r\nab", false),
        ("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nfffffffffffffffff\r\n", false),
    ] {
        let expect: &[&str] = if next { &["/a", "/next"] } else { &["/a"] };
        assert_eq!(paths(request), expect, "{request:?}");
    }
}

#[test]
fn what_begins_with_no_method_is_told_at_once() {
    for (begin, is_none) in [("\u{16}\u{3}\u{1}", true), ("\r\n{", true), ("POST", false), ("", false), ("\r\n", false)] {
        assert_eq!(heard(begin.as_bytes(), 1).1.is_no_request(), is_none, "{begin:?}");
    }
}

proptest! {
    /// The result is the same as if each byte were read by `push`.
    #[test]
    fn a_head_is_heard_as_if_each_of_its_bytes_were_looked_at(
        parts in proptest::collection::vec(prop_oneof![
            Just("POST /h HTTP/1.1\r\n".to_owned()),
            Just("Cookie: ".to_owned()),
            Just("Host: ".to_owned()),
            Just("hallsweep-8080=s1".to_owned()),
            Just("Content-Length: 5".to_owned()),
            Just("\r\n".to_owned()),
            Just("\r".to_owned()),
            "[a;: \n\t]{0,3}",
            "[a-z;]{30,40}",
            "[b ]{1020,1030}",
        ], 0..30),
    ) {
        let bytes = format!("{}\r\n\r\n", parts.concat()).into_bytes();
        let mut reader = HeadReader::new("hallsweep-8080");
        let first = bytes.iter().find_map(|byte| reader.push(*byte));
        let heard = heads(&bytes).into_iter().next();
        prop_assert_eq!(heard, first);
    }

    /// Safety A7.
    #[test]
    fn any_bytes_are_heard_alike_however_they_are_cut(bytes in proptest::collection::vec(any::<u8>(), 0..600), piece in 1usize..40) {
        prop_assert_eq!(heard(&bytes, piece).0, heard(&bytes, usize::MAX).0);
    }

    /// Safety A7.
    #[test]
    fn requests_are_heard_alike_however_they_are_cut(
        parts in proptest::collection::vec(prop_oneof![
            Just("POST /h HTTP/1.1\r\n"), Just("Host: a\r\n"), Just("\r\n"), Just("\n"), Just("\r"), Just(" "), Just("Content-Length: 3\r\n"),
            Just("Transfer-Encoding: chunked\r\n"), Just("3\r\nabc\r\n"), Just("0\r\n\r\n"), Just("abc"), Just("Cookie: hallsweep-8080=x;y\r\n"),
        ], 0..30),
        piece in 1usize..40,
    ) {
        let bytes = parts.concat().into_bytes();
        prop_assert_eq!(heard(&bytes, piece).0, heard(&bytes, usize::MAX).0);
    }
}

/// Safety S8: if hyper rejects the size of a chunk, the scanner finds no end of the body either.
#[test]
fn the_size_of_a_chunk_that_is_larger_than_any_is_no_size() {
    for size in ["10000000000000000", "fffffffffffffffff", "g", "-1", ""] {
        let text = format!("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n{size}\r\n\r\n{NEXT}");
        let heard = heard(text.as_bytes(), usize::MAX).0;
        assert_eq!(heard.len(), 1, "{size}: {heard:?}");
    }
}
