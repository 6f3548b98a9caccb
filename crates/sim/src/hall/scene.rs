//! Reads the scene file of the Bologna virtual robot's page. The file is a JavaScript module with one object literal:
//! the size of the floor, the place of the player (the robot), and the things on the floor. `script` finds the
//! literal, and `cells` makes a hall from the scene.
//!
//! Positions in the file are fractions of the floor. Here everything is in units of the page's world, counted from
//! the middle of the floor: `x` to the east, `z` to the south. North is at the top of the page.

mod cells;
mod script;

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::Duration;

use serde::Deserialize;

use super::error::{HallError, HallFault};
pub use cells::HallOfScene;
use hallsweep_core::words::is_visible;

/// Largest scene file, in bytes. Real scene files have about 3,000.
const MAX_SCENE_BYTES: usize = 256 << 10;

/// Longest side of a floor, in units. A floor with two such sides has 62,500 cells.
const MAX_FLOOR: f64 = 1000.0;

/// Maximum number of things of each kind, because each thing is compared with every cell.
const MAX_THINGS: usize = 256;

/// Largest position of a thing, as a fraction of the floor. A thing may lie partly outside the floor, but its
/// position must stay finite.
const MAX_FRACTION: f64 = 100.0;

/// The side of the player's square, in units of the page's world. A cell has the same side.
pub const PLAYER: f64 = 4.0;

/// Moves of the player per second, on a page that is not slow. Each move is as long as `speed`, in units.
const FRAMES: f64 = 60.0;

/// Shortest and longest allowed time per cell.
const STEPS: [Duration; 2] = [Duration::from_millis(50), Duration::from_secs(5)];

/// A scene. All lengths are in units of the page's world.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub floor: Floor,
    pub player: Player,
    pub statics: Vec<StaticObstacle>,
    pub moving: Vec<MovingObstacle>,
    /// The sonars of the hall. Each detects things that pass in front of it.
    pub sonars: Vec<SceneSonar>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Length from west to east, in units.
    pub x: f64,
    /// Length from north to south, in units.
    pub z: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Player {
    pub x: f64,
    pub z: f64,
    /// Speed, as the scene file gives it.
    pub speed: f64,
}

/// A fixed box on the floor. The player's middle cannot come closer to the box than half the player's side.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticObstacle {
    pub name: String,
    pub min_x: f64,
    pub max_x: f64,
    pub min_z: f64,
    pub max_z: f64,
}

impl StaticObstacle {
    /// Whether the obstacle is a wall. Any other obstacle is luggage.
    #[must_use]
    pub fn is_wall(&self) -> bool {
        self.name.starts_with("wall")
    }
}

/// A thing that moves to and fro along one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingObstacle {
    pub name: String,
    pub x: f64,
    pub z: f64,
    pub along_x: bool,
    pub along_z: bool,
    /// Speed, as the scene file gives it.
    pub speed: f64,
    pub range: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SceneSonar {
    pub name: String,
    pub x: f64,
    pub z: f64,
    pub sees_along_x: bool,
    pub sees_along_z: bool,
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// When the file cannot be read or has a fault.
    pub fn open(path: &str) -> Result<Scene, HallError> {
        let mut bytes = Vec::new();
        let limit = MAX_SCENE_BYTES as u64 + 1;
        // A pipe is refused, because reading it could block.
        let file = std::fs::metadata(path).and_then(|about| match about.is_file() {
            true => File::open(Path::new(path)),
            false => Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "it is not a regular file")),
        });
        let read = file.and_then(|file| file.take(limit).read_to_end(&mut bytes));
        read.map_err(|error| HallFault::UnreadableScene(error.to_string()).of(path))?;
        Scene::parse(path, &bytes)
    }

    /// Reads a scene. `file` is named in errors.
    ///
    /// # Errors
    /// Returns the fault with its line.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Scene, HallError> {
        if bytes.len() > MAX_SCENE_BYTES {
            return Err(HallFault::SceneTooLarge(MAX_SCENE_BYTES).at(file, 1));
        }
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let good = bytes.get(..error.valid_up_to()).unwrap_or_default();
            HallFault::NotText.at(file, good.iter().filter(|byte| **byte == b'\n').count() + 1)
        })?;
        let literal = script::literal(text).map_err(|(line, fault)| fault.at(file, line))?;
        let written: Written = json5::from_str(literal.text).map_err(|error| {
            let line = literal.line + error.position().map_or(0, |position| position.line);
            let whole = error.to_string();
            let reason = whole.rsplit_once(" at line ").map_or(whole.as_str(), |(reason, _)| reason);
            // After the `/` of a division, the parser expects a comment. The parser's message would not help the
            // author.
            let reason = if reason == "expected comment" {
                "a calculation is not allowed here: write its result, as .5 for 1/2"
            } else {
                reason
            };
            HallFault::Syntax(format!("{reason}: correct this line")).at(file, line)
        })?;
        written.scene().map_err(|fault| fault.at(file, literal.line))
    }

    /// Time that the player needs for one cell, on a page that makes `FRAMES` moves per second.
    ///
    /// # Errors
    /// When the time is outside `STEPS`, because the player's speed is too low or too high.
    pub fn step(&self) -> Result<Duration, HallFault> {
        let (speed, [least, most]) = (self.player.speed, STEPS);
        let step = Duration::try_from_secs_f64(PLAYER / (speed * FRAMES)).ok();
        step.filter(|step| (least..=most).contains(step)).ok_or(HallFault::PlayerSpeed(speed.to_string()))
    }
}

/// The object literal, as the file has it. Parts that are not needed are ignored.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Written {
    floor: WrittenFloor,
    player: WrittenPlayer,
    #[serde(default)]
    sonars: Vec<WrittenSonar>,
    #[serde(default)]
    moving_obstacles: Vec<WrittenMoving>,
    #[serde(default)]
    static_obstacles: Vec<WrittenStatic>,
}

#[derive(Deserialize)]
struct WrittenFloor {
    size: WrittenSize,
}

#[derive(Deserialize)]
struct WrittenSize {
    x: Side,
    y: Side,
}

#[derive(Deserialize)]
struct WrittenPlayer {
    position: Pair,
    #[serde(default)]
    speed: Amount,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct WrittenSonar {
    name: Name,
    position: Pair,
    sense_axis: Axis,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct WrittenMoving {
    name: Name,
    position: Pair,
    direction_axis: Axis,
    #[serde(default)]
    speed: Amount,
    #[serde(default)]
    range: Amount,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct WrittenStatic {
    name: Name,
    center_position: Pair,
    size: Sides,
}

#[derive(Deserialize)]
struct Sides {
    x: Length,
    y: Length,
}

#[derive(Deserialize)]
struct Pair {
    x: Fraction,
    y: Fraction,
}

#[derive(Deserialize)]
struct Axis {
    #[serde(default)]
    x: bool,
    #[serde(default)]
    y: bool,
}

/// The value is checked while serde reads the file, because the line of a fault is not known later. The types below
/// are checked in the same way.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f64")]
struct Side(f64);

impl TryFrom<f64> for Side {
    type Error = String;

    fn try_from(side: f64) -> Result<Side, String> {
        let is_good = (PLAYER..=MAX_FLOOR).contains(&side);
        if is_good { Ok(Side(side)) } else { Err(format!("a side of the floor is {side}, but must be {PLAYER} to {MAX_FLOOR}")) }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f64")]
struct Fraction(f64);

impl TryFrom<f64> for Fraction {
    type Error = String;

    fn try_from(number: f64) -> Result<Fraction, String> {
        let is_good = number.abs() <= MAX_FRACTION;
        if is_good { Ok(Fraction(number)) } else { Err(format!("{number} is not a fraction of the floor (about 0 to 1)")) }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f64")]
struct Length(f64);

impl TryFrom<f64> for Length {
    type Error = String;

    fn try_from(number: f64) -> Result<Length, String> {
        let is_good = (0.0..=MAX_FRACTION).contains(&number);
        if is_good { Ok(Length(number)) } else { Err(format!("{number} is not a length (0 to 1 of the floor)")) }
    }
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f64")]
struct Amount(f64);

impl TryFrom<f64> for Amount {
    type Error = String;

    fn try_from(number: f64) -> Result<Amount, String> {
        if number.is_finite() { Ok(Amount(number)) } else { Err(format!("{number} is not a finite number")) }
    }
}

/// The length of a name is limited, because names are shown to people and repeated in messages.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Name(String);

impl TryFrom<String> for Name {
    type Error = &'static str;

    fn try_from(name: String) -> Result<Name, &'static str> {
        let is_good = (1..=64).contains(&name.chars().count()) && name.chars().all(is_visible);
        if is_good { Ok(Name(name)) } else { Err("a name has 1 to 64 visible characters") }
    }
}

impl Written {
    fn scene(self) -> Result<Scene, HallFault> {
        let longest = self.sonars.len().max(self.moving_obstacles.len()).max(self.static_obstacles.len());
        if longest > MAX_THINGS {
            return Err(HallFault::TooManyThings(MAX_THINGS));
        }
        let floor = Floor { x: self.floor.size.x.0, z: self.floor.size.y.0 };
        let (x, z) = floor.place(&self.player.position);
        Ok(Scene {
            floor,
            player: Player { x, z, speed: self.player.speed.0 },
            statics: self.static_obstacles.into_iter().map(|written| floor.obstacle(written)).collect(),
            moving: self.moving_obstacles.into_iter().map(|written| floor.moving(written)).collect(),
            sonars: self.sonars.into_iter().map(|written| floor.sonar(written)).collect(),
        })
    }
}

impl Floor {
    fn place(self, position: &Pair) -> (f64, f64) {
        ((position.x.0 - 0.5) * self.x, (position.y.0 - 0.5) * self.z)
    }

    /// The page counts `y` from the south for static obstacles, unlike for everything else.
    fn obstacle(self, WrittenStatic { name, center_position, size }: WrittenStatic) -> StaticObstacle {
        let (x, from_south) = self.place(&center_position);
        let z = -from_south;
        let (half_x, half_z) = (size.x.0 * self.x / 2.0, size.y.0 * self.z / 2.0);
        StaticObstacle { name: name.0, min_x: x - half_x, max_x: x + half_x, min_z: z - half_z, max_z: z + half_z }
    }

    fn moving(self, WrittenMoving { name, position, direction_axis, speed, range }: WrittenMoving) -> MovingObstacle {
        let (x, z) = self.place(&position);
        MovingObstacle {
            name: name.0,
            x,
            z,
            along_x: direction_axis.x,
            along_z: direction_axis.y,
            speed: speed.0,
            range: range.0,
        }
    }

    fn sonar(self, WrittenSonar { name, position, sense_axis }: WrittenSonar) -> SceneSonar {
        let (x, z) = self.place(&position);
        SceneSonar { name: name.0, x, z, sees_along_x: sense_axis.x, sees_along_z: sense_axis.y }
    }
}

#[cfg(test)]
#[path = "scene/scene_tests.rs"]
mod tests;
