//! Malformed, unknown and cross-origin requests are refused with a reason and do no harm.

use std::io::{Read, Write};
use std::net::TcpStream;

use crate::program::Program;

#[test]
fn bodies_that_are_no_command_are_refused_in_words() {
    let program = Program::serve("empty-8x8", "max");
    let cases = [
        ("POST", "commands/move", "", 400),
        ("POST", "commands/move", "{\"move\":", 400),
        ("POST", "commands/move", "{\"move\":\"q\"}", 422),
        ("POST", "commands/move", "{\"move\":1}", 422),
        ("POST", "commands/move", "{}", 422),
        ("POST", "commands/move", "{\"move\":\"w\",\"speed\":9}", 422),
        ("POST", "commands/goto", "{\"x\":1}", 422),
        ("POST", "commands/goto", "{\"x\":1.5,\"y\":0}", 422),
        ("POST", "commands/goto", "{\"x\":99999999999,\"y\":0}", 422),
        ("POST", "commands/start", "{\"epoch\":-1}", 422),
        ("POST", "commands/start", "[", 400),
        ("POST", "commands/move", "[\"w\"]", 422),
        ("POST", "luggage/1/verdict", "[\"safe\"]", 422),
        ("POST", "luggage/1/verdict", "{\"verdict\":\"perhaps\"}", 422),
        ("PUT", "temperature", "{}", 422),
        ("PUT", "temperature", "{\"celsius\":\"hot\"}", 422),
        ("PUT", "temperature", "{\"celsius\":1e9}", 422),
        ("PUT", "temperature", "{\"celsius\":1e300}", 422),
        ("PUT", "temperature", "{\"status\":\"warm\"}", 422),
        ("PUT", "temperature", "{\"celsius\":20,\"status\":\"ok\"}", 422),
        ("PUT", "strategy", "{\"name\":\"zigzag\"}", 422),
    ];
    for (method, path, body, status) in cases {
        let answer = program.send(method, &format!("/api/v1/{path}"), "application/json", body);
        assert_eq!(answer.status, status, "{method} {path} {body}: {}", answer.text());
        let detail = answer.problem(status);
        let jargon = ["struct", "i64", "f64", "u64", "expected", "invalid type"];
        assert!(jargon.iter().all(|word| !detail.contains(word)) && detail.len() < 200, "{body}: {detail}");
    }
    assert_eq!(program.json("state")["mission"]["phase"], "idle", "none of it did anything");
}

#[test]
fn a_body_of_another_type_or_of_any_size_is_refused() {
    let program = Program::serve("empty-8x8", "max");
    program.send("POST", "/api/v1/commands/move", "text/plain", "{\"move\":\"w\"}").problem(415);
    let large = format!("{{\"move\":\"{}\"}}", "w".repeat(20_000));
    program.send("POST", "/api/v1/commands/move", "application/json", &large).problem(413);
    assert_eq!(program.json("state")["mission"]["phase"], "idle");
}

#[test]
fn a_body_without_end_harms_nobody() {
    let program = Program::serve("empty-8x8", "max");
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    let head = "POST /api/v1/commands/move HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 9000000000\r\n\r\n";
    stream.write_all(head.as_bytes()).expect("the program listens");
    // The declared length alone is refused, before any of the body has arrived.
    stream.set_read_timeout(Some(crate::program::PATIENCE)).expect("a time-out can be set");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer at once");
    assert_eq!(&answer, b"HTTP/1.1 413");
    // The program closes the connection in the middle of the body, as it should.
    let refused = (0..1000).any(|_| stream.write_all(&[b'w'; 100_000]).is_err());
    assert!(refused, "a hundred megabytes were taken for a command");
    assert_eq!(program.read("/healthz", &[]).status, 200);
}

#[test]
fn stop_is_taken_whatever_comes_with_it() {
    let program = Program::serve("empty-8x8", "max");
    for (content_type, body) in [("application/json", "{"), ("text/plain", "stop!"), ("application/json", "{\"epoch\":0}")] {
        program.send("POST", "/api/v1/commands/stop", content_type, body).accepted();
    }
}

#[test]
fn what_is_not_there_is_said_to_be_so() {
    let program = Program::serve("empty-8x8", "max");
    for path in ["/api/v1/nothing", "/api/v1/luggage/1", "/api/v1/luggage/one", "/api/v1/luggage/1/photo", "/no/such/page"] {
        program.read(path, &[]).problem(404);
    }
    assert_eq!(program.command("dance").status, 404);
    assert_eq!(program.press("/api/v1/state").status, 405);
    assert_eq!(program.read("/api/v1/commands/start", &[]).status, 405, "a look changes nothing");
    program.read("/api/v1/map", &[("accept", "image/gif")]).problem(406);
}

#[test]
fn a_page_of_another_origin_presses_no_buttons() {
    let program = Program::serve("empty-8x8", "max");
    let agent = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).build();
    let agent = ureq::Agent::from(agent);
    let url = format!("http://{}/api/v1/commands/start", program.address());
    let answer = agent.post(&url).header("origin", "http://elsewhere.example").send_empty().expect("an answer");
    assert_eq!(answer.status(), 403);
    assert_eq!(program.json("state")["mission"]["phase"], "idle");
}

/// Status code of the answer to these bytes.
fn status(program: &Program, request: &str) -> String {
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.set_read_timeout(Some(crate::program::PATIENCE)).expect("a time-out can be set");
    stream.write_all(request.as_bytes()).expect("the program listens");
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).expect("an answer");
    String::from_utf8_lossy(&answer[9..]).into_owned()
}

#[test]
fn a_page_that_made_its_own_name_point_here_is_refused() {
    let program = Program::serve("empty-8x8", "max");
    let asked = |host: &str| status(&program, &format!("GET /api/v1/state HTTP/1.1\r\nHost: {host}\r\n\r\n"));
    for own in ["localhost", "127.0.0.1:8080", "[::1]:80", "127.0.0.1"] {
        assert_eq!(asked(own), "200", "{own}");
    }
    for foreign in ["rebound.example", "rebound.example:8080", "192.168.0.1", "localhost.example"] {
        assert_eq!(asked(foreign), "421", "{foreign}");
    }
    let stop = "POST /api/v1/commands/start HTTP/1.1\r\nHost: rebound.example\r\nContent-Length: 0\r\n\r\n";
    assert_eq!(status(&program, stop), "421");
    assert_eq!(program.json("state")["mission"]["phase"], "idle");
}

#[test]
fn enormous_headers_are_refused_and_harm_nobody() {
    let program = Program::serve("empty-8x8", "max");
    let many: String = (0..200).map(|n| format!("X-{n}: y\r\n")).collect();
    assert_eq!(status(&program, &format!("GET / HTTP/1.1\r\nHost: localhost\r\n{many}\r\n")), "431");
    assert_eq!(program.read("/healthz", &[]).status, 200);
}

#[test]
fn a_browser_that_went_astray_sees_a_page() {
    let program = Program::serve("empty-8x8", "max");
    let answer = program.read("/no/such/page", &[("accept", "text/html,*/*;q=0.8")]);
    assert_eq!((answer.status, answer.header("content-type")), (404, "text/html; charset=utf-8"));
    assert!(answer.text().contains("To the console"));
}
