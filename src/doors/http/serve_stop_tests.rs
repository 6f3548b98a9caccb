//! STOP over real sockets: after, before and together with faults on its connection.

use std::io::BufRead;

use tokio::sync::mpsc;

use super::*;
use crate::doors::http::hearing::AHEAD;
use crate::runtime::halt::Halter;
use crate::runtime::handle::{COMMANDS, Envelope, Handle as Loop};
use hallsweep_core::command::Accepted;
use hallsweep_core::units::{Epoch, Revision};

const ROUTES: [&str; 4] = ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"];

/// Safety S8.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_whose_sender_has_nothing_more_to_say_halts_and_is_answered() {
    let (app, address) = open_app(SLOTS).await;
    for number in 0..40 {
        let mut client = client(address, &press(ROUTES[number % 4], "Content-Length: 0\r\n", ""));
        client.shutdown(Shutdown::Write).unwrap();
        let answer = answered(&mut client);
        assert!(answer == "HTTP/1.1 200" || answer == "HTTP/1.1 303", "{number}: {answer}");
    }
    stops(&app, 40).await;
}

/// Safety S8, A6.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_whose_sender_hangs_up_at_once_halts_and_is_recorded() {
    let (app, address) = open_app(SLOTS).await;
    for number in 0..40 {
        drop(client(address, &press(ROUTES[number % 4], "Content-Length: 0\r\n", "")));
    }
    stops(&app, 40).await;
}

/// Safety S8.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn so_does_one_that_only_its_body_says_is_a_stop() {
    let (app, address) = open_app(SLOTS).await;
    let bodies = [
        ("/api/v1/commands/move", "application/json", r#"{"move":"h"}"#),
        ("/console/move", "application/x-www-form-urlencoded", "move=h"),
    ];
    for number in 0..40 {
        let (route, media, body) = bodies[number % 2];
        let headers = format!("Content-Type: {media}\r\nContent-Length: {}\r\n", body.len());
        // When the STOP is reached, the answers to earlier requests cannot be sent any more.
        let before = LOOK.repeat(number % 3);
        let client = client(address, &(before + &press(route, &headers, body)));
        if number % 4 < 2 {
            client.shutdown(Shutdown::Write).unwrap();
        }
    }
    stops(&app, 40).await;
}

/// Safety S8: if the request reaches its handler, it gets the answer to a STOP.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_move_that_says_stop_halts_whatever_is_wrong_with_it() {
    let (app, address) = open_app(SLOTS).await;
    const JSON: &str = "Content-Type: application/json\r\n";
    let cases = [
        ("/api/v1/commands/move", JSON, r#"{"move":"h","zz":1}"#, "200"),
        ("/api/v1/commands/move", "", r#"{"move":"h"}"#, "200"),
        ("/api/v1/commands/move", "Content-Type: application/json; charset=utf-16\r\n", r#"{"move":"h"}"#, "200"),
        ("/api/v1/commands/move", "Content-Type: application/x-www-form-urlencoded\r\n", "move=h", "200"),
        ("/api/v1/commands/move", "Idempotency-Key: a b\r\n", r#"{"move":"STOP"}"#, "200"),
        ("/api/v1/commands/move/", JSON, r#"{"move":"h"}"#, "404"),
        ("/console/move", JSON, r#"{"move":"h"}"#, "303"),
        ("/console/move", "", "move=H&move=w", "303"),
        ("/console/MOVE", "", "move=h", "404"),
    ];
    for (number, (route, headers, body, status)) in cases.into_iter().enumerate() {
        let length = format!("{headers}Content-Length: {}\r\n", body.len());
        let mut client = client(address, &press(route, &length, body));
        assert_eq!(answered(&mut client), format!("HTTP/1.1 {status}"), "{route} {headers} {body}");
        stops(&app, number + 1).await;
    }
    let put = press(cases[0].0, "Connection: close\r\nContent-Length: 12\r\n", r#"{"move":"h"}"#).replace("POST", "PUT");
    let refused = std::io::read_to_string(client(address, &put)).expect("an answer in order");
    assert!(refused.starts_with("HTTP/1.1 405"), "{refused}");
    stops(&app, cases.len() + 1).await;
    assert_eq!(answered(&mut client(address, &press(cases[0].0, JSON, ""))), "HTTP/1.1 400", "another move is as it was");
    stops(&app, cases.len() + 1).await;
}

/// Safety S8: a STOP is stored for the handler of its request. If the request is answered without a handler, the STOP
/// is forgotten.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn hundreds_of_stops_that_were_refused_make_no_stop_behind_them_two() {
    let (app, address) = open_app(SLOTS).await;
    let mut client = std::io::BufReader::new(client(address, ""));
    for number in 0..=300 {
        let (route, status) = if number < 300 { ("/stop", "404") } else { ("/h", "200") };
        client.get_mut().write_all(press(route, "Content-Length: 0\r\n", "").as_bytes()).unwrap();
        let (mut lines, mut length) = (Vec::new(), 0);
        while lines.last().is_none_or(|line: &String| line != "\r\n") {
            let mut line = String::new();
            assert!(client.read_line(&mut line).unwrap() > 0, "{number}: {lines:?}");
            length = line
                .to_ascii_lowercase()
                .strip_prefix("content-length: ")
                .map_or(length, |length| length.trim().parse().unwrap());
            lines.push(line);
        }
        assert!(lines[0].starts_with(&format!("HTTP/1.1 {status}")), "{number}: {lines:?}");
        client.read_exact(&mut vec![0; length]).unwrap();
    }
    stops(&app, 301).await;
}

/// Safety S8, A6: the refusal says that the STOP has halted the robot.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_refusal_of_a_request_in_which_a_stop_was_heard_says_so() {
    let (app, address) = open_app(SLOTS).await;
    for (number, (request, status)) in
        [("PUT /h", "405"), ("POST /h/", "404"), ("POST /stop", "404"), ("POST /api/v1/commands/h", "404"), ("POST /h;x", "404")]
            .into_iter()
            .enumerate()
    {
        let asked = format!("{request} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        let refused = std::io::read_to_string(client(address, &asked)).expect("an answer in order");
        assert!(refused.starts_with(&format!("HTTP/1.1 {status}")) && refused.contains("has halted the robot"), "{refused}");
        stops(&app, number + 1).await;
    }
    assert!(app.noted.lock().unwrap().is_empty(), "it is on record as the STOP that it is, and not refused beside that");
    let tab = "POST /\th HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    assert_eq!(answered(&mut client(address, tab)), "HTTP/1.1 400", "a raw tab ends the path");
    stops(&app, 5).await;
}

/// Safety S8.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_halts_behind_whatever_is_not_answered_yet() {
    let (app, address) = open_app(SLOTS).await;
    let stop = press("/h", "", "");
    let upgrade = "GET /mqtt HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\r\n";
    let mut open = Vec::new();
    for (number, before) in [LOOK.repeat(20), WATCH.to_owned(), stop.repeat(3), upgrade.to_owned()].iter().enumerate() {
        open.push(client(address, &format!("{before}{stop}")));
        stops(&app, [1, 2, 6, 7][number]).await;
    }
    assert_eq!(answered(&mut open[1]), "HTTP/1.1 200", "and the stream goes on");
}

/// Safety S8: nobody reads the answers, and most requests before the STOP are never answered.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_halts_behind_more_than_is_ever_answered() {
    let (app, address) = open_app(SLOTS).await;
    let upgrade = "GET /mqtt HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\r\n";
    let body = format!("Content-Length: 1000000\r\n\r\n{}", "x".repeat(1_000_000));
    let goto = |rest: &str| format!("POST /console/goto HTTP/1.1\r\nHost: localhost\r\n{rest}");
    let chunks = format!("Transfer-Encoding: chunked\r\n\r\n{}0\r\n\r\n", "5\r\nabcde\r\n".repeat(50_000));
    let stop = press("/h", "", "");
    let mut open = Vec::new();
    let packed = goto("Content-Encoding: gzip\r\nContent-Length: 5\r\n\r\n\x1f\x08abc");
    let before = [packed, LOOK.repeat(100_000), LOOK.repeat(5_000), upgrade.to_owned(), goto(&body), goto(&chunks)];
    for (number, before) in before.iter().enumerate() {
        let mut client = client(address, WATCH);
        client.set_write_timeout(Some(Duration::from_secs(30))).unwrap();
        client.write_all(format!("{before}{stop}").as_bytes()).expect("it is heard");
        stops(&app, 2 * number + 1).await;
        client.write_all(stop.as_bytes()).expect("it is heard");
        stops(&app, 2 * number + 2).await;
        open.push(client);
    }
    for client in &mut open {
        assert_eq!(answered(client), "HTTP/1.1 200", "and the stream goes on");
    }
}

/// Safety S8, A5: the first requests are complete; they are carried out and answered.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_comes_too_far_ahead_of_its_answers_is_heard_and_not_carried_out() {
    let mut app = app(searching());
    let (commands, mut envelopes) = mpsc::channel(COMMANDS);
    app.hall_mut().handle = Loop::new(commands, app.publish.subscribe(), Halter::new(Epoch(1)));
    let address = served(&app, SLOTS).await;
    let post = |what: &str| press(&format!("/api/v1/commands/{what}"), "", "");
    let looks = 1_000_000 / LOOK.len();
    let mut client = client(address, &[post("start"), LOOK.repeat(looks), post("reset"), post("stop")].concat());
    let halts = async {
        while app.door.hall.handle.epoch() == Epoch(1) {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    timeout(Duration::from_secs(60), halts).await.expect("it halts before anything is answered");
    let answering = tokio::spawn(async move {
        let mut given = Vec::new();
        while let Some(Envelope::Command(request, answer)) = envelopes.recv().await {
            given.push(request.command);
            let _ = answer.send(Ok(Accepted { revision: Revision(0), epoch: Epoch(2), luggage: None, is_kept_back: false }));
            if given.len() == 2 {
                break;
            }
        }
        (given, envelopes)
    });
    let answers = std::io::read_to_string(&mut client).expect("it is closed in order");
    let answered = answers.matches("HTTP/1.1 200").count() - 1;
    assert!((AHEAD / LOOK.len()..looks).contains(&answered), "{answered} of {looks}");
    assert_eq!(answers.matches("HTTP/1.1 ").count(), answered + 1);
    let (given, mut envelopes) = within("what was given", answering).await.unwrap();
    assert_eq!(given, [Command::Start, Command::Stop]);
    assert!(envelopes.try_recv().is_err(), "the reset was not carried out");
}

/// Safety S8.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_halts_before_its_body_comes() {
    let (app, address) = open_app(SLOTS).await;
    let mut open = Vec::new();
    let cases = [
        ("Content-Length: 1000000000\r\n", ""),
        ("Content-Length: 100\r\n", "{"),
        ("Content-Length: 100\r\nExpect: 100-continue\r\n", ""),
        ("Transfer-Encoding: chunked\r\n", ""),
        ("Transfer-Encoding: chunked\r\n", "5\r\nab"),
        ("Transfer-Encoding: nonsense\r\n", ""),
        ("Content-Length: 1\r\nContent-Length: 2\r\n", "x"),
    ];
    for (number, (headers, body)) in cases.into_iter().enumerate() {
        open.push(client(address, &press(ROUTES[number % 4], headers, body)));
        stops(&app, number + 1).await;
    }
    for client in &mut open {
        assert!(answered(client).starts_with("HTTP/1.1 "), "and it is answered");
    }
}

/// Safety S8: the rest of the body does not come, and the connection stays open.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_long_move_that_says_stop_halts_as_soon_as_its_word_has_come() {
    let (app, address) = open_app(SLOTS).await;
    let mut open = Vec::new();
    // The last two requests are refused because of their heads, but their bodies are still searched.
    let cases = [
        ("Content-Length: 5000\r\nExpect: 100-continue\r\n", "", "100"),
        ("Transfer-Encoding: chunked\r\nExpect: 100-continue\r\n", "1000\r\n", "100"),
        ("Transfer-Encoding: chunked\r\n", "", "400"),
        ("Content-Length: 1\r\nContent-Length: 2\r\n", "", "400"),
    ];
    let mut halted = 0;
    for (headers, chunk, status) in cases {
        for long in [1_100, 3_000] {
            let beginning = press("/api/v1/commands/move", headers, &format!(r#"{chunk}{{"note":"{}"#, "z".repeat(long)));
            let whole = client(address, &format!(r#"{beginning}","move":"h""#));
            halted += 1;
            stops(&app, halted).await;
            let mut pieces = client(address, &beginning);
            // This status shows that the bytes sent so far were read.
            assert_eq!(answered(&mut pieces), format!("HTTP/1.1 {status}"), "{headers}");
            pieces.write_all(br#"","move":"h""#).unwrap();
            halted += 1;
            stops(&app, halted).await;
            open.extend([whole, pieces]);
        }
    }
}

/// Safety S8: the word for STOP cannot be recognised before the body has ended.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_refused_move_that_says_stop_in_other_letters_halts_when_nothing_more_comes() {
    let (app, address) = open_app(SLOTS).await;
    let headers = "Content-Length: 1\r\nContent-Length: 2\r\n";
    let mut client = client(address, &press("/api/v1/commands/move", headers, &format!(r#"{{"note":"{}"#, "z".repeat(1_100))));
    assert_eq!(answered(&mut client), "HTTP/1.1 400");
    client.write_all(br#"","move":"\u0068"}"#).unwrap();
    client.shutdown(Shutdown::Write).unwrap();
    stops(&app, 1).await;
}

/// Safety S8: a head is read to its end even if hyper refuses it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_with_a_head_that_is_refused_halts() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring));
    let address = served(&app, SLOTS).await;
    let key = format!("Authorization: Bearer {}\r\n", tokens.viewer);
    let cases = [
        (format!("X: {}\r\n{key}", "x".repeat(70_000)), "431"),
        (format!("X: {}\r\n{key}", "x".repeat(700_000)), "431"),
        (format!("{}{key}", "X: y\r\n".repeat(200)), "431"),
        (format!("no header\r\n{key}"), "400"),
        (format!("\u{1}: \u{2}\r\n{key}"), "400"),
    ];
    for (number, (headers, status)) in cases.into_iter().enumerate() {
        let mut client = client(address, &press("/h", &headers, ""));
        assert_eq!(answered(&mut client), format!("HTTP/1.1 {status}"));
        stops(&app, number + 1).await;
    }
}

/// RFC 9112, section 3.2, and safety S8: a fault in naming the host does not turn our host into a foreign host. It
/// does not turn a foreign host into ours either.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_names_no_host_or_several_is_told_so_and_a_stop_that_names_no_foreign_one_halts() {
    let (app, address) = open_app(SLOTS).await;
    let mut halted = 0;
    for (version, target, hosts, status, halts) in [
        ("1.1", "", "", "400", true),
        ("1.0", "", "", "200", true),
        ("1.1", "http://localhost", "", "400", true),
        ("1.1", "", "Host: localhost\r\n", "200", true),
        ("1.1", "", "Host: localhost:\r\n", "200", true),
        ("1.0", "", "Host: [::1]:8080\r\n", "200", true),
        ("1.1", "", "Host: localhost\r\nHost: localhost\r\n", "400", true),
        ("1.0", "", "Host: localhost\r\nHost: 127.0.0.1\r\n", "400", true),
        ("1.1", "", "Host: someone@localhost\r\n", "400", true),
        ("1.1", "", "Host: localhost:80a\r\n", "400", true),
        ("1.1", "", "Host: a b\r\n", "400", false),
        ("1.1", "", "Host:\r\n", "400", false),
        ("1.1", "", "Host: localhost\r\nHost: elsewhere.example\r\n", "400", false),
        ("1.1", "http://elsewhere.example", "", "400", false),
        ("1.1", "", "Host: elsewhere.example\r\n", "421", false),
    ] {
        let ask = |method: &str, path: &str| {
            let asked = format!("{method} {target}{path} HTTP/{version}\r\n{hosts}Connection: close\r\n\r\n");
            std::io::read_to_string(client(address, &asked)).expect("an answer in order")
        };
        let answered = |answer: &str| answer.get(9..12) == Some(status) && answer.contains("x-content-type-options");
        let (looked, stopped) = (ask("GET", "/healthz"), ask("POST", "/h"));
        assert!(answered(&looked) && answered(&stopped), "{version} {target} {hosts:?}: {looked} {stopped}");
        assert_eq!(stopped.contains("has halted the robot"), halts && status == "400", "{hosts:?}: {stopped}");
        halted += usize::from(halts);
        stops(&app, halted).await;
    }
}
