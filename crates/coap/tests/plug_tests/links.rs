//! TD_COAP_LINK_01 to 09: `/.well-known/core` and its filters, over the wire.

use coap_endpoint::Code;

use crate::rig::bench::Bench;
use crate::rig::message::{Message, option};

fn list(path: &str) -> String {
    let request = Message::get(path, 1).token(b"l");
    let answer = Bench::new().ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!(answer.value(option::CONTENT_FORMAT), Some(40), "application/link-format");
    answer.text()
}

fn paths(list: &str) -> Vec<&str> {
    list.split('<').skip(1).map(|link| link.split('>').next().unwrap()).collect()
}

#[track_caller]
fn check(query: &str, expect: &[&str]) {
    let list = list(&format!("/.well-known/core?{query}"));
    assert_eq!(paths(&list), expect, "{list}");
}

#[test]
fn td_coap_link_01_whole_list() {
    let list = list("/.well-known/core");
    let all = ["/test", "/query", "/separate", "/create1", "/large", "/large-update", "/obs"];
    let types = ["/link1", "/link2", "/link3", "/path"];
    assert_eq!(paths(&list), [&all[..], &types].concat());
    assert!(list.contains("</link1>;rt=\"Type1 Type2\";if=\"If1\"") && list.contains("</obs>;obs"), "{list}");
}

#[test]
fn td_coap_link_02_one_resource_type() {
    check("rt=Type1", &["/link1", "/link3"]);
}

#[test]
fn td_coap_link_03_any_resource_type() {
    check("rt=*", &["/link1", "/link2", "/link3"]);
}

#[test]
fn td_coap_link_04_one_of_several_values() {
    check("rt=Type2", &["/link1", "/link2"]);
    check("rt=Type3", &["/link2", "/link3"]);
}

#[test]
fn td_coap_link_05_interface_by_its_beginning() {
    check("if=If*", &["/link1", "/link2"]);
}

#[test]
fn td_coap_link_06_any_size() {
    check("sz=*", &["/large", "/large-update"]);
}

#[test]
fn td_coap_link_07_one_path() {
    check("href=/link1", &["/link1"]);
}

#[test]
fn td_coap_link_08_path_by_its_beginning() {
    check("href=/link*", &["/link1", "/link2", "/link3"]);
}

#[test]
fn td_coap_link_09_hierarchy() {
    check("ct=40", &["/path"]);
    assert_eq!(paths(&list("/path")), ["/path/sub1", "/path/sub2", "/path/sub3"]);
    let request = Message::get("/path/sub1", 2);
    Bench::new().ask(&request).answers(&request, Code::CONTENT);
}
