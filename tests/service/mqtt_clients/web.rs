//! `/mqtt`, the WebSocket path for web clients, and its access rules. The MQTT messages are the same as over TCP.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use super::AVAILABILITY;
use super::client::Client;
use super::running::RunningClient;
use super::told::{Hello, Say};
use crate::access::{Site, sign_in};
use crate::program::Program;

/// Sends a WebSocket request with these headers, and returns the beginning of the answer, with the whole head.
fn knock(program: &Program, headers: &str) -> String {
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.set_read_timeout(Some(Duration::from_secs(30))).expect("a time-out can be set");
    let request = format!(
        "GET /mqtt HTTP/1.1\r\nHost: {}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{headers}\r\n",
        program.address()
    );
    stream.write_all(request.as_bytes()).expect("a question");
    let mut answer = vec![0; 8 * 1024];
    let mut length = 0;
    while !String::from_utf8_lossy(&answer[..length]).contains("\r\n\r\n") {
        let read = stream.read(&mut answer[length..]).expect("an answer in time");
        assert_ne!(read, 0, "it is closed without an answer");
        length += read;
    }
    String::from_utf8_lossy(&answer[..length]).into_owned()
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status")
}

#[test]
fn only_mqtt_is_spoken_there_and_not_with_pages_of_others() {
    let program = Program::serve("empty-8x8", "max");
    let plain = program.read("/mqtt", &[]);
    assert!(plain.problem(400).contains("WebSocket"), "a page cannot be looked at there");
    for other in ["", "Sec-WebSocket-Protocol: chat\r\n", "Sec-WebSocket-Protocol: mqttv3.1\r\n"] {
        assert_eq!(status(&knock(&program, other)), 400, "{other}");
    }
    let mqtt = "Sec-WebSocket-Protocol: chat, mqtt\r\n";
    let answer = knock(&program, mqtt);
    assert!(status(&answer) == 101 && answer.to_lowercase().contains("sec-websocket-protocol: mqtt\r\n"), "{answer}");
    let from = |origin: &str| status(&knock(&program, &format!("{mqtt}Origin: {origin}\r\n")));
    assert_eq!(from(&format!("http://{}", program.address())), 101);
    assert_eq!(from("https://elsewhere.example"), 403);
    assert_eq!(from("null"), 403);
}

/// Safety A2, A4.
#[test]
fn whoever_is_signed_in_to_the_console_needs_no_password() {
    if !Client::MqttJsWeb.is_here() {
        return;
    }
    let site = Site::new("mqtt-web", &["HTTP__REQUIRE_TOKEN"]);
    let program = &site.program;
    let begin = |hello| RunningClient::begin(Client::MqttJsWeb, program, hello);

    RunningClient::knock(Client::MqttJsWeb, program, Hello::speaking()).until_refused(5);
    let wrong = Hello::speaking().with_login("operator", "wrong");
    RunningClient::knock(Client::MqttJsWeb, program, wrong).until_refused(4);
    begin(Hello::speaking().with_login("operator", &site.operator)).leave();

    let lamp = Say::plain("site/lamp", "on").at(1);
    let cookies = [&site.operator, &site.viewer].map(|token| sign_in(program, token));
    let [operators, viewers] = cookies.each_ref().map(|cookie| [("cookie", cookie.as_str())]);
    let mut signed_in = begin(Hello::following(&["site/#", AVAILABILITY], 1).with_headers(&operators));
    signed_in.until_newest(AVAILABILITY, "it is served", |message| message.payload == "online");
    signed_in.say(lamp);
    signed_in.until_newest("site/lamp", "an operator's word", |message| message.payload == "on");

    let mut viewer = begin(Hello::speaking().with_headers(&viewers));
    viewer.say(Say { payload: "off", ..lamp });
    signed_in.say(Say { payload: "bright", ..lamp });
    signed_in.until_newest("site/lamp", "an operator's word", |message| message.payload == "bright");
    assert!(signed_in.heard().iter().all(|message| message.payload != "off"), "a viewer publishes nothing there");
    viewer.leave();
    signed_in.leave();
}
