//! Decides how a base turns and drives from one place to the next. The places come from `way`.

use crate::command::Move;
use crate::effect::Action;
use crate::place::{BasePose, Place};
use crate::units::{Cell, Heading};

/// Whether a base may drive backwards into the next cell. A robot sees what it meets only when it drives forwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gear {
    /// The base turns until it faces the direction in which it drives.
    Forwards,
    /// The base may also drive backwards, into a cell that is known to be free.
    Either,
}

/// Returns the next action of a base on its way to a neighbouring place; `None` if the base is there, or if the place
/// is not beside it.
#[must_use]
pub fn steer(stands: BasePose, to: Place, gear: Gear) -> Option<Action> {
    if !stands.place.is_beside(to) {
        return None;
    }
    match (stands.place, to) {
        (Place::Cell(from), Place::Cell(to)) => {
            let wanted = Heading::ALL.into_iter().find(|heading| from.ahead(*heading) == to)?;
            Some(Action::Move(towards(stands.heading, wanted, gear)))
        }
        (Place::Cell(Cell { .. }), Place::Outside(_)) => Some(Action::Leave),
        (Place::Outside(from), Place::Outside(to)) if to > from => Some(Action::Leave),
        (Place::Outside(_), Place::Cell(_) | Place::Outside(_)) => Some(Action::Enter),
    }
}

fn towards(heading: Heading, wanted: Heading, gear: Gear) -> Move {
    match gear {
        _ if heading == wanted => Move::Forward,
        Gear::Either if heading == wanted.opposite() => Move::Backward,
        Gear::Forwards | Gear::Either if heading.right() == wanted => Move::TurnRight,
        Gear::Forwards | Gear::Either => Move::TurnLeft,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::plan::after;
    use crate::units::Pose;

    #[test]
    fn a_base_comes_to_each_cell_beside_it_and_backs_only_where_it_may() {
        for (heading, wanted) in Heading::ALL.into_iter().flat_map(|one| Heading::ALL.map(|two| (one, two))) {
            for (gear, most) in [(Gear::Forwards, 3), (Gear::Either, 2)] {
                let to = Cell::HOME.ahead(wanted);
                let (mut pose, mut moves) = (Pose { cell: Cell::HOME, heading }, Vec::new());
                while pose.cell != to {
                    let stands = BasePose { place: Place::Cell(pose.cell), heading: pose.heading };
                    let Some(Action::Move(step)) = steer(stands, Place::Cell(to), gear) else { panic!("it is beside") };
                    moves.push(step);
                    pose = after(pose, step);
                }
                assert!(moves.len() <= most, "{moves:?}");
                assert!(gear == Gear::Either || !moves.contains(&Move::Backward));
            }
        }
    }

    #[test]
    fn the_way_out_begins_and_ends_at_home() {
        let at = |place| BasePose { place, heading: Heading::South };
        let home = Place::Cell(Cell::HOME);
        assert_eq!(steer(at(home), Place::ENTRANCE, Gear::Forwards), Some(Action::Leave));
        assert_eq!(steer(at(Place::ENTRANCE), Place::Outside(2), Gear::Forwards), Some(Action::Leave));
        assert_eq!(steer(at(Place::Outside(2)), Place::ENTRANCE, Gear::Forwards), Some(Action::Enter));
        assert_eq!(steer(at(Place::ENTRANCE), home, Gear::Forwards), Some(Action::Enter));
        assert_eq!(steer(at(home), Place::Outside(2), Gear::Forwards), None);
        assert_eq!(steer(at(home), home, Gear::Forwards), None);
    }
}
