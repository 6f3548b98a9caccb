//! Tests of the settings of several halls, and of the lines in errors about a settings file.

use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use super::*;
use crate::config::{Flag, RobotAddress, RobotKind, Sources, load};
use hallsweep_core::speed::Speed;

const THREE: &str = r#"
[hall]
file = "north.toml"
[store]
folder = "data"
[robot]
seed = 5
[halls]
default = "north"
[halls.south]
group = "terminal-1"
[halls.south.hall]
file = "south.toml"
[halls.south.console]
evacuation_m = 200
[halls.south.robots.discovery]
speed = "max"
[halls.south.robots.porter]
kind = "sim"
[halls.south.mission]
goal = "cover"
[halls.south.temperature]
sensor = "roof"
[halls.south.pair]
slips = 1
[halls.west]
"#;

/// Settings from a file, environment variables without their prefix, and flags. In errors the file is called FILE.
fn given(text: &str, variables: &[(&str, &str)], flags: &[(&'static str, &str)]) -> Result<Settings, String> {
    static FILES: AtomicU32 = AtomicU32::new(0);
    let number = FILES.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("hallsweep-halls-{}-{number}.toml", std::process::id()));
    std::fs::write(&path, text).expect("the temporary directory can be written");
    let environment = variables.iter().map(|(name, value)| (format!("HALLSWEEP__{name}"), (*value).to_owned())).collect();
    let flags = flags.iter().map(|(flag, value)| Flag::given(flag, (*value).to_owned())).collect();
    let settings = load(&Sources { file: Some(path.clone()), environment, flags });
    std::fs::remove_file(&path).expect("the file is ours");
    settings.map_err(|error| error.to_string().replace(&path.display().to_string(), "FILE"))
}

fn written(text: &str) -> Result<Settings, String> {
    given(text, &[], &[])
}

fn refused(text: &str) -> String {
    written(text).expect_err(text)
}

fn names(settings: &Settings) -> Vec<&str> {
    settings.halls().map(|hall| hall.name.name()).collect()
}

fn hall<'a>(settings: &'a Settings, name: &str) -> &'a HallSettings {
    settings.halls().find(|hall| hall.name.name() == name).expect("there is such a hall")
}

#[test]
fn a_single_hall_is_called_main_or_as_the_settings_say() {
    let settings = written("[store]\nfolder = \"data\"\n").expect("good");
    assert_eq!(names(&settings), ["main"]);
    assert_eq!((settings.hall.group.as_ref(), settings.hall.folder.as_deref()), (None, Some(Path::new("data"))));
    assert_eq!(names(&written("[halls]\ndefault = \"north\"\n").expect("good")), ["north"]);
    let own = written("[halls.main]\ngroup = \"all\"\n").expect("its own name adds nothing but settings");
    assert_eq!((names(&own), own.hall.group.as_ref().map(HallId::name)), (vec!["main"], Some("all")));
}

#[test]
fn a_further_hall_has_its_own_settings_and_otherwise_those_of_the_top_level() {
    let settings = written(THREE).expect("good");
    assert_eq!(names(&settings), ["north", "south", "west"]);
    let [north, south, west] = ["north", "south", "west"].map(|name| hall(&settings, name));
    assert_eq!([north, south, west].map(|hall| hall.file.as_str()), ["north.toml", "south.toml", "north.toml"]);
    assert_eq!([north, south, west].map(|hall| hall.robot.seed), [5, 5, 5]);
    assert_eq!([north, south, west].map(|hall| hall.robot.speed), [Speed::Times(1.0), Speed::Max, Speed::Times(1.0)]);
    assert_eq!([north, south, west].map(|hall| hall.robots().count()), [1, 2, 1]);
    assert_eq!([north, south, west].map(|hall| hall.evacuation_m.to_string()), ["100", "200", "100"]);
    assert_eq!([north, south, west].map(|hall| hall.pair.slips), [0, 1, 0]);
    assert_eq!([north, south, west].map(|hall| hall.sensors.len()), [0, 1, 0]);
    assert_ne!(south.core.objective, north.core.objective);
    assert_eq!([north, south, west].map(|hall| hall.group.as_ref().map(HallId::name)), [None, Some("terminal-1"), None]);
    assert_eq!(south.origin, north.origin.replace("line 3", "line 13"), "an unreadable hall is named with its own line");
}

#[test]
fn the_example_on_the_page_of_settings_is_good() {
    let page = include_str!("../../docs/settings.md");
    let example = page.split("```toml\n").find(|block| block.contains("[halls]")).and_then(|block| block.split("```").next());
    let settings = written(example.expect("there is an example")).expect("good");
    assert_eq!(names(&settings), ["north", "south"]);
    assert!(settings.halls().all(|hall| hall.group.as_ref().is_some_and(|group| group.name() == "terminal-1")));
}

#[test]
fn the_data_of_a_further_hall_is_in_a_folder_within_that_of_the_default_hall() {
    let settings = written(THREE).expect("good");
    let folders: Vec<_> = settings.halls().filter_map(|hall| hall.folder.as_deref()).collect();
    assert_eq!(folders, [Path::new("data"), Path::new("data/hall-south"), Path::new("data/hall-west")]);
    let nothing = given(THREE, &[], &[("--data", "none")]).expect("good");
    assert!(nothing.halls().all(|hall| hall.folder.is_none()));
}

#[test]
fn a_value_for_one_hall_wins_over_one_for_all_halls_in_whatever_place() {
    let seeds = |text: &str, variables: &[(&str, &str)], flags: &[(&'static str, &str)]| {
        let settings = given(text, variables, flags).expect("good");
        ["north", "south"].map(|name| hall(&settings, name).robot.seed)
    };
    let text = "[robot]\nseed = 1\n[halls]\ndefault = \"north\"\n[halls.south.robot]\nseed = 2\n";
    let variable = [("HALLS__SOUTH__ROBOTS__DISCOVERY__SEED", "3"), ("ROBOT__SEED", "4")];
    assert_eq!(seeds(text, &[], &[]), [1, 2]);
    assert_eq!(seeds(text, &[], &[("--seed", "9")]), [9, 2]);
    assert_eq!(seeds(text, &variable, &[]), [4, 3]);
    assert_eq!(seeds(text, &variable, &[("--seed", "9")]), [9, 3]);
    let north = format!("{text}[halls.north.robot]\nseed = 7\n");
    assert_eq!(seeds(&north, &[], &[("--seed", "9")]), [7, 2], "the name of the default hall means it alone");
}

#[test]
fn halls_are_named_in_the_environment_too() {
    let variables = [("HALLS__DEFAULT", "north"), ("HALLS__SOUTH__HALL__FILE", "south.toml"), ("HALLS__SOUTH__GROUP", "7")];
    let wrong = given("", &variables, &[]).expect_err("no name");
    let expect = "setting halls.south.group = \"7\" (from environment variable HALLSWEEP__HALLS__SOUTH__GROUP): no group can have \
                  this name; write 1 to 32 small letters, digits and hyphens, the first a letter, such as terminal-1";
    assert_eq!(wrong, expect);
    let settings = given("", &variables[..2], &[]).expect("good");
    assert_eq!((names(&settings), hall(&settings, "south").file.as_str()), (vec!["north", "south"], "south.toml"));
    let nearly = Sources { environment: vec![("HALLSWEEP_HALLS_DEFAULT".into(), "north".into())], ..Sources::default() };
    let said = load(&nearly).expect_err("this is meant as a setting").to_string();
    assert!(said.contains("HALLSWEEP__HALLS__DEFAULT"), "{said}");
}

#[test]
fn a_further_hall_makes_the_name_of_the_default_hall_necessary() {
    assert_eq!(
        refused("[halls.south]\n"),
        "setting halls.default = \"\" (from config/default.toml): there is a further hall, south, so the other one needs a name \
         too; name the hall of the settings outside of [halls.NAME]: 1 to 32 small letters, digits and hyphens, the first a \
         letter, and not default, such as north; only with a single hall it may be empty"
    );
    assert!(refused("[halls.main]\n[halls.south]\n").contains("halls.default"));
    for wrong in ["default", "North", "3rd", "a b"] {
        let said = refused(&format!("[halls]\ndefault = \"{wrong}\"\n"));
        assert!(said.contains("(from file FILE, line 2): no hall can have this name; name the hall"), "{said}");
    }
}

#[test]
fn what_cannot_be_in_the_section_of_a_hall_is_refused_with_its_full_name_its_line_and_what_to_do() {
    let process =
        |section: &str| format!("[{section}] is for the whole program and not for a hall: set it outside of [halls.south]");
    let of_halls = "[halls] has the setting halls.default; [halls.NAME] has the setting group and the sections hall, console, \
                    robot, robots, pair, mission, temperature, and NAME has 1 to 32 small letters, digits and hyphens, the first a \
                    letter, and is not default";
    for (text, key, line, advice) in [
        ("[halls.south.http]\nbind = \"localhost:1\"\n", "halls.south.http.bind", 2, process("http")),
        ("[halls.south.store]\n", "halls.south.store", 1, process("store")),
        ("[halls.south]\nmqtt.nonsense = 1\n", "halls.south.mqtt.nonsense", 2, process("mqtt")),
        ("[halls.south.coap]\nbind = 1\n", "halls.south.coap.bind", 2, process("coap")),
        ("[halls.south]\nlog = \"info\"\n", "halls.south.log", 2, process("log")),
        ("[halls.south.old_clients]\nx = 1\n", "halls.south.old_clients.x", 2, process("old_clients")),
        ("\n[halls.South]\ngroup = \"a\"\n", "halls.South", 2, of_halls.to_owned()),
        ("[halls]\nsouth = \"south.toml\"\n", "halls.south", 2, of_halls.to_owned()),
        ("[halls.south]\nspeed = 1\n", "halls.south.speed", 2, of_halls.to_owned()),
        ("[halls.south.halls.west]\n", "halls.south.halls", 1, of_halls.to_owned()),
        (
            "[halls.south]\nhall = \"a.toml\"\n",
            "halls.south.hall",
            2,
            "in [halls.south], [hall] has the settings hall.file, hall.start, hall.exercise".to_owned(),
        ),
    ] {
        let expect = format!("there is no setting `{key}` (from file FILE, line {line}): {advice}");
        assert_eq!(refused(text), expect);
    }
    for (text, begins) in [
        (
            "[halls.south.robot]\nsped = 1\n",
            "there is no setting `halls.south.robot.sped` (from file FILE, line 2): in [halls.south], [",
        ),
        (
            "[halls.south.robots.Porter]\nkind = \"sim\"\n",
            "there is no setting `halls.south.robots.Porter` (from file FILE, line 1)",
        ),
        (
            "[halls.default]\ngroup = \"a\"\n",
            "setting halls.default = {\"group\":\"a\"} (from file FILE, line 1): it is a table; name",
        ),
        ("[[halls]]\ndefault = \"a\"\n", "there is no setting `halls` (from file FILE, line 1)"),
    ] {
        let said = refused(text);
        assert!(said.starts_with(begins), "{said}");
    }
    let said = given("", &[("HALLS__SOUTH__HTTP__BIND", "localhost:1")], &[]).expect_err("a section of the program");
    let begins =
        "there is no setting `halls.south.http.bind` (from environment variable HALLSWEEP__HALLS__SOUTH__HTTP__BIND): [http] is";
    assert!(said.starts_with(begins), "{said}");
}

#[test]
fn an_error_about_a_file_says_the_line() {
    for (text, begins) in [
        ("[robot]\n\nsped = 1\n", "there is no setting `robot.sped` (from file FILE, line 3): [robot] has"),
        ("# first\n[robott]\nseed = 1\n", "there is no setting `robott` (from file FILE, line 2): the sections are"),
        ("robot = 1\n", "there is no setting `robot` (from file FILE, line 1)"),
        ("\"robot.seed\" = 1\n", "there is no setting `\"robot.seed\"` (from file FILE, line 1)"),
        ("\"\" = 1\n", "there is no setting `\"\"` (from file FILE, line 1)"),
        ("[http]\r\nbind = 1\r\nhosts = []\r\n", "setting http.bind = 1 (from file FILE, line 2): it is a number"),
        ("robot = { seed = 1,\n speed = \"fast\" }\n", "setting robot.speed = \"fast\" (from file FILE, line 2): this word is"),
        ("[robot.seed]\nx = 1\n", "setting robot.seed = {\"x\":1} (from file FILE, line 1): it is a table"),
        ("[robots.porter]\nseed = 1\n", "setting robots.porter.kind = nothing (from file FILE, line 2): it is missing"),
        ("[robots.porter]\n", "setting robots.porter.kind = nothing (from file FILE, line 1): it is missing"),
        (
            "[robot]\nseed = 1\n[robots.discovery]\nseed = 1\n",
            "setting robots.discovery.seed = 1 (from file FILE, line 4): robot.seed means the same setting, and is set too (from \
             file FILE, line 2)",
        ),
        (
            "[halls.south.robot]\nseed = 1\n[halls.south.robots.discovery]\nseed = 1\n",
            "setting halls.south.robots.discovery.seed = 1 (from file FILE, line 4): halls.south.robot.seed means the same setting",
        ),
        (
            "[halls]\ndefault = \"north\"\n[halls.south.robots.discovery]\nspeed = \"fast\"\n",
            "setting halls.south.robots.discovery.speed = \"fast\" (from file FILE, line 4): this word is not a speed; write a factor",
        ),
        (
            "[halls]\ndefault = \"north\"\n[halls.south.robots.porter]\nseed = 1\n",
            "setting halls.south.robots.porter.kind = nothing (from file FILE, line 4): it is missing",
        ),
        (
            "[halls]\ndefault = \"north\"\n[halls.north.robots.porter]\nseed = 1\n",
            "setting halls.north.robots.porter.kind = nothing (from file FILE, line 4): it is missing",
        ),
        (
            "[halls]\ndefault = \"north\"\n[halls.south.robot]\nkind = \"line\"\n",
            "setting halls.south.robot.address = \"\" (from config/default.toml): a robot of the kind line needs an address; write",
        ),
    ] {
        let said = refused(text);
        assert!(said.starts_with(begins), "{said}");
    }
    let said = refused("[robot]\nseed = 999999999999999999999999999999999999999999\n");
    assert!(said.contains("line 2"), "{said}");
}

#[test]
fn a_value_for_all_halls_that_is_wrong_for_one_is_refused_with_this_hall() {
    let text = "[robot]\nkind = \"line\"\naddress = \"/dev/ttyUSB0\"\n[halls]\ndefault = \"north\"\n[halls.south.robot]\nkind = \"sim\"\n";
    assert_eq!(
        refused(text),
        "setting robot.address = \"/dev/ttyUSB0\" (from file FILE, line 3): for the hall south, the simulated robot is part of this \
         program and has no address; leave the address empty, or choose another kind of robot: virtual-tcp, virtual-ws or line; \
         halls.south.robot.address sets it for this hall alone"
    );
    let settings = written(&format!("{text}address = \"\"\n")).expect("good");
    assert_eq!(settings.further_halls[0].robot.address, RobotAddress::Here);
}

#[test]
fn no_two_robots_of_the_program_are_in_one_place() {
    let line = |section: &str, address: &str| format!("[{section}]\nkind = \"line\"\naddress = \"{address}\"\n");
    let north = format!("[halls]\ndefault = \"north\"\n{}", line("halls.north.robot", "localhost:8300"));
    assert_eq!(
        refused(&(north.clone() + &line("halls.south.robots.porter", "127.0.0.1:8300"))),
        "setting halls.south.robots.porter.address = \"127.0.0.1:8300\" (from file FILE, line 8): the robot discovery of the hall \
         north has this address already; give each robot an address of its own"
    );
    let said = refused(&(north.clone() + &line("halls.south.robot", "a:1") + &line("halls.south.robots.porter", "a:1")));
    assert!(said.contains("(from file FILE, line 11): the robot discovery of the hall south has this address"), "{said}");
    let good = written(&(north + &line("halls.south.robot", "localhost:8301"))).expect("two places");
    assert_eq!([&good.hall, &good.further_halls[0]].map(|hall| hall.robot.kind), [RobotKind::Line; 2]);
    let for_all = line("robot", "localhost:8300") + "[halls]\ndefault = \"north\"\n[halls.south]\n";
    let said = refused(&for_all);
    let expect = "setting robot.address = \"localhost:8300\" (from file FILE, line 3): for the hall south, the robot discovery of the \
                  hall north has this address already; give each robot an address of its own; halls.south.robot.address sets it";
    assert!(said.starts_with(expect), "{said}");
}

#[test]
fn there_are_only_so_many_halls() {
    let text = |further: usize| {
        (0..further).fold("[halls]\ndefault = \"north\"\n".to_owned(), |mut text, number| {
            writeln!(text, "[halls.h{number:03}]").expect("a string takes everything");
            text
        })
    };
    assert_eq!(written(&text(MOST_HALLS - 1)).expect("good").halls().count(), MOST_HALLS);
    let said = refused(&text(MOST_HALLS));
    assert!(
        said.contains("halls.h127") && said.contains("line 130): there are 129 halls; configure at most 128 halls"),
        "{said}"
    );
}

#[test]
fn the_quick_start_names_each_hall_after_its_file() {
    let settings = given("", &[], &[("--hall", "halls/Gate_3.toml"), ("--hall", "b.yaml"), ("--hall", "airport")]).expect("good");
    assert_eq!(names(&settings), ["gate-3", "airport", "b"]);
    let files: Vec<&str> = settings.halls().map(|hall| hall.file.as_str()).collect();
    assert_eq!(files, ["halls/Gate_3.toml", "airport", "b.yaml"]);
    assert!(settings.halls().all(|hall| hall.is_chosen && hall.origin == "flag --hall"));
    assert_eq!(names(&given("", &[], &[("--hall", "b.yaml")]).expect("good")), ["main"], "one hall stays as it was");
}

#[test]
fn a_quick_start_that_is_not_clear_is_refused() {
    let refused = |text: &str, flags: &[(&'static str, &str)]| {
        let two = [("--hall", "a.toml"), ("--hall", "b.toml")];
        given(text, &[], &[&two, flags].concat()).expect_err("this is not clear")
    };
    let advice = "; name the halls in a settings file, with [halls.NAME] for each further hall, and start with --config";
    for (flag, value, expect) in [
        ("--hall", "x/A.yaml", "setting hall.file = \"x/A.yaml\" (from flag --hall): another hall has the name a already"),
        ("--hall", "3.toml", "setting hall.file = \"3.toml\" (from flag --hall): its name has no small letter at the beginning"),
        ("--hall", "default.toml", "setting hall.file = \"default.toml\" (from flag --hall): its name"),
        (
            "--start",
            "1,1",
            "setting hall.start = \"1,1\" (from flag --start): --hall is given several times, and this flag is for",
        ),
        ("--exercise", "2", "setting hall.exercise = 2 (from flag --exercise): --hall is given several times, and this flag is"),
    ] {
        let said = refused("", &[(flag, value)]);
        assert!(said.starts_with(expect) && said.ends_with(advice), "{said}");
    }
    assert_eq!(
        refused("[halls]\ndefault = \"a\"\n", &[]),
        "setting halls.default = \"a\" (from file FILE, line 2): --hall is given several times, and names the halls too; name the \
         halls in one of the two places"
    );
}

#[test]
fn settings_without_effect_are_named_with_the_halls_in_which_they_have_none() {
    let text = "[halls]\ndefault = \"north\"\n[halls.south.robot]\nkind = \"line\"\naddress = \"a:1\"\n";
    let idle = |text: &str| {
        given(text, &[("HALLS__SOUTH__ROBOT__STEP_MS", "400")], &[("--speed", "max")]).expect("good").without_effect()
    };
    let variable = "environment variable HALLSWEEP__HALLS__SOUTH__ROBOT__STEP_MS (hall south)";
    assert_eq!(idle(text), ["flag --speed (hall south)", variable]);
    let both = format!("{text}[halls.north.robot]\nkind = \"line\"\naddress = \"a:2\"\n");
    assert_eq!(idle(&both), ["flag --speed", variable]);
}

#[test]
fn a_further_hall_never_has_the_id_of_the_default_hall_at_home_assistant() {
    let said = refused("[halls]\ndefault = \"north\"\n[halls.discovery]\n");
    assert!(said.contains("mqtt.id = \"discovery\"") && said.contains("another name"), "{said}");
    written("[halls]\ndefault = \"north\"\n[halls.discovery]\n[mqtt]\nid = \"r2\"\n").expect("good");
}
