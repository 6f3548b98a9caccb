//! Creates all robots of the settings. First it reads what is stored about each robot, then it makes the adapter that
//! runs the robot. `app` decides who learns of the robots, and on which threads they run.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use tokio::sync::watch;

use super::Adapter;
use super::external::{ExternalRobot, UnusableScene};
use super::sim::{self, ChosenHall, Controls, Remote, SimPair, SimRobot, SimulatedHall, SimulatorParts, UnusableHall};
use crate::config::{HallSettings, RobotKind, RobotSettings};
use crate::runtime::clock::Clock;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::robot::RobotId;
use hallsweep_core::speed::Speed;
use hallsweep_core::state::{Participant, Venue};
use hallsweep_core::units::Piece;
use hallsweep_core::world::coverage::{Sensor, SensorModel};
use hallsweep_sim::Hall;

pub struct Robots {
    hall: Arc<Hall>,
    /// All robots except the pair; the searching robot is first.
    all: Vec<(RobotId, Robot)>,
    /// The pair of robots that fetches luggage. If the settings do not use the pair, it is not started, but pieces
    /// that it removed earlier stay removed.
    pair: SimPair,
    wants_pair: bool,
    seed: u64,
    speed: Speed,
    chosen: Option<ChosenHall>,
    /// Why the chosen hall cannot be used. Then it is unknown in which hall the simulated robots are.
    no_hall: Option<String>,
    /// The hall as named in the settings, and the start in it.
    usual: (String, Option<(u32, u32)>),
    /// The names of all robots, the pair last.
    ids: Vec<RobotId>,
    /// The venue of all robots without the hall. Its areas are those of a searching robot that is not simulated.
    team: Venue,
}

/// `Display` is the message for the person who started the program.
#[derive(Debug, thiserror::Error)]
pub enum Unusable {
    #[error(transparent)]
    Hall(#[from] UnusableHall),
    #[error(transparent)]
    Scene(#[from] UnusableScene),
}

enum Robot {
    Sim(Box<SimRobot>),
    External(Box<ExternalRobot>),
}

impl Robots {
    pub fn of(settings: &HallSettings) -> Result<Robots, Unusable> {
        let is_simulated = settings.robots().any(|(_, robot)| robot.kind == RobotKind::Sim);
        // A changed start in the settings counts as another hall, and then the hall chosen earlier does not apply.
        let start = settings.start.map_or_else(String::new, |(column, row)| format!(" from {column},{row}"));
        let instead = format!("{}{start}", settings.file);
        let chosen = settings.folder.as_deref().filter(|_| is_simulated).map(|folder| ChosenHall::within(folder, &instead));
        let was_chosen = chosen.as_ref().map_or(Ok(None), ChosenHall::read);
        let no_hall = was_chosen.as_ref().err().map(ToString::to_string);
        let SimulatedHall { hall, seed } = match was_chosen {
            Ok(Some(ground)) => ground,
            Ok(None) | Err(_) => {
                let hall = if is_simulated {
                    sim::hall(settings)?
                } else {
                    // Without simulated robots the usual hall of the settings is unused, so it need not exist.
                    Arc::new(Hall::from_rows("no hall of ours", &["S"]).expect("a hall of one cell is one"))
                };
                SimulatedHall { hall, seed: settings.robot.seed }
            }
        };
        let (hall, seed) = match &settings.exercise {
            Some(exercise) => (sim::exercise(&hall, exercise.pieces, settings.robot.seed)?, settings.robot.seed),
            None => (hall, seed),
        };
        let fetches = |id: &RobotId| settings.core.fetcher == Fetcher::Discovery && *id == RobotId::discovery();
        let robot = |(id, robot): (RobotId, &RobotSettings)| {
            let fetches = fetches(&id);
            // The seed chosen with the hall applies to the searching robot.
            let robot = if id == RobotId::discovery() { &RobotSettings { seed, ..robot.clone() } } else { robot };
            Ok((id.clone(), Robot::of(id, robot, &hall, fetches)?))
        };
        let all = settings.robots().map(robot).collect::<Result<Vec<(RobotId, Robot)>, UnusableScene>>()?;
        let wants_pair = settings.core.fetcher == Fetcher::Pair;
        let pair = SimPair::new(Arc::clone(&hall), &RobotSettings { seed, ..settings.robot.clone() }, settings.pair);
        let ids: Vec<RobotId> =
            all.iter().map(|(id, _)| id.clone()).chain(SimPair::ids().into_iter().filter(|_| wants_pair)).collect();
        // The pair has no section in the settings, because it is always simulated.
        let participant = |id: &RobotId| {
            let set = settings.robots().find(|(robot, _)| robot == id).map(|(_, robot)| robot);
            let kind = set.map_or(RobotKind::Sim, |robot| robot.kind).name().into();
            let address = set.and_then(|robot| robot.address.written()).map(Arc::from);
            Participant { name: id.name().into(), kind, address }
        };
        let is_sim = settings.robot.kind == RobotKind::Sim;
        let can_miss = settings.robot.camera_misses && !settings.core.inspect_everything;
        let model = (is_sim && can_miss).then_some(SensorModel::SimCamera);
        let sensor = Sensor { cells: settings.core.sonar_cells, model };
        let speed = settings.robot.speed;
        let usual = (settings.file.clone(), settings.start);
        let areas = if !is_sim && settings.is_chosen { Arc::clone(sim::hall(settings)?.areas()) } else { Arc::default() };
        if !is_simulated && settings.is_chosen && areas.is_empty() {
            tracing::warn!(
                hall = settings.file,
                "hall.file and hall.start have no effect on the configured robots: this hall has no areas"
            );
        }
        let team = Venue { robots: ids.iter().map(participant).collect(), sensor, areas, ..Venue::default() };
        Ok(Robots { hall, all, pair, wants_pair, seed, speed, chosen, no_hall, usual, ids, team })
    }

    /// Name of the searching robot's hall, or the address of an external robot.
    pub fn hall_name(&self) -> String {
        match self.all.first() {
            Some((_, Robot::External(robot))) => robot.place(),
            Some((_, Robot::Sim(_))) | None => self.hall.name().to_owned(),
        }
    }

    /// Where the searching robot drives. For an external robot only the address is known.
    pub fn venue(&self) -> Venue {
        match self.all.first() {
            Some((_, Robot::Sim(_))) => sim::venue(&self.hall, self.seed, &self.team),
            other => Venue {
                name: self.hall_name().into(),
                is_reckoned: matches!(other, Some((_, Robot::External(robot))) if robot.reckons()),
                ..self.team.clone()
            },
        }
    }

    /// All pieces of an exercise that can be inspected, each with whether it is a test piece; `None` outside exercises.
    pub fn truth(&self) -> Option<BTreeMap<Piece, bool>> {
        self.hall.is_exercise().then(|| self.hall.inspectable())
    }

    pub fn ids(&self) -> impl Iterator<Item = &RobotId> {
        self.ids.iter()
    }

    /// Reads what is stored about the robots in the data folder. Writes nothing.
    pub fn recall(&mut self, folder: &Path) {
        self.pair.recall(folder);
        let floor = self.pair.floor();
        for (_, robot) in &mut self.all {
            match robot {
                Robot::Sim(robot) => robot.recall(folder, &floor),
                Robot::External(robot) => robot.recall(folder),
            }
        }
        if let Some(why) = self.no_hall.clone() {
            self.lose(&why);
        }
    }

    pub fn lose(&mut self, why: &str) {
        self.simulated().for_each(|robot| robot.lose(why));
        self.pair.lose(why);
    }

    /// For each robot whose position is unknown, the reason for this. These robots will not be started. The pair is
    /// included even if the settings do not use it, because pieces that it removed stay removed for the other robots.
    pub fn lost(&self) -> Vec<String> {
        let robots = self.all.iter().filter_map(|(_, robot)| robot.lost());
        let mut lost: Vec<String> = robots.chain(self.pair.lost()).map(str::to_owned).collect();
        lost.dedup();
        lost
    }

    /// A message about a fault in the folder that does not prevent the start. The message says what to do.
    pub fn note(&self, folder: &Path) -> Option<String> {
        self.chosen.as_ref().and_then(|_| sim::unreadable_halls(folder))
    }

    /// The hall in which the searching robot was left, when that is not the hall of the settings.
    pub fn other_hall(&self) -> Option<&str> {
        self.all.first().and_then(|(_, robot)| match robot {
            Robot::Sim(robot) => robot.other_hall(),
            Robot::External(_) => None,
        })
    }

    /// Moves the robots that were left in another hall to the home cell of this hall. When the robots start, what was
    /// stored about the other hall is overwritten.
    pub fn put_down(&mut self) {
        for robot in self.simulated() {
            robot.put_down();
        }
        self.pair.put_down();
    }

    /// Keeps what is stored about another hall. At the next start the robots are in that hall again.
    pub fn keep_other_hall(&mut self) {
        for robot in self.simulated() {
            robot.keep_other_hall();
        }
        self.pair.keep_other_hall();
    }

    fn simulated(&mut self) -> impl Iterator<Item = &mut Box<SimRobot>> {
        self.all.iter_mut().filter_map(|(_, robot)| match robot {
            Robot::Sim(robot) => Some(robot),
            Robot::External(_) => None,
        })
    }

    pub fn adapters(self, clock: Clock) -> Adapters {
        let simulates = matches!(self.all.first(), Some((_, Robot::Sim(_))));
        let (controls, obeyed) = watch::channel(Controls::default());
        let (mut robots, mut links) = (Vec::new(), Vec::new());
        let mut remote = |ids: &[RobotId]| {
            let (remote, link) = Remote::new(obeyed.clone());
            robots.extend_from_slice(ids);
            links.push(link);
            remote
        };
        let moved = if self.wants_pair { self.pair.moved() } else { watch::channel(self.pair.taken_away()).1 };
        // The pair comes first. So the pieces that it lifted are back in their places before the other robots enter
        // another hall.
        let pair = self.wants_pair.then(|| self.pair.adapters(clock, remote(&SimPair::ids())));
        let of_one = |(id, robot): (RobotId, Robot)| match robot {
            Robot::Sim(robot) => robot.adapter(clock, moved.clone(), remote(&[id])),
            Robot::External(robot) => robot.adapter(clock),
        };
        let all: Vec<Adapter> = self.all.into_iter().map(of_one).collect();
        let (ground, speed) = (SimulatedHall { hall: self.hall, seed: self.seed }, self.speed);
        let parts =
            sim::Parts { ground, speed, controls, robots, links, chosen: self.chosen, usual: self.usual, team: self.team };
        let simulator = simulates.then(|| SimulatorParts(parts));
        Adapters { all: all.into_iter().chain(pair.into_iter().flatten()).collect(), simulator }
    }
}

pub struct Adapters {
    /// The adapters in the order of `ids`.
    pub all: Vec<Adapter>,
    pub simulator: Option<SimulatorParts>,
}

impl Robot {
    fn of(id: RobotId, settings: &RobotSettings, hall: &Arc<Hall>, fetches: bool) -> Result<Robot, UnusableScene> {
        Ok(match ExternalRobot::new(&id, settings)? {
            Some(robot) => Robot::External(Box::new(robot)),
            None => Robot::Sim(Box::new(SimRobot::new(id, Arc::clone(hall), settings, fetches))),
        })
    }

    fn lost(&self) -> Option<&str> {
        match self {
            Robot::Sim(robot) => robot.lost(),
            Robot::External(robot) => robot.lost(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Flag, Sources, load};
    use crate::storage::tests::scratch::Scratch;
    use hallsweep_core::units::Cell;

    #[test]
    fn a_robot_that_is_not_simulated_gets_only_the_areas_of_the_hall_that_somebody_has_chosen() {
        let folder = Scratch::new();
        std::fs::create_dir_all(&folder.0).expect("it can be made");
        let file = folder.0.join("areas.toml");
        let area = "[[area]]\nname = \"gate\"\nprobability = 0.5\ncorners = [[2, 0], [3, 1]]\n";
        std::fs::write(&file, format!("width = 4\nheight = 2\n{area}")).expect("it can be written");
        let venue = |set: &[(&'static str, &str)]| {
            let chosen = set.iter().map(|(flag, value)| Flag::given(flag, (*value).to_owned()));
            let flags = Flag::robot("line=localhost:9").into_iter().chain(chosen).collect();
            let settings = load(&Sources { flags, ..Sources::default() }).expect("good settings");
            Robots::of(&settings.hall).map(|robots| robots.venue()).map_err(|unusable| unusable.to_string())
        };
        let hall = file.display().to_string();
        let usual = venue(&[("--data", "none")]).expect("the usual hall is unused");
        let chosen = venue(&[("--data", "none"), ("--hall", &hall), ("--start", "1,0")]).expect("it can be read");
        assert_eq!(*chosen.areas[0].corners, [Cell::new(1, 0), Cell::new(2, 1)], "counted from the start");
        assert_eq!(Venue { areas: Arc::default(), ..chosen }, usual, "nothing else of the file applies");
        let missing = venue(&[("--data", "none"), ("--hall", "no-such.toml")]).expect_err("it is missing");
        assert!(missing.contains("no-such.toml: cannot read this file"), "{missing}");
    }
}
