//! The whole program with a virtual robot: a double of the robot's page and servers, in each of their versions.

#[path = "../../../crates/drivers/tests/virtual_robot/page.rs"]
#[expect(dead_code, reason = "no page is slow here, and no scene is told")]
mod page;
#[path = "../../../crates/drivers/tests/virtual_robot/server.rs"]
#[expect(dead_code, reason = "its page stays open")]
mod server;
mod standing;

use std::time::Duration;

use serde_json::Value;

use self::page::{Page, Scene};
use self::server::Version;
use self::standing::VirtualRobot;
use crate::kill::Folder;
use crate::program::{Deadline, Program, hallsweep};

/// A small room, in which a mission is short.
fn small_room() -> Scene {
    // Faster than usual, but not so fast that delays of a busy machine matter.
    Scene { speed: 0.25, ..Scene::empty(19.0, 15.0) }
}

const STEP_MS: &str = "267";

fn serve(robot: &VirtualRobot, kind: &str, folder: Option<&Folder>) -> Program {
    let named = format!("{kind}={}", robot.address());
    let mut arguments = vec!["serve", "--http", "127.0.0.1:0", "--robot", &named];
    if let Some(folder) = folder {
        arguments.extend(["--data", folder.text()]);
    }
    let mut command = hallsweep(&arguments);
    command.env("HALLSWEEP__ROBOT__STEP_MS", STEP_MS);
    Program::started(&mut command)
}

fn linked(state: &Value) -> bool {
    !holds(state).contains(&"robotLink")
}

fn holds(state: &Value) -> Vec<&str> {
    state["mission"]["holds"].as_array().expect("the state lists the holds").iter().filter_map(Value::as_str).collect()
}

/// Waits until the robot in the page has begun to move.
fn in_mid_step(robot: &VirtualRobot) {
    let deadline = Deadline::within(Duration::from_secs(60));
    while !robot.server().page.as_ref().is_some_and(Page::is_moving) {
        assert!(!deadline.has_passed(), "it never moved");
        std::thread::sleep(Duration::from_millis(2));
    }
    // Longer than the program needs to be told of the move.
    std::thread::sleep(Duration::from_millis(120));
}

/// The room as a text map: four columns and three rows.
const MAP: &str = "|1, 1, 1, 1, X, \n|1, 1, 1, 1, X, \n|1, 1, 1, 1, X, \n|X, X, X, X, X, \n";

fn map(program: &Program) -> String {
    program.read("/api/v1/map", &[("Accept", "text/plain")]).text().replace('r', "1")
}

/// A data folder with the stored state of a virtual robot, marked as out of date because the disk could not be
/// written.
pub(crate) fn remembered(by: &str) -> Folder {
    let robot = VirtualRobot::standing_in(small_room(), Version::First);
    let folder = Folder::new(&format!("virtual-robot-kept-{by}"));
    let program = serve(&robot, "virtual-tcp", Some(&folder));
    program.until("the link is up", linked);
    program.command("start").accepted();
    in_mid_step(&robot);
    let (file, mark) = (folder.path().join("robot-discovery.txt"), folder.path().join("robot-discovery.out-of-date"));
    let kept = std::fs::read(&file).expect("it is written before it moves");
    std::fs::create_dir(folder.path().join("robot-discovery.new")).expect("the folder is ours");
    let deadline = Deadline::within(Duration::from_secs(60));
    while !mark.exists() {
        assert!(!deadline.has_passed(), "it is not marked");
        std::thread::sleep(Duration::from_millis(20));
    }
    program.killer()();
    drop(program);
    std::fs::remove_dir(folder.path().join("robot-discovery.new")).expect("it is empty");
    std::fs::write(file, kept).expect("the folder is ours");
    folder
}

#[test]
fn both_kinds_of_virtual_robot_explore_their_room_to_the_end() {
    for (kind, version) in [("virtual-tcp", Version::First), ("virtual-ws", Version::Year2021), ("virtual-ws", Version::Year2023)]
    {
        let robot = VirtualRobot::standing_in(small_room(), version);
        let program = serve(&robot, kind, None);
        program.until("the link is up", linked);
        program.command("start").accepted();
        program.until_phase("explored");
        assert_eq!(map(&program), MAP, "{kind}");
        assert_eq!(robot.cell(), (0, 0), "{kind}");
    }
}

/// The server waits for ever for the end of an old move.
#[test]
fn a_server_that_refuses_every_move_is_a_fault_in_words_and_stop_sends_it_an_alarm() {
    let robot = VirtualRobot::standing_in(small_room(), Version::Year2023);
    (robot.server().running, robot.server().is_stuck) = (Some("moveForward"), true);
    let program = serve(&robot, "virtual-ws", None);
    program.until("the link is up", linked);
    program.command("start").accepted();
    let state = program.until_phase("fault");
    assert!(state["mission"]["fault"].to_string().contains("another move is still under way"), "{:#}", state["mission"]);
    robot.server().heard.clear();
    program.command("stop").accepted();
    let deadline = Deadline::within(Duration::from_secs(10));
    while !robot.server().heard.iter().any(|(_, said)| said.contains("alarm")) {
        assert!(!deadline.has_passed(), "{:?}", robot.server().heard);
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Console and report must say it, because the driver trusts its own counting of steps.
#[test]
fn console_and_report_say_that_a_map_was_made_without_a_scene_file_and_with_one_they_do_not() {
    let scene = small_room();
    let folder = Folder::new("reckoned");
    let file = folder.path().join("scene.js");
    std::fs::write(&file, scene_file(&scene)).expect("the folder can be written");
    for with_scene in [false, true] {
        let robot = VirtualRobot::standing_in(scene.clone(), Version::First);
        let named = format!("virtual-tcp={}", robot.address());
        let data = Folder::new("reckoned-data");
        let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--robot", &named, "--data", data.text()]);
        command.env("HALLSWEEP__ROBOT__STEP_MS", STEP_MS);
        if with_scene {
            command.env("HALLSWEEP__ROBOT__SCENE", &file);
        }
        let program = Program::started(&mut command);
        program.until("the link is up", linked);
        program.command("start").accepted();
        program.until_phase("explored");
        for (language, shown, reported) in [
            ("en", "may be one cell away from where the map shows them", "may be a cell beside where they are shown"),
            ("it", "a una cella da dove li mostra la mappa", "una cella accanto a dove sono mostrati"),
        ] {
            for (path, said) in [("/", shown), (&*format!("/missions/1/report?language={language}"), reported)] {
                let page = program.read(path, &[("Accept-Language", language)]).text();
                assert_eq!(page.contains(said), !with_scene, "{path} in {language}, with the scene file: {with_scene}");
            }
        }
    }
}

#[test]
fn a_stop_halts_it_in_mid_step_and_what_was_cut_short_is_gone_back_from() {
    let robot = VirtualRobot::standing_in(small_room(), Version::First);
    let program = serve(&robot, "virtual-tcp", None);
    program.until("the link is up", linked);
    for _ in 0..5 {
        program.command("start").accepted();
        program.until("it moves", |state| state["robot"]["state"] == "movingForward");
        program.command("stop").accepted();
        program.until("it stands", |state| state["robot"]["state"] == "stopped" && state["robot"]["halting"] == false);
        let stands = robot.server().page.as_ref().map(|page| page.at);
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(robot.server().page.as_ref().map(|page| page.at), stands, "after a STOP it stands");
    }
    program.command("start").accepted();
    program.until_phase("explored");
    assert_eq!(map(&program), MAP);
}

#[test]
fn a_cut_cable_a_dead_server_and_a_killed_program_hold_the_mission_and_start_goes_on() {
    let robot = VirtualRobot::standing_in(small_room(), Version::First);
    let folder = Folder::new("virtual-robot");
    let program = serve(&robot, "virtual-tcp", Some(&folder));
    program.until("the link is up", linked);
    program.command("start").accepted();
    in_mid_step(&robot);
    robot.cut();
    let state = program.until("the mission is held", |state| holds(state).contains(&"awaitingStart"));
    assert_ne!(state["mission"]["phase"], "fault", "{state:#}");
    program.until("the link is up again", linked);
    program.command("start").accepted();
    in_mid_step(&robot);
    robot.server().receive(b";{\"type\":\"moveFor");
    program.until("the mission is held", |state| holds(state).contains(&"robotLink"));
    robot.server().restart();
    program.until("the link is up again", linked);
    program.command("start").accepted();
    in_mid_step(&robot);
    program.killer()();
    drop(program);
    let program = serve(&robot, "virtual-tcp", Some(&folder));
    let state = program.until("the link is up", linked);
    assert!(holds(&state).contains(&"restart"), "nothing moves by itself: {state:#}");
    program.command("start").accepted();
    let ended = |state: &Value| ["explored", "fault"].iter().any(|phase| state["mission"]["phase"] == *phase);
    let state = program.until("the mission ends", ended);
    assert_eq!((&state["mission"]["phase"], map(&program).as_str()), (&"explored".into(), MAP), "{:#}", state["mission"]);
}

/// A robot without a camera is shown a drawing in place of a photo.
#[test]
fn a_bag_is_shown_by_a_drawing_and_the_verdict_is_obeyed() {
    let mut scene = small_room();
    scene.put_in_cell("suitcase", 2, 1);
    let robot = VirtualRobot::standing_in(scene, Version::Year2022);
    let program = serve(&robot, "virtual-ws", None);
    program.until("the link is up", linked);
    program.command("start").accepted();
    let luggage = program.until_asked();
    let photo = program.read(&format!("/api/v1/luggage/{luggage}/photo"), &[]);
    assert_eq!((photo.status, photo.header("content-type")), (200, "image/png"));
    program.verdict(luggage, "danger").accepted();
    program.until_phase("bombLocated");
    assert_eq!(robot.cell(), (0, 0));
}

/// The room of the double as a scene file, with walls all around.
fn scene_file(scene: &Scene) -> String {
    let (width, height) = scene.floor;
    let (x, y) = (scene.player.0 / width + 0.5, scene.player.1 / height + 0.5);
    format!(
        "const config = {{ floor: {{ size: {{ x: {width}, y: {height} }} }}, player: {{ position: {{ x: {x}, y: {y} }}, speed: {} }}, sonars: [],
        movingObstacles: [], staticObstacles: [
            {{ name: \"wallUp\", centerPosition: {{ x: .5, y: .99 }}, size: {{ x: 1, y: .01 }} }},
            {{ name: \"wallDown\", centerPosition: {{ x: .5, y: .01 }}, size: {{ x: 1, y: .01 }} }},
            {{ name: \"wallLeft\", centerPosition: {{ x: .01, y: .5 }}, size: {{ x: .01, y: 1 }} }},
            {{ name: \"wallRight\", centerPosition: {{ x: .99, y: .5 }}, size: {{ x: .01, y: 1 }} }},
        ] }};\nexport default config;\n",
        scene.speed
    )
}

/// The page draws half as many frames as the scene file assumes, so that without a measurement each step would be
/// half a cell.
#[test]
fn with_the_scene_file_the_first_motion_measures_how_long_a_cell_takes() {
    let scene = small_room();
    let folder = Folder::new("scene");
    let file = folder.path().join("scene.js");
    std::fs::write(&file, scene_file(&scene)).expect("the folder can be written");
    let robot = VirtualRobot::standing_in(scene, Version::First);
    robot.server().page.as_mut().expect("a page is open").draw(Box::new(|| Duration::from_millis(33)));
    let named = format!("virtual-tcp={}", robot.address());
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--robot", &named]);
    let program = Program::started(command.env("HALLSWEEP__ROBOT__SCENE", &file));
    program.until("the link is up", linked);
    program.command("start").accepted();
    program.until_phase("explored");
    assert_eq!(map(&program), MAP);
}

#[test]
fn a_scene_file_that_cannot_be_read_is_refused() {
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--robot", "virtual-tcp"]);
    let missing = command.env("HALLSWEEP__ROBOT__SCENE", "/dev/null/scene.js").output().expect("the program starts");
    let said = String::from_utf8_lossy(&missing.stderr).into_owned();
    assert!(said.contains("of discovery cannot be used") && missing.status.code() == Some(2), "{said}");
}
