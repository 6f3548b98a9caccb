//! Tests of the robot's start in maps that do not set it, and of what is reported about unreachable parts of the
//! hall.

use proptest::prelude::*;

use super::{Hall, Truth};
use hallsweep_core::state::Reach;
use hallsweep_core::units::Cell;

fn movingai(rows: &[String]) -> String {
    let rows: String = rows.iter().map(|row| format!("{row}\n")).collect();
    format!("type octile\nheight {}\nwidth {}\nmap\n{rows}", rows.lines().count(), rows.lines().next().unwrap_or("").len())
}

/// A ROS map with one pixel per cell. The world's (0, 0) is at `world`, in pixels from the south-west corner.
fn ros(rows: &[String], world: (f64, f64)) -> Result<Hall, String> {
    let pixels: Vec<u8> = rows.iter().flat_map(|row| row.bytes().map(|mark| if mark == b'.' { 254 } else { 0 })).collect();
    let (x, y) = (-world.0 * 0.5, -world.1 * 0.5);
    let yaml =
        format!("image: m.pgm\nresolution: 0.5\norigin: [{x}, {y}, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
    let image = super::pgm::write(rows[0].len(), &pixels);
    Hall::parse_occupancy("m.yaml", &yaml, "m.pgm", &image, None).map_err(|error| error.to_string())
}

/// The sizes of the connected parts of the floor. Unlike the code under test, it joins neighbouring cells one by one.
fn parts(rows: &[String]) -> Vec<usize> {
    let width = rows[0].len();
    let marks: Vec<u8> = rows.iter().flat_map(|row| row.bytes()).collect();
    let mut of: Vec<usize> = (0..marks.len()).collect();
    let join = |of: &mut Vec<usize>, one: usize, other: usize| {
        let (from, to) = (of[one], of[other]);
        of.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
    };
    for place in (0..marks.len()).filter(|place| marks[*place] == b'.') {
        if place % width > 0 && marks[place - 1] == b'.' {
            join(&mut of, place, place - 1);
        }
        if place >= width && marks[place - width] == b'.' {
            join(&mut of, place, place - width);
        }
    }
    (0..marks.len()).map(|part| of.iter().zip(&marks).filter(|(of, mark)| **of == part && **mark == b'.').count()).collect()
}

fn drawings() -> impl Strategy<Value = Vec<String>> {
    (1usize..14).prop_flat_map(|width| {
        let row = prop::collection::vec(prop::sample::select(vec!['.', '.', '.', '@', '@', 'T']), width);
        prop::collection::vec(row.prop_map(String::from_iter), 1..12)
    })
}

proptest! {
    #[test]
    fn a_map_that_does_not_say_where_the_robot_starts_is_started_in_its_largest_part(rows in drawings()) {
        let sizes = parts(&rows);
        let (most, free) = (sizes.iter().copied().max().unwrap_or(0), sizes.iter().sum::<usize>());
        let reach = Reach { reachable: u32::try_from(most).unwrap(), free: u32::try_from(free).unwrap() };
        // The world's (0, 0) lies outside the image of the ROS map.
        let maps = [Hall::parse("m.map", &movingai(&rows)).map_err(|error| error.to_string()), ros(&rows, (-3.0, 2.0))];
        for hall in maps {
            match hall {
                Ok(hall) => {
                    prop_assert_eq!((hall.reach(), hall.reachable().len(), hall.truth(Cell::HOME)), (reach, most, Truth::Free));
                    prop_assert_eq!(hall.unreachable_cells().len(), free - most);
                }
                Err(said) => {
                    prop_assert_eq!(most, 0);
                    prop_assert!(said.contains("no free cell"), "{}", said);
                }
            }
        }
    }

    #[test]
    fn the_robot_starts_where_it_is_told_or_is_told_that_no_free_cell_is_there(
        rows in drawings(),
        column in 0u32..16,
        row in prop_oneof![0u32..14, Just(u32::MAX)],
    ) {
        let Ok(hall) = Hall::parse("m.map", &movingai(&rows)) else { return Ok(()) };
        let mark = rows.get(row as usize).and_then(|marks| marks.as_bytes().get(column as usize));
        match hall.clone().starting_at((column, row)) {
            Ok(started) => {
                prop_assert_eq!(mark, Some(&b'.'));
                prop_assert_eq!(started.home(), Cell::new(column.cast_signed(), row.cast_signed()));
                prop_assert!(started.rows().eq(hall.rows()), "the drawing is the same");
                for bag in started.pieces() {
                    prop_assert!(bag.cells.iter().all(|cell| started.truth(*cell) == Truth::Luggage(bag.piece)));
                }
            }
            Err(fault) => {
                prop_assert_ne!(mark, Some(&b'.'));
                let said = format!("the start {column},{row} is not a free cell of this hall of ");
                prop_assert!(fault.to_string().starts_with(&said), "{}", fault);
            }
        }
    }
}

#[test]
fn a_ros_map_starts_at_world_nought_where_that_is_free() {
    let rows = ["....@..", "....@..", "@@@@@.."].map(str::to_owned);
    let home = |world| ros(&rows, world).unwrap().home();
    // The world's (0, 0) lies in a corner of a pixel, in its middle, or almost on a border, as rounded decimals do.
    for (world, cell) in [((5.0, 0.0), (5, 2)), ((6.5, 1.5), (6, 1)), ((5.999_99, 2.000_01), (6, 0)), ((0.0, 1.0), (0, 1))] {
        assert_eq!(home(world), Cell::new(cell.0, cell.1), "{world:?}");
    }
    for walled_or_outside in [(4.5, 1.5), (0.0, 0.0), (7.0, 0.0), (-0.5, 1.0), (1.0, 3.0), (1e12, 1.0), (0.5, -1e300)] {
        assert_eq!(home(walled_or_outside), Cell::new(0, 0), "{walled_or_outside:?}: the largest part");
    }
}

#[test]
fn of_parts_of_one_size_the_north_western_is_chosen_and_in_it_the_nearest_cell() {
    let home = |rows: &[&str]| {
        let rows: Vec<String> = rows.iter().map(|row| (*row).to_owned()).collect();
        Hall::parse("m.map", &movingai(&rows)).unwrap().home()
    };
    assert_eq!(home(&["@.@..", "@.@.."]), Cell::new(3, 0));
    assert_eq!(home(&["..@..", "@@@@@"]), Cell::new(0, 0));
    assert_eq!(home(&["@@.@", "@..@", "...@"]), Cell::new(2, 0), "of equals the northernmost");
}
