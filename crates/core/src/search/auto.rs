//! The default: of the others the one that evaluation has shown to be the best for what is asked for.

use super::View;
use super::entries::Visit;
use super::scored;
use super::ways::Ways;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    scored::next(view, ways)
}
