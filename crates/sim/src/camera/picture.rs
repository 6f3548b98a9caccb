//! Assembles a picture: the room, the luggage in view with its shadows, the caption.

use std::collections::BTreeSet;

use super::super::bag::Bag;
use super::super::hall::{Hall, Truth};
use super::canvas::Canvas;
use super::luggage::{Model, add_device, model};
use super::solid::{self, Placement};
use super::space::vector;
use super::view::{HEIGHT, View, WIDTH};
use super::{Exposure, caption, png, room};
use hallsweep_core::units::{Cell, Piece};

/// Greatest distance at which luggage is drawn, in cells. Luggage further away would cover only a few pixels.
const SIGHT: i32 = 12;

/// Maximum number of pieces that are drawn, nearest first. Further pieces would be hidden behind these.
const PIECES: usize = 24;

pub(super) fn picture(exposure: &Exposure) -> Vec<u8> {
    let hall = &exposure.hall;
    let view = View::of(exposure.body, hall.cell_m(), exposure.away);
    let mut canvas = Canvas::new();
    room::draw(&mut canvas, hall, &view);
    let pieces: Vec<(Placement, Model)> = in_view(hall, &view).into_iter().flat_map(|bag| placed(hall, bag)).collect();
    for (place, model) in &pieces {
        solid::draw_shadow(&mut canvas, &view, *place, model.foot);
    }
    let solids = pieces.iter().flat_map(|(place, model)| model.solids.iter().map(move |solid| (place, solid)));
    for (number, (place, solid)) in (1..).zip(solids) {
        solid::draw(&mut canvas, &view, *place, solid, number);
    }
    canvas.soften_outlines();
    caption::draw(&mut canvas, hall, exposure.stamp);
    let size = |pixels: usize| u32::try_from(pixels).expect("a picture is a few hundred pixels wide");
    png(size(WIDTH), size(HEIGHT), &canvas.into_bytes())
}

/// The pieces ahead of the camera, nearest first.
fn in_view<'a>(hall: &'a Hall, view: &View) -> Vec<&'a Bag> {
    let here = Cell::new(whole(view.eye.x), whole(view.eye.y));
    let around = (-SIGHT..=SIGHT).flat_map(|dy| (-SIGHT..=SIGHT).map(move |dx| Cell::new(here.x + dx, here.y + dy)));
    let seen: BTreeSet<Piece> = around
        .filter(|cell| view.depth(point(*cell)) > 0.0)
        .filter_map(|cell| match hall.truth(cell) {
            Truth::Luggage(piece) => Some(piece),
            Truth::Free | Truth::Wall => None,
        })
        .collect();
    let mut bags: Vec<&Bag> = seen.into_iter().filter_map(|piece| hall.bag(piece)).collect();
    let nearness = |bag: &Bag| bag.cells.iter().map(|cell| (point(*cell) - view.eye).length()).fold(f32::INFINITY, f32::min);
    bags.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
    bags.truncate(PIECES);
    bags
}

/// The models of a piece. A piece in a straight row of cells has one model. Any other piece has one model on each
/// cell.
fn placed(hall: &Hall, bag: &Bag) -> Vec<(Placement, Model)> {
    let mut models = placed_plain(hall, bag);
    if let Some((_, model)) = models.first_mut().filter(|_| hall.is_exercise() && bag.dangerous) {
        add_device(model);
    }
    models
}

fn placed_plain(hall: &Hall, bag: &Bag) -> Vec<(Placement, Model)> {
    let (Some(first), Some(last)) = (bag.cells.first(), bag.cells.last()) else { return Vec::new() };
    if first.y == last.y && bag.cells.iter().all(|cell| cell.y == first.y) || bag.cells.iter().all(|cell| cell.x == first.x) {
        let foot = (point(*first) + point(*last)) * 0.5;
        let length = (point(*last) - point(*first)).length() + 1.0;
        vec![(Placement { foot, turn: turn(hall, bag, *first, *last) }, model(bag, length))]
    } else {
        let part = |cell: &Cell| (Placement { foot: point(*cell), turn: turn(hall, bag, *cell, *cell) }, model(bag, 1.0));
        bag.cells.iter().map(part).collect()
    }
}

/// Returns cosine and sine of the piece's angle. A long piece lies along its cells. A piece on one cell turns its
/// broad side to a free neighbouring cell. This piece is also turned by a small angle that depends on its number.
#[expect(clippy::cast_precision_loss, reason = "a piece is turned by a handful of steps")]
fn turn(hall: &Hall, bag: &Bag, first: Cell, last: Cell) -> (f32, f32) {
    let free = |cell: Cell| hall.truth(cell) == Truth::Free;
    let open_north_or_south = free(Cell::new(first.x, first.y - 1)) || free(Cell::new(first.x, first.y + 1));
    let quarter = std::f32::consts::FRAC_PI_2;
    let angle = if first == last {
        let own = 0.24 + 0.06 * (bag.piece.0 % 5) as f32;
        let side = if bag.piece.0.is_multiple_of(2) { own } else { -own };
        side + if open_north_or_south { 0.0 } else { quarter }
    } else if first.x == last.x {
        quarter
    } else {
        0.0
    };
    (angle.cos(), angle.sin())
}

#[expect(clippy::cast_precision_loss, reason = "halls are a few thousand cells wide")]
const fn point(cell: Cell) -> super::space::Vector {
    vector(cell.x as f32, cell.y as f32, 0.0)
}

#[expect(clippy::cast_possible_truncation, reason = "halls are a few thousand cells wide, and a cast saturates")]
fn whole(place: f32) -> i32 {
    place.round() as i32
}
