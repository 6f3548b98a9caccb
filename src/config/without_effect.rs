//! Settings without effect: settings of the simulator for a robot that is not simulated, and settings of a real robot for a
//! simulated one. The program starts anyway and names these settings; wrong values are reported elsewhere.

use super::error::SettingsError;
use super::key::{ROBOT, ROBOTS};
use super::layers::Layers;
use super::reading::{read, sensing};
use super::robot_address::RobotKind;
use super::{Settings, robots};
use hallsweep_core::search::Sensing;

/// Settings of a robot, each with the kinds of robots for which it has an effect.
const OF_SOME_KINDS: [(&str, &[RobotKind]); 10] = [
    ("speed", &[RobotKind::Sim]),
    ("seed", &[RobotKind::Sim]),
    ("unknown_rate", &[RobotKind::Sim]),
    ("camera_misses", &[RobotKind::Sim]),
    ("photo_failure_rate", &[RobotKind::Sim]),
    ("sonar_noise_cm", &[RobotKind::Sim]),
    ("sonar_cells", &[RobotKind::Sim, RobotKind::Line]),
    ("baud", &[RobotKind::Line]),
    ("step_ms", &[RobotKind::VirtualTcp, RobotKind::VirtualWs]),
    ("scene", &[RobotKind::VirtualTcp, RobotKind::VirtualWs]),
];

impl Settings {
    /// Settings without effect, as they were given. A setting that has no effect in some halls is named with these halls.
    pub fn without_effect(&self) -> Vec<String> {
        let mut idle: Vec<(&str, Vec<&str>)> = Vec::new();
        for hall in self.halls() {
            for given in &hall.without_effect {
                match idle.iter_mut().find(|(known, _)| known == given) {
                    Some((_, halls)) => halls.push(hall.name.name()),
                    None => idle.push((given, vec![hall.name.name()])),
                }
            }
        }
        let named = |(given, halls): (&str, Vec<&str>)| {
            let in_all = halls.len() > self.further_halls.len();
            if in_all { given.to_owned() } else { format!("{given} (hall {})", halls.join(", hall ")) }
        };
        idle.into_iter().map(named).collect()
    }
}

/// Settings without effect in a hall, as they were given, such as `flag --speed`.
pub(super) fn without_effect(layers: &Layers) -> Result<Vec<String>, SettingsError> {
    let mut keys = Vec::new();
    let mut is_any_simulated = false;
    let searches = robots::kind(layers, &format!("{ROBOT}.kind"))?;
    let sections = layers.further_robots().map(|name| format!("{ROBOTS}.{name}"));
    for section in std::iter::once(ROBOT.to_owned()).chain(sections) {
        let kind = robots::kind(layers, &format!("{section}.kind"))?;
        is_any_simulated |= kind == RobotKind::Sim;
        let idle = OF_SOME_KINDS.iter().filter(|(_, kinds)| !kinds.contains(&kind));
        keys.extend(idle.map(|(own, _)| format!("{section}.{own}")));
        let is_virtual = matches!(kind, RobotKind::VirtualTcp | RobotKind::VirtualWs);
        if is_virtual && !read::<String>(layers, &format!("{section}.scene"))?.is_empty() {
            // The scene file determines the time for a cell, so `step_ms` has no effect.
            keys.push(format!("{section}.step_ms"));
        }
    }
    // The areas of a chosen hall apply to real robots, too. `robots` says when the hall has none.
    if !is_any_simulated && !layers.is_chosen("hall.file") {
        keys.push("hall.start".to_owned());
    }
    if !searches.may_have_sonar() && sensing(layers)? == Sensing::Sonar {
        keys.push("mission.sensing".to_owned());
    }
    if searches != RobotKind::Sim {
        keys.extend(["pair.slips", "pair.unrecognised"].map(str::to_owned));
    }
    Ok(keys.iter().filter(|key| layers.is_chosen(key)).map(|key| layers.as_given(key)).collect())
}

#[cfg(test)]
mod tests {
    use crate::config::{Flag, Sources, load};

    fn idle(flags: &[(&'static str, &str)], variables: &[(&str, &str)], robot: &str) -> Vec<String> {
        let set = flags.iter().map(|(flag, value)| Flag::given(flag, (*value).to_owned()));
        let flags = set.chain(Flag::robot(robot)).collect();
        let variable = |(name, value): &(&str, &str)| (format!("HALLSWEEP__{name}"), (*value).to_owned());
        let environment = variables.iter().map(variable).collect();
        load(&Sources { flags, environment, file: None }).expect("the program starts").hall.without_effect
    }

    #[test]
    fn settings_of_the_simulator_are_idle_beside_another_robot_and_beside_it_they_are_not() {
        let flags = [("--speed", "max"), ("--seed", "2"), ("--hall", "seed"), ("--strategy", "snail")];
        let variables = [("PAIR__SLIPS", "1")];
        let expect = ["flag --speed", "flag --seed", "environment variable HALLSWEEP__PAIR__SLIPS"];
        for robot in ["virtual-tcp", "virtual-ws", "line=localhost:9"] {
            assert_eq!(idle(&flags, &variables, robot), expect, "{robot}");
            assert_eq!(idle(&[], &[], robot), [""; 0], "{robot}: nobody has set anything");
            assert_eq!(idle(&[("--start", "1,0")], &[], robot), ["flag --start"], "{robot}: no hall has areas");
            let areas = [("--start", "1,0"), ("--hall", "areas.toml")];
            assert_eq!(idle(&areas, &[], robot), [""; 0], "{robot}: the areas count from the start");
        }
        assert_eq!(idle(&flags, &variables, "sim"), [""; 0]);
    }

    #[test]
    fn the_sonar_is_idle_beside_a_robot_that_never_has_one() {
        let set = |sensing| [("MISSION__SENSING", sensing), ("ROBOT__SONAR_CELLS", "2")];
        let [cells, sensing] =
            ["ROBOT__SONAR_CELLS", "MISSION__SENSING"].map(|own| format!("environment variable HALLSWEEP__{own}"));
        for robot in ["virtual-tcp", "virtual-ws"] {
            assert_eq!(idle(&[], &set("sonar"), robot), [cells.clone(), sensing.clone()]);
            assert_eq!(idle(&[], &set("bump"), robot), std::slice::from_ref(&cells));
        }
        for robot in ["sim", "line=localhost:9"] {
            assert_eq!(idle(&[], &set("sonar"), robot), [""; 0], "{robot}");
        }
    }

    #[test]
    fn the_hall_and_the_settings_of_a_further_robot_that_is_simulated_are_not_idle() {
        let variables = [("ROBOTS__PORTER__KIND", "sim"), ("ROBOTS__PORTER__SEED", "2")];
        assert_eq!(idle(&[("--hall", "seed"), ("--seed", "3")], &variables, "virtual-tcp"), ["flag --seed"]);
    }

    #[test]
    fn settings_of_other_robots_are_idle_beside_the_simulated_one() {
        let variables = [("ROBOT__BAUD", "9600"), ("ROBOT__STEP_MS", "400"), ("ROBOT__SCENE", "room.js")];
        let name = |own: &str| format!("environment variable HALLSWEEP__ROBOT__{own}");
        assert_eq!(idle(&[], &variables, "sim"), ["BAUD", "STEP_MS", "SCENE"].map(name));
        assert_eq!(idle(&[], &variables, "virtual-ws"), ["BAUD", "STEP_MS"].map(name), "the scene says how long a step takes");
        assert_eq!(idle(&[], &variables[..2], "virtual-ws"), [name("BAUD")]);
    }

    #[test]
    fn what_a_file_says_is_named_with_the_file() {
        let path = std::env::temp_dir().join(format!("hallsweep-idle-{}.toml", std::process::id()));
        std::fs::write(&path, "[robots.discovery]\nkind = \"line\"\naddress = \"COM3\"\nspeed = 2\n").expect("it can be written");
        let settings = load(&Sources { file: Some(path.clone()), ..Sources::default() });
        std::fs::remove_file(&path).expect("the file is ours");
        let expect = format!("robots.discovery.speed in file {}, line 4", path.display());
        assert_eq!(settings.expect("the program starts").hall.without_effect, [expect]);
    }
}
