//! What the scene file of a virtual robot's page tells its driver: where everything stands, as the robot meets it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use hallsweep_core::event::RobotId;
use hallsweep_core::units::Heading;
use hallsweep_drivers::{Face, Room};
use hallsweep_sim::{HallError, Scene};

/// The side of a cell, in units of the page; the robot is as large.
const CELL: f64 = 4.0;

/// So many times a second the page moves the robot by its speed, where it is not slow.
const FRAMES: f64 = 60.0;

/// The scene file of the settings cannot be read. `Display` is the line for whoever started the program.
#[derive(Debug, thiserror::Error)]
#[error("the scene file {path:?} of {robot} cannot be used: {error}")]
pub struct UnusableScene {
    /// Which robot's.
    pub robot: RobotId,
    /// The path, as it was set.
    pub path: PathBuf,
    pub error: HallError,
}

/// What is known of the room, and how long a cell takes where the page is as quick as it is meant to be.
pub(super) fn room(robot: &RobotId, path: &Path) -> Result<(Room, Duration), UnusableScene> {
    let read = Scene::open(&path.to_string_lossy());
    let scene = read.map_err(|error| UnusableScene { robot: robot.clone(), path: path.to_owned(), error })?;
    let step = Duration::try_from_secs_f64(CELL / (scene.player.speed * FRAMES)).unwrap_or(Duration::from_secs(1));
    Ok((told(&scene), step.clamp(Duration::from_millis(50), Duration::from_secs(5))))
}

fn told(scene: &Scene) -> Room {
    let (x, z, half) = (scene.player.x, scene.player.z, CELL / 2.0);
    let mut count = BTreeMap::new();
    for thing in &scene.statics {
        *count.entry(thing.name.as_str()).or_insert(0) += 1;
    }
    // What shares its name with something else says nothing of where it is.
    let named = scene.statics.iter().filter(|thing| count.get(thing.name.as_str()) == Some(&1));
    let faces = named.flat_map(|thing| {
        let face = |towards, at: f64| Face { name: thing.name.clone(), towards, at: (at - half) / CELL };
        [
            face(Heading::East, thing.min_x - x),
            face(Heading::West, x - thing.max_x),
            face(Heading::South, thing.min_z - z),
            face(Heading::North, z - thing.max_z),
        ]
    });
    let border = scene.floor.z / 2.0 - z + half;
    let is_ahead = |min_x: f64, max_x: f64, min_z: f64| x > min_x - half && x < max_x + half && min_z > z;
    let ahead = scene.statics.iter().filter(|thing| is_ahead(thing.min_x, thing.max_x, thing.min_z)).map(|thing| thing.min_z - z);
    let doubled = count.iter().filter(|(_, times)| **times > 1).map(|(name, _)| (*name).to_owned());
    let moving = scene.moving.iter().map(|thing| thing.name.clone());
    let unfixed = doubled.chain(moving).collect();
    Room { faces: faces.collect(), unfixed, ahead: Some((ahead.fold(border, f64::min) - half) / CELL) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_of_a_room_are_where_the_robot_touches_them() {
        let scene = Scene::parse("test", include_bytes!("../../../config/scenes/empty-35x35.js")).expect("a scene of ours");
        let room = told(&scene);
        assert_eq!(room.faces.len(), 16);
        let at =
            |name: &str, towards| room.faces.iter().find(|face| face.name == name && face.towards == towards).map(|face| face.at);
        let [up, down] = [at("wallUp", Heading::North), at("wallDown", Heading::South)].map(|at| at.expect("it is there"));
        assert!((0.0..1.0).contains(&up) && (7.0..8.0).contains(&down), "{up} {down}");
        assert_eq!(room.ahead, Some(down));
    }

    #[test]
    fn two_things_of_one_name_say_nothing() {
        let scene = "const config = {floor: {size: {x: 20, y: 20}}, player: {position: {x: 0.2, y: 0.2}, speed: 0.2}, sonars: [],
            movingObstacles: [], staticObstacles: [
            {name: 'box', centerPosition: {x: 0.5, y: 0.5}, size: {x: 0.1, y: 0.1}},
            {name: 'box', centerPosition: {x: 0.9, y: 0.5}, size: {x: 0.1, y: 0.1}}]};\nexport default config;";
        let room = told(&Scene::parse("test", scene.as_bytes()).expect("a scene"));
        assert_eq!((room.faces, room.unfixed), (vec![], vec!["box".to_owned()]));
        assert_eq!(room.ahead, Some(4.0), "the border of the floor");
    }
}
