//! Messages that break the rules, and options that are not understood.

use coap_endpoint::{Code, Method};

use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message, option};

fn said(bytes: &[u8]) -> Vec<Message> {
    let mut bench = Bench::new();
    bench.deliver(here(), bytes);
    bench.wait(std::time::Duration::from_secs(300));
    assert!(bench.server.asked.is_empty(), "{bytes:02x?} reached the application");
    bench.said_to(here())
}

/// Nothing is answered, or a RST of the same id.
#[track_caller]
fn is_rejected_or_ignored(bytes: &[u8]) {
    let said = said(bytes);
    let id = u16::from_be_bytes([bytes[2], bytes[3]]);
    assert!(said.is_empty() || said == [Message::empty(Kind::Rst, id)], "{bytes:02x?}: {said:?}");
}

#[test]
fn another_version_is_met_with_silence() {
    for version in [0x00, 0x80, 0xC0] {
        for kind in [0x00, 0x10, 0x20, 0x30] {
            assert_eq!(said(&[version | kind, 1, 0x12, 0x34, 0xB4, b't', b'e', b's', b't']), []);
            assert_eq!(said(&[version | kind, 0, 0x12, 0x34]), []);
        }
    }
}

#[test]
fn what_is_no_message_is_met_with_silence() {
    for bytes in [&[][..], &[0x40], &[0x40, 1], &[0x40, 1, 2]] {
        assert_eq!(said(bytes), []);
    }
}

#[test]
fn a_malformed_message_is_rejected_or_ignored() {
    let bad: [&[u8]; 12] = [
        &[0x40, 1, 0x12, 0x34, 0xFF],
        &[0x40, 1, 0x12, 0x34, 0xB4, b't', b'e', b's', b't', 0xFF],
        &[0x49, 1, 0x12, 0x34, 1, 2, 3, 4, 5, 6, 7, 8, 9],
        &[0x4F, 1, 0x12, 0x34, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
        &[0x44, 1, 0x12, 0x34, 1, 2],
        &[0x40, 1, 0x12, 0x34, 0xB5, b't', b'e', b's', b't'],
        &[0x40, 1, 0x12, 0x34, 0xF4, b't', b'e', b's', b't'],
        &[0x40, 1, 0x12, 0x34, 0xBF, b't', b'e', b's', b't'],
        &[0x40, 1, 0x12, 0x34, 0xD0],
        &[0x40, 1, 0x12, 0x34, 0xE0, 0],
        &[0x40, 1, 0x12, 0x34, 0xE0, 0xFF, 0xFF],
        &[0x40, 1, 0x12, 0x34, 0xBE, 0xFF, 0xFF],
    ];
    for bytes in bad {
        is_rejected_or_ignored(bytes);
        let as_non = [&[bytes[0] | 0x10], &bytes[1..]].concat();
        is_rejected_or_ignored(&as_non);
    }
}

#[test]
fn an_empty_message_that_is_not_empty_is_rejected_or_ignored() {
    for bytes in [&[0x40, 0, 1, 2, 0][..], &[0x41, 0, 1, 2, 9], &[0x40, 0, 1, 2, 0xFF, 1], &[0x50, 0, 1, 2], &[0x51, 0, 1, 2, 9]]
    {
        is_rejected_or_ignored(bytes);
    }
    for bytes in
        [&[0x60, 0, 1, 2][..], &[0x70, 0, 1, 2], &[0x60, 0, 1, 2, 9], &[0x70, 0, 1, 2, 9], &[0x60, 1, 1, 2], &[0x70, 1, 1, 2]]
    {
        assert_eq!(said(bytes), [], "an acknowledgement or a rejection is never answered");
    }
}

#[test]
fn a_response_or_a_reserved_code_that_nobody_asked_for_is_rejected_or_ignored() {
    for code in [0x20, 0x3F, 0x41, 0x45, 0x84, 0xA0, 0xC0, 0xE1, 0xFF] {
        is_rejected_or_ignored(&[0x40, code, 1, 2]);
        is_rejected_or_ignored(&[0x50, code, 1, 2]);
    }
}

#[test]
fn a_method_that_is_not_there_is_refused() {
    for code in [8, 9, 31] {
        let request = Message { code: Code(code), ..Message::get("/test", 1) };
        Bench::new().ask(&request).answers(&request, Code::METHOD_NOT_ALLOWED);
    }
    let request = Message::con(Method::Post, 1).path("/validate").token(b"p");
    Bench::new().ask(&request).answers(&request, Code::METHOD_NOT_ALLOWED);
}

#[test]
fn a_critical_option_that_is_not_understood_is_refused_to_con_and_not_served_to_non() {
    for number in [9, 13, 21, 2049, 65_001, 65_535] {
        let request = Message::get("/test", 1).token(b"c").with(number, b"x");
        let mut bench = Bench::new();
        bench.ask(&request).answers(&request, Code::BAD_OPTION);
        assert!(bench.server.asked.is_empty());
        is_rejected_or_ignored(&Message { kind: Kind::Non, ..request }.encoded());
    }
}

#[test]
fn a_critical_option_that_comes_twice_is_as_one_that_is_not_understood() {
    let twice: [(u16, &[u8]); 4] = [(option::ACCEPT, b""), (option::BLOCK2, &[0]), (3, b"host"), (7, &[22, 51])];
    for (number, value) in twice {
        let request = Message::get("/test", 1).with(number, value).with(number, value);
        Bench::new().ask(&request).answers(&request, Code::BAD_OPTION);
        is_rejected_or_ignored(&Message { kind: Kind::Non, ..request }.encoded());
    }
}

#[test]
fn a_critical_option_of_the_wrong_length_is_as_one_that_is_not_understood() {
    for (number, value) in [(option::ACCEPT, &[0, 0, 0][..]), (option::BLOCK2, &[0; 4]), (option::IF_NONE_MATCH, &[1]), (3, &[])]
    {
        let request = Message::get("/test", 1).with(number, value);
        Bench::new().ask(&request).answers(&request, Code::BAD_OPTION);
    }
}

#[test]
fn an_elective_option_that_is_not_understood_is_passed_over() {
    for number in [2, 10, 30, 2048, 65_000] {
        let request = Message::get("/test", 1).with(number, b"whatever it is");
        Bench::new().ask(&request).answers(&request, Code::CONTENT);
    }
}

#[test]
fn whoever_takes_it_for_a_proxy_is_told() {
    for (number, value) in [(option::PROXY_URI, &b"coap://elsewhere/"[..]), (option::PROXY_SCHEME, b"http")] {
        let request = Message::get("/test", 1).token(b"p").with(number, value);
        Bench::new().ask(&request).answers(&request, Code::NO_PROXY);
    }
}

#[test]
fn host_and_port_are_understood() {
    let request = Message::get("/test", 1).with(3, b"hall").number(7, 5683);
    Bench::new().ask(&request).answers(&request, Code::CONTENT);
}

#[test]
fn what_is_not_there_is_not_found_and_says_so_in_words() {
    let request = Message::get("/nowhere", 1).token(b"n");
    let answer = Bench::new().ask(&request);
    answer.answers(&request, Code::NOT_FOUND);
    assert!(answer.text().contains("/nowhere") && answer.value(option::CONTENT_FORMAT).is_none(), "a diagnostic has no format");
}

#[test]
fn max_age_is_said_where_it_is_not_the_usual() {
    let answer = Bench::new().ask(&Message::get("/obs", 1));
    assert_eq!(answer.value(option::MAX_AGE).unwrap_or(60), 60);
    let mut bench = Bench::new();
    bench.server.things.get_mut("/obs").unwrap().max_age = Some(5);
    assert_eq!(bench.ask(&Message::get("/obs", 1)).value(option::MAX_AGE), Some(5));
}

#[test]
fn an_answer_that_is_not_wanted_is_not_sent() {
    let put = |kind, id, path: &str, no: u32| {
        let message = Message::con(Method::Put, id).token(b"n").path(path).number(option::NO_RESPONSE, no).payload("x");
        Message { kind, ..message }
    };
    let mut bench = Bench::new();
    assert_eq!(bench.send(&put(Kind::Con, 1, "/test", 2)), [Message::empty(Kind::Ack, 1)], "a CON is acknowledged all the same");
    assert_eq!(bench.send(&put(Kind::Non, 2, "/test", 2)), []);
    assert_eq!(bench.send(&put(Kind::Non, 3, "/nowhere", 2))[0].code, Code::NOT_FOUND, "it wants to hear of failures");
    assert_eq!(bench.send(&put(Kind::Non, 4, "/nowhere", 26)), [], "not of failures either");
    assert_eq!(bench.send(&put(Kind::Non, 5, "/test", 24))[0].code, Code::CHANGED);
    assert_eq!(bench.send(&put(Kind::Con, 6, "/test", 0))[0].code, Code::CHANGED);
    assert_eq!(bench.server.asked.len(), 6, "all of it was done");
    assert_eq!(bench.wait_ms(300_000), []);
}
