//! The robots in the settings: the searching robot in `[robot]`, and every further robot in a section `[robots.NAME]`
//! with the same keys. `layers` handles `[robots.discovery]`, which means the searching robot. The settings take
//! effect elsewhere.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use super::error::SettingsError;
use super::key::{ROBOT, ROBOTS};
use super::layers::Layers;
use super::reading::{NumberOrWord, count, number, read, sensing, within};
use super::robot_address::{RobotKind, robot_address};
use super::{HallSettings, RobotSettings};
use hallsweep_core::pair::Which;
use hallsweep_core::robot::RobotId;
use hallsweep_core::search::Sensing;
use hallsweep_core::speed::Speed;

/// Maximum number of robots, including the searching robot. All links share one thread, on which a STOP reaches each
/// robot before anything else (safety S7). For each simulated robot a photo may have to be drawn at any moment.
pub const MOST_ROBOTS: usize = 8;

impl HallSettings {
    /// All robots, the searching one first.
    pub fn robots(&self) -> impl Iterator<Item = (RobotId, &RobotSettings)> {
        let further = self.further_robots.iter().map(|(robot, settings)| (robot.clone(), settings));
        std::iter::once((RobotId::discovery(), &self.robot)).chain(further)
    }
}

pub(super) fn further(layers: &Layers) -> Result<Vec<(RobotId, RobotSettings)>, SettingsError> {
    let names = layers.further_robots();
    let count = names.len() + 1;
    if count > MOST_ROBOTS {
        let advice = format!("add at most {} robots to {}", MOST_ROBOTS - 1, RobotId::discovery());
        let last = names.last().unwrap_or_default();
        return Err(layers.wrong_with_advice(&format!("{ROBOTS}.{last}.kind"), format!("there are {count} robots"), &advice));
    }
    let one = |name: &str| {
        let robot = RobotId::new(name).expect("an invalid name was refused when the layers were read");
        if Which::ALL.into_iter().any(|which| which.robot() == robot) {
            let key = format!("{ROBOTS}.{name}.kind");
            return Err(layers.wrong_with_advice(&key, "a robot of the fetching pair has this name", "give it another name"));
        }
        Ok((robot, self::robot(layers, &format!("{ROBOTS}.{name}"))?))
    };
    names.map(one).collect()
}

/// Refuses two robots of the program with the same address or the same page, because they would disturb each other.
pub(super) fn check_apart(halls: &[(Layers, HallSettings)]) -> Result<(), SettingsError> {
    let mut taken: BTreeMap<String, String> = BTreeMap::new();
    for (layers, hall) in halls {
        for (robot, settings) in hall.robots() {
            let Some(place) = settings.address.place() else { continue };
            let section = if robot == RobotId::discovery() { ROBOT.to_owned() } else { format!("{ROBOTS}.{robot}") };
            let name = if halls.len() == 1 { robot.to_string() } else { format!("{robot} of the hall {}", hall.name) };
            if let Some(first) = taken.insert(place, name) {
                let problem = format!("the robot {first} has this address already");
                return Err(layers.wrong_with_advice(
                    &format!("{section}.address"),
                    problem,
                    "give each robot an address of its own",
                ));
            }
        }
    }
    Ok(())
}

pub(super) fn robot(layers: &Layers, section: &str) -> Result<RobotSettings, SettingsError> {
    let key = |own: &str| format!("{section}.{own}");
    let kind = kind(layers, &key("kind"))?;
    Ok(RobotSettings {
        kind,
        address: robot_address(layers, &key("address"), kind)?,
        baud: count(layers, &key("baud"))?,
        step: Duration::from_millis(count(layers, &key("step_ms"))?.into()),
        scene: Some(read::<String>(layers, &key("scene"))?).filter(|path| !path.is_empty()).map(PathBuf::from),
        speed: speed(layers, &key("speed"))?,
        seed: read(layers, &key("seed"))?,
        unknown_rate: number(layers, &key("unknown_rate"))?,
        camera_misses: read(layers, &key("camera_misses"))?,
        photo_failure_rate: number(layers, &key("photo_failure_rate"))?,
        sonar_noise_cm: number(layers, &key("sonar_noise_cm"))?,
        sonar_cells: sonar_cells(layers, section)?,
    })
}

/// Number of cells that the sonar of this robot should see ahead. It is 0 if the robot cannot have a sonar, or if the
/// search does not use one.
pub(super) fn sonar_cells(layers: &Layers, section: &str) -> Result<u8, SettingsError> {
    let key = format!("{section}.sonar_cells");
    let cells = u8::try_from(count(layers, &key)?).map_err(|_| layers.wrong(&key, "it is out of range"))?;
    let may_have_one = kind(layers, &format!("{section}.kind"))?.may_have_sonar();
    Ok(if may_have_one && sensing(layers)? == Sensing::Sonar { cells } else { 0 })
}

pub(super) fn kind(layers: &Layers, key: &str) -> Result<RobotKind, SettingsError> {
    let name: String = read(layers, key)?;
    let kind = RobotKind::ALL.into_iter().find(|kind| kind.name() == name);
    kind.ok_or_else(|| layers.wrong(key, "there is no such kind of robot"))
}

fn speed(layers: &Layers, key: &str) -> Result<Speed, SettingsError> {
    match read(layers, key)? {
        NumberOrWord::Number(factor) => within(layers, key, factor).map(Speed::Times),
        NumberOrWord::Word(word) if word == "max" => Ok(Speed::Max),
        NumberOrWord::Word(_) => Err(layers.wrong(key, "this word is not a speed")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Sources, load};

    /// Settings from environment variables alone; the names are given without the prefix `HALLSWEEP__`.
    fn given(variables: &[(&str, &str)]) -> Result<HallSettings, SettingsError> {
        let variable = |(name, value): &(&str, &str)| (format!("HALLSWEEP__{name}"), (*value).to_owned());
        load(&Sources { environment: variables.iter().map(variable).collect(), ..Sources::default() })
            .map(|settings| settings.hall)
    }

    /// Settings from a file and from environment variables; the names of the variables are given with their prefix.
    fn written(name: &str, text: &str, variables: &[(&str, &str)]) -> Result<HallSettings, SettingsError> {
        let path = std::env::temp_dir().join(format!("hallsweep-robots-{}-{name}.toml", std::process::id()));
        std::fs::write(&path, text).expect("the temporary directory can be written");
        let environment = variables.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        let settings =
            load(&Sources { file: Some(path.clone()), environment, ..Sources::default() }).map(|settings| settings.hall);
        std::fs::remove_file(path).expect("the file is ours");
        settings
    }

    fn said(settings: Result<HallSettings, SettingsError>) -> String {
        settings.expect_err("this is wrong").to_string()
    }

    #[test]
    fn there_is_one_robot_where_nothing_is_said() {
        let settings = given(&[]).expect("the defaults are good");
        assert_eq!(settings.robots().map(|(robot, _)| robot).collect::<Vec<_>>(), [RobotId::discovery()]);
        assert_eq!(settings.robot.kind, RobotKind::Sim);
    }

    #[test]
    fn no_further_robot_has_the_name_of_one_of_the_pair() {
        for name in ["SRM1", "SRM2"] {
            let said = said(given(&[(&format!("ROBOTS__{name}__KIND"), "sim")]));
            assert!(said.contains("pair") && said.contains("another name"), "{said}");
        }
    }

    #[test]
    fn a_further_robot_is_like_the_first_is_by_default_but_for_what_is_said_of_it() {
        let text = "[robot]\nseed = 5\n[robots.porter-2]\nkind = \"sim\"\nspeed = \"max\"\n[robots.arm]\nkind = \"sim\"\n";
        let settings = written("further", text, &[("HALLSWEEP__ROBOTS__ARM__SEED", "9")]).expect("good");
        let seeds: Vec<_> = settings.robots().map(|(robot, of)| (robot.to_string(), of.seed, of.speed)).collect();
        let expect = [("discovery", 5, Speed::Times(1.0)), ("arm", 9, Speed::Times(1.0)), ("porter-2", 1, Speed::Max)];
        assert_eq!(seeds, expect.map(|(robot, seed, speed)| (robot.to_owned(), seed, speed)));
    }

    #[test]
    fn the_robot_that_searches_may_be_called_by_its_name_too() {
        let settings = written("by-name", "[robot]\nseed = 5\n[robots.discovery]\nspeed = 3\n", &[]).expect("good");
        assert_eq!((settings.robot.seed, settings.robot.speed, settings.further_robots.len()), (5, Speed::Times(3.0), 0));
        let settings = written("over", "[robots.discovery]\nseed = 5\n", &[("HALLSWEEP__ROBOT__SEED", "6")]).expect("good");
        assert_eq!(settings.robot.seed, 6, "the later place wins, whatever name it uses");
        let wrong = said(given(&[("ROBOTS__DISCOVERY__SPEED", "fast")]));
        let begins = "setting robots.discovery.speed = \"fast\" (from environment variable HALLSWEEP__ROBOTS__DISCOVERY__SPEED): \
                      this word is not a speed; write a factor";
        assert!(wrong.starts_with(begins), "{wrong}");
    }

    #[test]
    fn both_names_for_one_thing_in_one_place_are_refused() {
        let wrong = said(given(&[("ROBOTS__DISCOVERY__SEED", "2"), ("ROBOT__SEED", "2")]));
        assert_eq!(
            wrong,
            "setting robots.discovery.seed = 2 (from environment variable HALLSWEEP__ROBOTS__DISCOVERY__SEED): robot.seed means the same \
             setting, and is set too (from environment variable HALLSWEEP__ROBOT__SEED); set only one of the two"
        );
        let wrong = said(written("both", "[robot]\nseed = 1\n[robots.discovery]\nseed = 1\n", &[]));
        assert!(wrong.contains("robot.seed means the same setting") && wrong.contains("(from file "), "{wrong}");
    }

    #[test]
    fn what_is_wrong_with_a_robot_is_said_with_its_name_and_what_to_do() {
        for (variables, expect) in [
            (
                &[("ROBOTS__PORTER__KIND", "mbot")][..],
                "setting robots.porter.kind = \"mbot\" (from environment variable HALLSWEEP__ROBOTS__PORTER__KIND): \
                 there is no such kind of robot; write one of: sim, virtual-tcp, virtual-ws, line",
            ),
            (
                &[("ROBOTS__PORTER__SEED", "2")],
                "setting robots.porter.kind = nothing (from environment variable HALLSWEEP__ROBOTS__PORTER__SEED): it is missing; \
                 write one of: sim, virtual-tcp, virtual-ws, line",
            ),
            (
                &[("ROBOTS__PORTER__KIND", "sim"), ("ROBOTS__PORTER__UNKNOWN_RATE", "2")],
                "setting robots.porter.unknown_rate = 2 (from environment variable HALLSWEEP__ROBOTS__PORTER__UNKNOWN_RATE): \
                 it is out of range; write a rate from 0 (never) to 1 (always)",
            ),
        ] {
            assert_eq!(said(given(variables)), expect);
        }
        let wrong = said(given(&[("ROBOTS__PORTER__SPED", "2")]));
        assert!(
            wrong.contains("`robots.porter.sped`") && wrong.contains("[robots.NAME] has the settings kind, address, "),
            "{wrong}"
        );
        for (name, text) in [("name", "[robots.Porter]\nkind = \"sim\"\n"), ("no-table", "[robots]\nPorter = 1\n")] {
            let wrong = said(written(name, text, &[]));
            assert!(wrong.contains("`robots.Porter` (from file ") && wrong.contains("small letters"), "{wrong}");
        }
    }

    #[test]
    fn no_two_robots_are_in_one_place() {
        let line = |name: &str, address: &str| format!("[{name}]\nkind = \"line\"\naddress = \"{address}\"\n");
        let two = |one, other| line("robot", one) + &line("robots.porter", other);
        for (one, other) in [
            ("localhost:8300", "127.0.0.1:8300"),
            ("[::1]:8300", "localhost:8300"),
            ("/dev/ttyUSB0", "/dev/ttyUSB0"),
            ("LOCALHOST.:1", "127.0.0.2:1"),
            ("[::ffff:127.0.0.1]:1", "localhost:1"),
        ] {
            let wrong = said(written("one-place", &two(one, other), &[]));
            assert!(
                wrong.contains("robots.porter.address") && wrong.contains("the robot discovery has this address already"),
                "{wrong}"
            );
        }
        assert!(written("two-places", &two("localhost:8300", "localhost:8301"), &[]).is_ok());
        let three = two("a:1", "b:1") + &line("robots.crane", "b:1");
        assert!(said(written("three", &three, &[])).contains("has this address already"));
    }

    #[test]
    fn there_are_only_so_many_robots() {
        let text = |further: usize| (0..further).map(|n| format!("[robots.r{n}]\nkind = \"sim\"\n")).collect::<String>();
        assert_eq!(written("eight", &text(7), &[]).expect("good").robots().count(), MOST_ROBOTS);
        let wrong = said(written("nine", &text(8), &[]));
        assert!(wrong.contains("there are 9 robots; add at most 7 robots to discovery"), "{wrong}");
    }
}
