//! The program ends soon and with exit code 0, even if clients are still connected.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::journal::{holds, journal, serve};
use crate::kill::Folder;
use crate::program::{Program, hallsweep};
use crate::stream::Events;

/// Longest time for an orderly end. It takes at most two seconds; an overloaded machine may need more, but the limit
/// stays below the twenty seconds that a client has for its request.
const PROMISED: Duration = Duration::from_secs(15);

fn ends(signal: &str) {
    let mut program = Program::serve("airport", "1");
    let mut streams: Vec<Events> = (0..4).map(|_| Events::open(&program, None)).collect();
    streams.iter_mut().for_each(|events| assert_eq!(events.next().name, "snapshot"));
    program.command("start").accepted();
    program.signal(signal);
    let status = program.ended_within(PROMISED).unwrap_or_else(|| panic!("it still runs {PROMISED:?} after SIG{signal}"));
    assert_eq!(status.code(), Some(0), "it ended by itself");
    assert!(streams.iter_mut().all(Events::has_ended));
}

#[test]
fn a_term_signal_ends_it_in_time_with_open_streams() {
    ends("TERM");
}

#[test]
fn an_interrupt_ends_it_in_time_with_open_streams() {
    ends("INT");
}

#[test]
fn a_terminal_that_is_closed_ends_it_in_time_with_open_streams() {
    ends("HUP");
}

/// On Linux a program can see which signals it inherited as ignored.
#[cfg(target_os = "linux")]
#[test]
fn started_by_nohup_it_outlives_its_terminal() {
    let mut command = Command::new("nohup");
    let hallsweep = hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "max"]);
    command.arg(hallsweep.get_program()).args(hallsweep.get_args()).stdin(Stdio::null());
    command.envs(hallsweep.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let mut program = Program::started(&mut command);
    program.signal("HUP");
    program.command("start").accepted();
    program.until_phase("explored");
    program.signal("TERM");
    assert!(program.ended_within(PROMISED).is_some_and(|status| status.success()));
}

#[test]
fn a_client_that_never_finishes_its_request_does_not_keep_it() {
    use std::io::Write;
    let mut program = Program::serve("empty-8x8", "1");
    let mut stuck = std::net::TcpStream::connect(program.address()).expect("the program listens");
    stuck
        .write_all(b"POST /api/v1/commands/move HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n{")
        .expect("half a request");
    assert_eq!(program.read("/healthz", &[]).status, 200, "the half request is with the program by now");
    program.signal("TERM");
    assert!(program.ended_within(PROMISED).is_some_and(|status| status.success()), "it waits for a client that never ends");
}

#[test]
fn an_mqtt_client_that_never_says_who_it_is_does_not_keep_it() {
    let mut program = Program::serve("empty-8x8", "1");
    let _stuck = std::net::TcpStream::connect(program.mqtt()).expect("the program listens");
    program.signal("TERM");
    assert!(program.ended_within(PROMISED).is_some_and(|status| status.success()));
}

/// Safety R1: the journal records the end as an end, and not as a STOP by somebody.
#[test]
fn an_end_in_the_middle_of_a_mission_is_on_record_as_an_end_and_holds_the_robot_as_a_restart() {
    for signal in ["TERM", "HUP"] {
        let ended = format!("program ended by SIG{signal}");
        let folder = Folder::new(&format!("shutdown-record-{signal}"));
        let mut program = serve(&folder);
        program.command("start").accepted();
        let before = program.until("it is on its way", |state| state["robot"]["state"] != "stopped");
        program.signal(signal);
        assert!(program.ended_within(PROMISED).is_some_and(|status| status.success()));
        let (well, printed) = journal(&folder, &["print"]);
        assert!(well && printed.contains(&ended) && !printed.contains("stopped: epoch"), "{printed}");

        let program = serve(&folder);
        let state = program.json("state");
        assert!(holds(&state, "restart") && !holds(&state, "operator"), "{state:#}");
        assert_eq!(state["mission"]["epoch"], before["mission"]["epoch"]);
        assert!(state["log"].to_string().contains(&ended), "{:#}", state["log"]);
        program.command("start").accepted();
    }
}
