//! Routes of the old console, whose clients must work unchanged.

use crate::program::Program;

#[test]
fn the_old_console_runs_a_whole_mission() {
    let program = Program::serve("airport", "max");
    program.press("/startappl").accepted();
    program.until_asked();
    program.press("/safe").accepted();
    program.until("the next piece", |state| state["luggage"].as_array().is_some_and(|all| all.len() == 2));
    program.until_asked();
    program.press("/danger").accepted();
    program.until_phase("bombLocated");
    assert!(program.press("/safe").problem(409).contains("no luggage"), "a bare word means the one piece that waits");
}

#[test]
fn the_old_buttons_stop_and_send_home_and_report_heat() {
    let program = Program::serve("empty-8x8", "4");
    program.press("/startappl").accepted();
    program.press("/stopappl").accepted();
    program.until("it stands", |state| state["robot"]["state"] == "stopped");
    program.press("/temperatureTooHigh").accepted();
    program.press("/startappl").problem(409);
    program.press("/temperatureOk").accepted();
    program.press("/startappl").accepted();
    program.press("/backhomeappl").accepted();
    program.until_phase("atHome");
}

#[test]
fn the_old_moves_drive_the_robot_and_h_halts_it() {
    let program = Program::serve("empty-8x8", "max");
    let rest = |heading: &str, y: i64| {
        program.until("it has moved", |state| {
            let robot = &state["robot"];
            robot["heading"] == heading && robot["position"]["y"] == y && state["mission"]["phase"] == "idle"
        });
    };
    for (path, heading, y) in
        [("/w", "south", 1), ("/s", "south", 0), ("/a", "east", 0), ("/d", "south", 0), ("/l", "east", 0), ("/r", "south", 0)]
    {
        program.press(path).accepted();
        rest(heading, y);
    }
    program.press("/h").accepted();
    for path in ["/z", "/x"] {
        assert_eq!(program.press(path).status, 409, "this robot has no corrective turns");
    }
}
