//! Reads photos for publishing, one at a time, where blocking is allowed. `change_feed` chooses the photo. When the
//! photo has been read, `change_feed` also decides whether it is still wanted.

use std::pin::Pin;

use super::super::change_feed::{ChangeFeed, PHOTO_MOST, Picture};
use crate::runtime::archive_reader::ArchiveReader;
use hallsweep_core::event::Photo;

type Looked = (Picture, Option<Photo>);

#[derive(Default)]
pub(super) struct PhotoReading(Option<Pin<Box<dyn Future<Output = Looked> + Send>>>);

impl PhotoReading {
    pub(super) fn begin(&mut self, news: &mut ChangeFeed, archive: &ArchiveReader) {
        if self.0.is_none()
            && let Some(picture) = news.poll_photo()
        {
            self.0 = Some(Box::pin(look_up(archive.clone(), picture)));
        }
    }

    /// Waits until the photo has been read. If no photo is being read, waits for ever. Safe to cancel.
    pub(super) async fn done(&mut self) -> Looked {
        let Some(reading) = &mut self.0 else { return std::future::pending().await };
        let looked = reading.await;
        self.0 = None;
        looked
    }
}

pub(super) fn show(news: &mut ChangeFeed, (picture, photo): Looked) {
    let Some(photo) = photo else { return };
    let (luggage, size) = (picture.luggage.0, photo.bytes.len());
    if !news.handle_photo(picture, photo) && size > PHOTO_MOST {
        tracing::warn!(luggage, size_bytes = size, "a photo is not published over MQTT, because it is too large");
    }
}

async fn look_up(archive: ArchiveReader, picture: Picture) -> Looked {
    match archive.look_up(move |archive| archive.photo(picture.luggage)).await {
        Ok(photo) => (picture, photo),
        Err(error) => {
            tracing::warn!(luggage = picture.luggage.0, %error, "a photo is not published over MQTT");
            (picture, None)
        }
    }
}
