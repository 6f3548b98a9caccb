//! Reading the photo that is to be shown, one at a time, where blocking is allowed. Which one that is, and whether it still is when
//! it has been read, is decided in `change_feed`.

use std::pin::Pin;

use super::super::change_feed::{ChangeFeed, PHOTO_MOST, Picture};
use crate::runtime::archive_reader::ArchiveReader;
use hallsweep_core::event::Photo;

/// What was read: the photo, if there is one that can be read.
type Looked = (Picture, Option<Photo>);

/// A photo that is being read, if one is.
#[derive(Default)]
pub(super) struct PhotoReading(Option<Pin<Box<dyn Future<Output = Looked> + Send>>>);

impl PhotoReading {
    /// Begins to read the photo that is asked for, unless one is being read.
    pub(super) fn begin(&mut self, news: &mut ChangeFeed, archive: &ArchiveReader) {
        if self.0.is_none()
            && let Some(picture) = news.poll_photo()
        {
            self.0 = Some(Box::pin(look_up(archive.clone(), picture)));
        }
    }

    /// The photo that has been read; for ever, when none is being read. May be dropped while it waits.
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
