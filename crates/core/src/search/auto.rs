//! The default, for whoever does not want to choose. It is the tuned score, whatever the map shows.

use super::View;
use super::entries::Visit;
use super::scored;
use super::ways::Ways;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    scored::next(view, ways)
}
