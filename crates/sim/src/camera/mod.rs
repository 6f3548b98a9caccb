//! The simulated camera: makes an encoded picture from the robot's real place. The simulator decides when a photo is
//! taken and whether it fails.

mod canvas;
mod caption;
mod font;
mod luggage;
mod picture;
mod plan;
mod room;
mod solid;
mod space;
mod surface;
mod view;

pub use plan::plan;

use std::sync::Arc;

use png::{BitDepth, ColorType, Compression, Encoder};

use super::drive::BodyPose;
use super::hall::{Hall, Truth};
use super::settings::Camera;
use hallsweep_core::effect::Stamp;
use hallsweep_core::event::Photo;
use hallsweep_core::units::{Cell, Pose};

/// Greatest distance from the robot to the photographed thing, in cells. It equals the longest range to which the
/// sonar can be set.
const SIGHT: u16 = 7;

/// A photo that was taken, but not developed (drawn and encoded). It contains everything needed to draw the picture
/// on any thread.
#[derive(Clone, Debug)]
pub struct Exposure {
    hall: Arc<Hall>,
    camera: Camera,
    body: BodyPose,
    subject: Cell,
    /// Distance from the robot to the photographed thing, in cells.
    away: u16,
    stamp: Stamp,
}

impl Exposure {
    /// Takes a photo. The robot is really at `body`, but believes that it is at `pose`. The stamp is written on the
    /// photo.
    #[must_use]
    pub fn new(hall: Arc<Hall>, camera: Camera, body: BodyPose, pose: Pose, stamp: Stamp) -> Exposure {
        let away = away(&hall, pose);
        Exposure { subject: pose.cell.onward(pose.heading, away), hall, camera, body, away, stamp }
    }

    /// Draws and encodes the picture. A rendered picture takes about 20 ms.
    #[must_use]
    pub fn develop(&self) -> Photo {
        let bytes = match self.camera {
            Camera::Rendered => picture::picture(self),
            Camera::Stub => self.stub(),
        };
        Photo { bytes: bytes.into(), media_type: "image/png" }
    }

    /// The smallest picture that still distinguishes pieces of luggage. It has two pixels: the piece's colour and its
    /// number.
    fn stub(&self) -> Vec<u8> {
        let [number, colour] = match self.hall.truth(self.subject) {
            Truth::Luggage(piece) => {
                let [_, high, middle, low] = piece.0.to_be_bytes();
                let colour = self.hall.bag(piece).map_or([0; 3], |bag| [bag.colour.red, bag.colour.green, bag.colour.blue]);
                [[high, middle, low], colour]
            }
            Truth::Wall => [[0; 3], [0xd0; 3]],
            Truth::Free => [[0; 3], [0x80; 3]],
        };
        png(2, 1, &[colour, number].concat())
    }
}

/// Distance to the first thing ahead within `SIGHT`, in cells. Returns 1 if there is no such thing.
fn away(hall: &Hall, pose: Pose) -> u16 {
    let is_taken = |cells: &u16| hall.truth(pose.cell.onward(pose.heading, *cells)) != Truth::Free;
    (1..=SIGHT).find(is_taken).unwrap_or(1)
}

fn png(width: u32, height: u32, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().expect("a header of a valid size can be written to memory");
    writer.write_image_data(pixels).expect("three bytes are given for every pixel");
    writer.finish().expect("memory can be written to");
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Heading, Piece, WallTime};

    /// Takes a photo of each piece of the hall `airport`, from every free cell beside the piece.
    fn photos(camera: Camera) -> Vec<(String, Vec<u8>)> {
        let hall = Arc::new(Hall::named_or_file("airport").unwrap());
        let reachable = hall.reachable();
        let mut photos = Vec::new();
        for bag in hall.pieces() {
            let sides = Heading::ALL.into_iter().flat_map(|heading| bag.cells.iter().map(move |cell| (*cell, heading)));
            for (cell, heading) in sides {
                let pose = Pose { cell: cell.ahead(heading.opposite()), heading };
                if reachable.contains(&pose.cell) {
                    let stamp = Stamp { pose, wall: WallTime { unix_ms: 1_795_249_220_000, offset_s: 0 } };
                    let body = BodyPose::centred(pose, hall.cell_m());
                    let photo = Exposure::new(Arc::clone(&hall), camera, body, pose, stamp).develop();
                    photos.push((format!("{}-{}-{}", bag.piece.0, bag.name, heading.name()), photo.bytes.to_vec()));
                }
            }
        }
        photos
    }

    #[test]
    fn every_photo_is_a_png_of_the_right_size_and_like_no_other() {
        let photos = photos(Camera::Rendered);
        assert!(photos.len() > 15);
        let different: std::collections::BTreeSet<&Vec<u8>> = photos.iter().map(|(_, bytes)| bytes).collect();
        assert_eq!(different.len(), photos.len());
        for (_, bytes) in &photos {
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            assert_eq!((info.width, info.height), (640, 480));
            assert!(bytes.len() < 250_000, "{} bytes", bytes.len());
        }
    }

    #[test]
    fn the_same_photo_twice_is_the_same_byte_for_byte() {
        assert_eq!(photos(Camera::Rendered), photos(Camera::Rendered));
    }

    #[test]
    fn a_picture_is_of_the_first_thing_ahead() {
        let hall = Hall::from_rows("test", &["S..a"]).unwrap();
        let facing = |heading| Pose { cell: Cell::HOME, heading };
        assert_eq!((away(&hall, facing(Heading::East)), away(&hall, facing(Heading::South))), (3, 1));
        let long = Hall::from_rows("test", &["S........."]).unwrap();
        assert_eq!(away(&long, facing(Heading::East)), 1, "nothing is in sight");
    }

    /// Takes a photo of a piece from its south side.
    fn from_south(hall: Hall, number: u32) -> Vec<u8> {
        let cell = hall.bag(Piece(number)).unwrap().cells[0];
        let pose = Pose { cell: cell.ahead(Heading::South), heading: Heading::North };
        let stamp = Stamp { pose, wall: WallTime { unix_ms: 1_795_249_220_000, offset_s: 0 } };
        let body = BodyPose::centred(pose, hall.cell_m());
        Exposure::new(Arc::new(hall), Camera::Rendered, body, pose, stamp).develop().bytes.to_vec()
    }

    #[test]
    fn an_exercise_shows_on_every_photo_and_a_test_piece_on_its_own() {
        let hall = |marks: &str| {
            Hall::parse("test.toml", &format!("drawing = \"\"\"\n......\n.a....\n......\n..S...\n......\n\"\"\"\n[[luggage]]\nmark = \"a\"\nkind = \"suitcase\"\ncolour = \"red\"\n{marks}"))
                .unwrap()
        };
        assert_eq!(from_south(hall(""), 1), from_south(hall("dangerous = true\n"), 1), "no picture outside exercises tells");
        let pictures: Vec<(bool, Vec<u8>)> = (0..20)
            .map(|seed| hall("").with_tests(1, seed).unwrap())
            .filter_map(|exercise| {
                let piece = exercise.pieces().iter().find(|bag| bag.cells == [Cell::new(-1, -2)])?.piece;
                let is_met = exercise.truth(Cell::new(-1, -1)) == Truth::Free;
                is_met.then(|| (exercise.is_dangerous(piece), from_south(exercise.clone(), piece.0)))
            })
            .collect();
        let plain = from_south(hall(""), 1);
        assert!(pictures.iter().all(|(_, picture)| *picture != plain), "the caption says EXERCISE");
        let of =
            |is_test: bool| pictures.iter().filter(|(test, _)| *test == is_test).map(|(_, picture)| picture).collect::<Vec<_>>();
        assert!(!of(true).is_empty() && !of(false).is_empty() && of(true).iter().all(|picture| !of(false).contains(picture)));
    }

    #[test]
    fn stubs_of_different_bags_differ() {
        let stubs: std::collections::BTreeSet<Vec<u8>> = photos(Camera::Stub).into_iter().map(|(_, bytes)| bytes).collect();
        assert_eq!(stubs.len(), Hall::named_or_file("airport").unwrap().pieces().len());
    }
}
