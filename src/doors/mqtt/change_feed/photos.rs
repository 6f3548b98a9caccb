//! Decides which photo is the last one, and whether it still has to be published. The caller reads photos from the
//! archive, because reading may need the disk.

use bytes::Bytes;

use super::pieces;
use hallsweep_core::event::Photo;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::Luggage;

/// Maximum size of a published photo in bytes. With its topic a photo must fit into a packet of 1 MiB. Careful
/// brokers accept no larger packets.
pub const PHOTO_MOST: usize = 1024 * 1024 - 1024;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picture {
    pub luggage: LuggageId,
    /// 1 for the first photo of a piece, and one more after each retake.
    pub take: u32,
}

#[derive(Default)]
pub(super) struct Photos {
    newest: Option<Picture>,
    asked: Option<Picture>,
    shown: Option<(Picture, Bytes)>,
    pub(super) is_due: bool,
}

impl Photos {
    /// Notes which photo is the newest. Of several changed photos, the one of the piece with the highest number
    /// counts. In the first state, it is the photo of the last piece that has one.
    pub(super) fn handle_state(&mut self, older: Option<&Snapshot>, newer: &Snapshot) {
        let Some(older) = older else {
            self.newest = newer.luggage.iter().rev().find_map(|piece| picture(piece));
            return;
        };
        let differs = |earlier: &Luggage, later: &Luggage| picture(earlier) != picture(later);
        self.newest = pieces::changed(older, newer, differs).filter_map(|piece| picture(piece)).last().or(self.newest);
    }

    pub(super) fn poll(&mut self) -> Option<Picture> {
        if self.newest == self.asked {
            return None;
        }
        self.asked = self.newest;
        self.asked
    }

    pub(super) fn handle(&mut self, picture: Picture, photo: Photo) -> bool {
        let is_wanted = self.newest == Some(picture) && photo.bytes.len() <= PHOTO_MOST;
        if is_wanted {
            self.shown = Some((picture, Bytes::from_owner(photo.bytes)));
            self.is_due = true;
        }
        is_wanted
    }

    pub(super) fn take(&mut self) -> Option<Bytes> {
        self.is_due = false;
        self.shown.as_ref().map(|(_, bytes)| bytes.clone())
    }

    /// Publishes the photo again. A photo that was never read is requested again.
    pub(super) fn renew(&mut self) {
        self.is_due = self.shown.is_some();
        self.asked = self.shown.as_ref().map(|(picture, _)| *picture);
    }
}

fn picture(luggage: &Luggage) -> Option<Picture> {
    luggage.take().ok().map(|take| Picture { luggage: luggage.id, take })
}
