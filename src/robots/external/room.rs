//! Reads the room and its obstacles from the scene file of a virtual robot's page, in the form that the driver needs.

use std::path::{Path, PathBuf};
use std::time::Duration;

use hallsweep_core::robot::RobotId;
use hallsweep_drivers::{Extent, Room, Thing};
use hallsweep_sim::{HallError, PLAYER, Scene};

/// `Display` is the message for the person who started the program.
#[derive(Debug, thiserror::Error)]
#[error("the scene file {path:?} of {robot} cannot be used: {error}")]
pub struct UnusableScene {
    pub robot: RobotId,
    /// The path, as it was set.
    pub path: PathBuf,
    pub error: HallError,
}

/// The room, and the time for one cell at the page's nominal speed.
pub(super) fn room(robot: &RobotId, path: &Path) -> Result<(Room, Duration), UnusableScene> {
    let file = path.to_string_lossy();
    let read = Scene::open(&file).and_then(|scene| {
        let step = scene.step().map_err(|fault| fault.of(&file))?;
        Ok((told(&scene), step))
    });
    read.map_err(|error| UnusableScene { robot: robot.clone(), path: path.to_owned(), error })
}

/// The room in cells, measured from the player's start. Obstacles are enlarged, so that their edge is where the
/// robot's centre stops.
fn told(scene: &Scene) -> Room {
    let (player, half) = (&scene.player, PLAYER / 2.0);
    let extent = |(min_x, max_x): (f64, f64), (min_z, max_z): (f64, f64), grown: f64| Extent {
        x: ((min_x - grown - player.x) / PLAYER, (max_x + grown - player.x) / PLAYER),
        y: ((min_z - grown - player.z) / PLAYER, (max_z + grown - player.z) / PLAYER),
    };
    let things = scene.statics.iter().map(|thing| Thing {
        name: thing.name.clone(),
        extent: extent((thing.min_x, thing.max_x), (thing.min_z, thing.max_z), half),
    });
    let (half_x, half_z) = (scene.floor.x / 2.0, scene.floor.z / 2.0);
    Room {
        floor: extent((-half_x, half_x), (-half_z, half_z), 0.0),
        things: things.collect(),
        moving: scene.moving.iter().map(|thing| thing.name.clone()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_and_floor_are_told_where_the_centre_of_the_robot_touches_them() {
        let scene = "const config = {floor: {size: {x: 20, y: 40}}, player: {position: {x: 0.2, y: 0.1}, speed: 0.2}, sonars: [],
            movingObstacles: [{name: 'cat', position: {x: 0.5, y: 0.5}, directionAxis: {x: true}}],
            staticObstacles: [{name: 'box', centerPosition: {x: 0.5, y: 0.5}, size: {x: 0.1, y: 0.1}}]};\nexport default config;";
        let room = told(&Scene::parse("test", scene.as_bytes()).expect("a scene"));
        let thing = Thing { name: "box".to_owned(), extent: Extent { x: (0.75, 2.25), y: (3.0, 5.0) } };
        assert_eq!(room.things, [thing]);
        assert_eq!((room.floor, room.moving), (Extent { x: (-1.0, 4.0), y: (-1.0, 9.0) }, vec!["cat".to_owned()]));
    }
}
