//! `GET map/hall.*`: the map as a file for another program. Writing a large hall takes a tenth of a second. One file
//! is written at a time, and cached until the map changes. Many readers therefore occupy only one thread, and never a
//! thread that carries out a STOP (safety S7). `api::map_files` has the contents.

use std::collections::HashMap;
use std::sync::Arc;

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use tokio::sync::Mutex;

use super::HttpDoor;
use super::etag::{conditional, is_known, tag};
use super::problem::Problem;
use crate::api::map_files::MapFileRow;
use hallsweep_core::units::Revision;

/// The newest copy of each file, by the file's name. The lock is held while a file is written.
#[derive(Clone, Debug, Default)]
pub(super) struct MapFiles(Arc<Mutex<HashMap<&'static str, MapFile>>>);

/// A file at one revision of the map. All answers share its bytes.
#[derive(Clone, Debug)]
struct MapFile {
    revision: Revision,
    bytes: Bytes,
}

pub(super) async fn map_file(row: &'static MapFileRow, door: &HttpDoor, headers: &HeaderMap) -> Result<Response, Problem> {
    let (run, asked) = {
        let snapshot = door.hall.handle.snapshot();
        (Arc::clone(&snapshot.run), row.revision(&snapshot))
    };
    let file = if is_known(headers, &tag(&run, asked, row.name)) {
        MapFile { revision: asked, bytes: Bytes::new() }
    } else {
        door.map_file(row, asked).await?
    };
    let tag = tag(&run, file.revision, row.name);
    Ok(conditional(headers, &tag, || ([(header::CONTENT_TYPE, row.media_type)], file.bytes).into_response()))
}

impl HttpDoor {
    /// Returns the cached file if it is new enough for the request. Otherwise writes a file of the newest map, which
    /// all waiting requests then get too.
    async fn map_file(&self, row: &'static MapFileRow, asked: Revision) -> Result<MapFile, Problem> {
        let mut files = Arc::clone(&self.hall.map_files.0).lock_owned().await;
        if let Some(file) = files.get(row.name).filter(|file| file.revision >= asked) {
            return Ok(file.clone());
        }
        let door = self.clone();
        // The lock is released when the file is written, even if nobody waits for that file any more.
        let writing = tokio::task::spawn_blocking(move || {
            let snapshot = door.hall.handle.snapshot();
            let (hall, cell_m) = door.hall.place();
            let bytes = row.written(&hall, cell_m, &snapshot).into();
            let file = MapFile { revision: row.revision(&snapshot), bytes };
            files.insert(row.name, file.clone());
            file
        });
        writing.await.map_err(|_| Problem::internal())
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::super::testing::app;
    use super::*;
    use crate::api::map_files::FILES;
    use crate::api::tests::fixture::{searching, touch};
    use crate::runtime::tests::within::within;
    use hallsweep_core::snapshot::Snapshot;
    use hallsweep_core::world::resource::Resource;

    const IMAGE: &MapFileRow = &FILES[3];

    /// Safety S7.
    #[tokio::test]
    async fn a_file_is_written_once_however_often_it_is_asked_for_and_anew_when_the_map_is_another() {
        let app = app(searching());
        let first = app.door.map_file(IMAGE, Revision(20)).await.expect("it is written");
        let again = app.door.map_file(IMAGE, Revision(20)).await.expect("it is there");
        assert_eq!(first.bytes.as_ptr(), again.bytes.as_ptr());
        let mut newer = Snapshot::clone(&app.publish.borrow());
        touch(&mut newer, 21, &[Resource::Map]);
        app.publish.send_replace(Arc::new(newer));
        let newer = app.door.map_file(IMAGE, Revision(21)).await.expect("it is written");
        assert_eq!((first.revision, newer.revision), (Revision(20), Revision(21)));
        let late = app.door.map_file(IMAGE, Revision(20)).await.expect("it is there");
        assert_eq!(late.bytes.as_ptr(), newer.bytes.as_ptr(), "who asked before it changed gets the newer one");
    }

    /// Safety S7: if a client disconnects, the next file is still not written before this one is complete.
    #[tokio::test]
    async fn one_is_written_at_a_time_also_for_those_who_have_gone() {
        let app = app(searching());
        drop(app.door.map_file(IMAGE, Revision(20)).now_or_never());
        let files = within("its turn", app.door.hall.map_files.0.lock()).await;
        assert!(files[IMAGE.name].bytes.starts_with(b"P5\n6 5\n"));
    }

    #[tokio::test]
    async fn the_map_is_there_as_files_of_other_programs() {
        let app = app(searching());
        for (name, media_type, begins) in [
            ("hall.toml", "application/toml", "name = "),
            ("hall.map", "text/plain; charset=utf-8", "type octile\nheight 5\nwidth 6\nmap\n"),
            ("hall.yaml", "application/yaml", "image: hall.pgm\n"),
            ("hall.pgm", "image/x-portable-graymap", "P5\n6 5\n255\n"),
            ("hall.txt", "text/plain; charset=utf-8", "|r, 1, 1, X, 1, X, \n"),
        ] {
            let path = format!("/api/v1/map/{name}");
            let response = app.get(&path).await;
            let tag = response.headers()["etag"].to_str().unwrap().to_owned();
            assert_eq!((response.status().as_u16(), &response.headers()["content-type"]), (200, &media_type.parse().unwrap()));
            let bytes = axum::body::to_bytes(response.into_body(), 10_000).await.unwrap();
            assert!(bytes.starts_with(begins.as_bytes()), "{name}");
            assert_eq!(app.send("GET", &path, &[("if-none-match", &tag)], "").await.status(), 304, "{name}");
        }
        assert_eq!(app.get("/api/v1/map/hall.gif").await.status(), 404);
    }
}
