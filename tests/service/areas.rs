//! Commands about the areas of a hall from senders who err or mean ill. The hall of these tests has no areas, so every
//! name is unknown.

use crate::coap::client::Coap;
use crate::program::Program;

#[test]
fn over_http_and_coap_a_wrong_order_is_refused_and_changes_nothing() {
    let program =
        Program::with(&["serve", "--hall", "empty-8x8", "--http", "127.0.0.1:0", "--coap", "127.0.0.1:0", "--mqtt", "none"]);
    let mut coap = Coap::at(program.coap());
    let names = |count: usize| {
        let names: Vec<String> = (0..count).map(|n| format!("\"{n}\"")).collect();
        format!("{{\"areas\":[{}]}}", names.join(","))
    };
    let bodies = [
        ("orderAreas", names(1), 404, "4.04"),
        ("orderAreas", names(64), 404, "4.04"),
        ("orderAreas", names(65), 422, "4.22"),
        ("orderAreas", names(10_000), 413, "4.13"),
        ("orderAreas", r#"{"areas":["a\u001b[2J"]}"#.to_owned(), 422, "4.22"),
        ("orderAreas", r#"{"areas":["gate","gate"]}"#.to_owned(), 422, "4.22"),
        ("orderAreas", r#"{"areas":7}"#.to_owned(), 422, "4.22"),
        ("orderAreas", r#"[["gate"]]"#.to_owned(), 422, "4.22"),
        ("closeArea", r#"{"area":"gate"}"#.to_owned(), 422, "4.22"),
        ("closeArea", r#"{"area":"gate\u0000","name":"Rossi"}"#.to_owned(), 422, "4.22"),
        ("closeArea", r#"{"area":"gate","name":"Rossi","mission":9}"#.to_owned(), 409, "4.09"),
        ("searchAgain", r#"{"area":"gate","x":1}"#.to_owned(), 422, "4.22"),
    ];
    program.command("start").accepted();
    program.command("stop").accepted();
    let before = program.json("state")["mission"].clone();
    for (command, body, status, code) in &bodies {
        let detail = program.post(&format!("/api/v1/commands/{command}"), body).problem(*status);
        assert!(detail.len() < 300 && !detail.contains('\u{1b}'), "{body}: {detail}");
        // A large body takes blocks over CoAP, which this client does not send.
        if body.len() < 1000 {
            let reply = coap.ask("POST", &format!("commands/{command}"), body).expect("an answer");
            assert_eq!(&reply.code, code, "{body}: {reply:?}");
        }
    }
    assert_eq!(program.json("state")["mission"], before);
    let unknown = program.post("/api/v1/commands/closeArea", r#"{"area":"gate 1","name":"Rossi"}"#);
    assert_eq!(unknown.json()["code"], "unknownArea");
    assert!(unknown.problem(404).contains("the hall has no area \"gate 1\""));
    // An empty list is the order of a hall without areas.
    program.post("/api/v1/commands/orderAreas", r#"{"areas":[]}"#).accepted();
    assert_eq!(coap.ask("POST", "commands/orderAreas", r#"{"areas":[]}"#).expect("an answer").code, "2.04");
}

#[test]
fn a_repeated_order_gets_the_same_answer() {
    let program = Program::serve("empty-8x8", "1");
    let headers = [("content-type", "application/json"), ("idempotency-key", "order-1")];
    let order = |body: &str| program.post_with("/api/v1/commands/orderAreas", &headers, body);
    let revision = order(r#"{"areas":[]}"#).accepted();
    program.command("start").accepted();
    assert_eq!(order(r#"{"areas":[]}"#).accepted(), revision);
    assert_eq!(order(r#"{"areas":["gate"]}"#).json()["code"], "otherContent");
    let headers = [("content-type", "application/json"), ("idempotency-key", "close-1")];
    let close = || program.post_with("/api/v1/commands/closeArea", &headers, r#"{"area":"gate","name":"Rossi"}"#).problem(404);
    assert_eq!(close(), close());
}
