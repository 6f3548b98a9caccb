//! TD_COAP_CORE_14 and 18 to 23: queries, locations, Accept, ETag and conditions.

use coap_endpoint::{Code, Method};

use crate::rig::bench::Bench;
use crate::rig::message::{Message, option};

#[test]
fn td_coap_core_14_several_uri_query_options() {
    let mut bench = Bench::new();
    let request = Message::get("/query?first=1&second=2", 1).token(b"q");
    assert_eq!(request.values(option::URI_QUERY).len(), 2);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!((answer.text().as_str(), answer.value(option::CONTENT_FORMAT)), ("first=1&second=2", Some(0)));
}

#[test]
fn td_coap_core_18_several_location_path_options() {
    let request = Message::con(Method::Post, 1).token(b"q").path("/test").payload("new");
    let answer = Bench::new().ask(&request);
    answer.answers(&request, Code::CREATED);
    assert_eq!(answer.texts(option::LOCATION_PATH), ["location1", "location2", "location3"]);
}

#[test]
fn td_coap_core_19_several_location_query_options() {
    let request = Message::con(Method::Post, 1).token(b"q").path("/location-query").payload("new");
    let answer = Bench::new().ask(&request);
    answer.answers(&request, Code::CREATED);
    assert_eq!(answer.texts(option::LOCATION_QUERY), ["first=1", "second=2"]);
}

#[test]
fn td_coap_core_20_accept() {
    let mut bench = Bench::new();
    for (id, format, text) in [(1, 0, "plain"), (2, 41, "<xml/>")] {
        let request = Message::get("/multi-format", id).token(b"a").accept(format);
        let answer = bench.ask(&request);
        answer.answers(&request, Code::CONTENT);
        assert_eq!((answer.value(option::CONTENT_FORMAT), answer.text().as_str()), (Some(u32::from(format)), text));
    }
    let request = Message::get("/multi-format", 3).accept(60);
    bench.ask(&request).answers(&request, Code::NOT_ACCEPTABLE);
}

#[test]
fn td_coap_core_21_etag_validation() {
    let mut bench = Bench::new();
    let first = bench.ask(&Message::get("/validate", 1).token(b"1"));
    let tag = first.values(option::ETAG)[0].to_vec();
    assert!((1..=8).contains(&tag.len()));
    let request = Message::get("/validate", 2).token(b"2").with(option::ETAG, &tag);
    let valid = bench.ask(&request);
    valid.answers(&request, Code::VALID);
    assert_eq!((valid.payload.len(), valid.values(option::ETAG)), (0, vec![tag.as_slice()]));
    assert_eq!(valid.value(option::CONTENT_FORMAT), None, "nothing is said of a body that is not there");
    let several = Message::get("/validate", 3).with(option::ETAG, b"other").with(option::ETAG, &tag);
    bench.ask(&several).answers(&several, Code::VALID);
    bench.change(|server| server.set("/validate", "other"));
    let request = Message::get("/validate", 4).token(b"3").with(option::ETAG, &tag);
    let other = bench.ask(&request);
    other.answers(&request, Code::CONTENT);
    assert_eq!(other.text(), "other");
    assert_ne!(other.values(option::ETAG)[0], tag);
}

#[test]
fn td_coap_core_22_if_match() {
    let mut bench = Bench::new();
    let tag = bench.ask(&Message::get("/validate", 1)).values(option::ETAG)[0].to_vec();
    let put = |id, tag: &[u8]| Message::con(Method::Put, id).path("/validate").with(option::IF_MATCH, tag).payload("mine");
    bench.ask(&put(2, &tag)).answers(&put(2, &tag), Code::CHANGED);
    let new_tag = bench.ask(&Message::get("/validate", 3)).values(option::ETAG)[0].to_vec();
    assert_ne!(new_tag, tag);
    bench.ask(&put(4, &tag)).answers(&put(4, &tag), Code::PRECONDITION_FAILED);
    bench.ask(&put(5, b"")).answers(&put(5, b""), Code::CHANGED);
    let missing = Message::con(Method::Put, 6).path("/create1").with(option::IF_MATCH, b"").payload("mine");
    bench.ask(&missing).answers(&missing, Code::PRECONDITION_FAILED);
}

#[test]
fn td_coap_core_23_if_none_match() {
    let mut bench = Bench::new();
    let put = |id| Message::con(Method::Put, id).path("/create1").with(option::IF_NONE_MATCH, b"").payload("first");
    bench.ask(&put(1)).answers(&put(1), Code::CREATED);
    bench.ask(&put(2)).answers(&put(2), Code::PRECONDITION_FAILED);
    assert_eq!(bench.ask(&Message::get("/create1", 3)).text(), "first");
}
