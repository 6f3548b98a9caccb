//! The report of a mission and its record as a list, as files to be saved: the page in which the operator is stays where it is, STOP in it.
//! They are as large as the mission and written a part at a time, as fast as they are read: a few at once, each key its share. What stands in them is `report`'s business.

use std::io::{self, BufWriter, Write};
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::{StreamExt, stream};
use tokio::sync::mpsc;

use super::HttpDoor;
use super::gate::LetIn;
use super::language::Spoken;
use super::missions::unknown;
use super::problem::Problem;
use super::query::Query;
use super::reading::Number;
use crate::access::Caller;
use crate::doors::shares::{Limits, Shares};
use crate::phrases::Language;
use crate::report::{Failure, Report, list};
use crate::runtime::archive::Archive;
use hallsweep_core::units::{MissionId, Seq};

/// So many are written at once, half of them for one key; one is kept for a key that has none.
const PLACES: Limits = Limits { most: 4, of_one_key: 2, kept: 1, few: 1 };

/// So much is written before it is read,
const CHUNK: usize = 64 * 1024;
const AHEAD: usize = 4;

/// and who has read for so long reads no more of it: a large one over a slow line takes minutes.
const PATIENCE: Duration = Duration::from_secs(600);

/// Who may have one written.
#[derive(Clone, Debug)]
pub(super) struct Reports(Shares);

impl Default for Reports {
    fn default() -> Reports {
        Reports(Shares::new(PLACES))
    }
}

/// `GET missions/{id}/report`
pub(super) async fn report(
    State(door): State<HttpDoor>,
    LetIn(caller): LetIn,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Response, Problem> {
    let language = language_of(&query)?.unwrap_or(language);
    let name = Report::file_name(MissionId(id));
    send(door, &caller, id, ("text/html; charset=utf-8", name), move |archive, mission, out| {
        let report = Report::new(archive, mission, Seq(u64::MAX), language)?;
        report.map_or(Ok(()), |report| report.write(out))
    })
    .await
}

/// `GET missions/{id}/record.jsonl`
pub(super) async fn lines(
    State(door): State<HttpDoor>,
    LetIn(caller): LetIn,
    Number(id): Number,
    query: Query,
) -> Result<Response, Problem> {
    query.only(&[])?;
    let name = format!("hallsweep-mission-{id}.jsonl");
    send(door, &caller, id, ("application/jsonl", name), list::write_lines).await
}

/// `GET missions/{id}/record.csv`
pub(super) async fn table(
    State(door): State<HttpDoor>,
    LetIn(caller): LetIn,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Response, Problem> {
    let language = language_of(&query)?.unwrap_or(language);
    let name = format!("hallsweep-mission-{id}.csv");
    send(door, &caller, id, ("text/csv; charset=utf-8", name), move |archive, mission, out| {
        list::write_table(archive, mission, language, out)
    })
    .await
}

fn language_of(query: &Query) -> Result<Option<Language>, Problem> {
    query.only(&["language"])?;
    Ok(query.word("language", &Language::ALL.map(Language::tag))?.and_then(Language::tagged))
}

/// Answers with a file of a mission that is there, which is written while it is sent.
async fn send(
    door: HttpDoor,
    caller: &Caller,
    id: u64,
    (media_type, name): (&'static str, String),
    write: impl FnOnce(&dyn Archive, MissionId, &mut dyn Write) -> Result<(), Failure> + Send + 'static,
) -> Result<Response, Problem> {
    let mission = MissionId(id);
    door.archive.look_up(move |archive| archive.mission(mission)).await?.ok_or_else(|| unknown(id))?;
    let is_kept = door.archive.look_up(move |archive| archive.timeline(mission, Seq(0), 1)).await?;
    if is_kept.is_empty() {
        return Err(Problem::not_found(format!("nothing of mission {id} is kept any more: no entry of it is left")));
    }
    let place = door.reports.0.take(door.access.key_of(caller)).map_err(Problem::too_many_reports)?;
    let (parts, written) = mpsc::channel(AHEAD);
    let archive = door.archive.archive();
    tokio::task::spawn_blocking(move || {
        let mut out = BufWriter::with_capacity(CHUNK, Pipe(parts.clone()));
        let ended = write(&*archive, mission, &mut out).and_then(|()| Ok(out.flush()?));
        if let Err(failure) = ended {
            // Half a file is not to be taken for a whole one: the connection ends before its end. Whoever left hears nothing.
            tracing::debug!(%failure, mission = id, "a report or record was not written to its end");
            let _ = parts.blocking_send(Err(io::Error::other(failure)));
        }
        drop(place);
    });
    let headers = [
        (header::CONTENT_TYPE, media_type.to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    Ok((StatusCode::OK, headers, body(written)).into_response())
}

/// What is written, as it comes, until time is over.
fn body(written: mpsc::Receiver<io::Result<Bytes>>) -> Body {
    let until = Box::pin(tokio::time::sleep(PATIENCE));
    let parts = stream::unfold((written, until), |(mut written, mut until)| async move {
        let part = tokio::select! {
            biased;
            () = &mut until => Some(Err(io::ErrorKind::TimedOut.into())),
            part = written.recv() => part,
        };
        part.map(|part| (part, (written, until)))
    });
    // Who compresses it asks once more behind its end.
    Body::from_stream(parts.fuse())
}

/// The end into which is written; it fails when the other is gone.
struct Pipe(mpsc::Sender<io::Result<Bytes>>);

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let sent = self.0.blocking_send(Ok(Bytes::copy_from_slice(bytes)));
        sent.map(|()| bytes.len()).map_err(|_| io::ErrorKind::BrokenPipe.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};

    use axum::body::to_bytes;

    use super::super::testing::{TestApp, app};
    use super::*;
    use crate::api::fixture::searching;
    use crate::runtime::archive::Unreadable;
    use crate::runtime::within::within;

    /// A file that is begun and not ended before this is dropped.
    async fn begun(app: &TestApp) -> Result<(Sender<()>, Response), Problem> {
        let (end, ended) = channel::<()>();
        let write = move |_: &dyn Archive, _, out: &mut dyn Write| {
            out.write_all(b"half")?;
            let _ = ended.recv();
            Ok(())
        };
        let response = send(app.door.clone(), &Caller::Here, 1, ("text/plain", "half.txt".to_owned()), write).await?;
        Ok((end, response))
    }

    /// Safety A5.
    #[tokio::test]
    async fn a_few_are_written_at_once_and_what_has_ended_is_free() {
        let app = app(searching());
        let mut writing = Vec::new();
        for _ in 0..PLACES.most {
            writing.push(begun(&app).await.expect("there is a place"));
        }
        let refused = app.get("/missions/1/report").await;
        assert_eq!(refused.status(), 503);
        let (status, problem) = super::super::testing::read(refused).await;
        assert_eq!((status.as_u16(), &problem["code"]), (503, &"tooManyReports".into()));
        writing.clear();
        within("a place", async {
            while begun(&app).await.is_err() {
                tokio::task::yield_now().await;
            }
        })
        .await;
    }

    /// It would be taken for the whole.
    #[tokio::test]
    async fn what_was_not_written_to_its_end_does_not_end_well() {
        let app = app(searching());
        let write = |_: &dyn Archive, _, out: &mut dyn Write| {
            out.write_all(b"half")?;
            Err(Failure::Unreadable(Unreadable("a mouse was at it".to_owned())))
        };
        let response = send(app.door.clone(), &Caller::Here, 1, ("text/plain", "half.txt".to_owned()), write).await;
        let body = within("the end", to_bytes(response.expect("it begins").into_body(), usize::MAX)).await;
        assert!(body.is_err());
    }

    /// Safety A5.
    #[tokio::test(start_paused = true)]
    async fn who_has_read_for_ten_minutes_reads_no_more() {
        let (writing, written) = mpsc::channel(AHEAD);
        writing.send(Ok(Bytes::from_static(b"half"))).await.expect("there is room");
        let ended = to_bytes(body(written), usize::MAX).await;
        assert!(ended.expect_err("it never ends").to_string().contains("timed out"));
        assert!(writing.is_closed(), "and who writes hears of it");
    }

    #[tokio::test]
    async fn whoever_leaves_ends_the_writing() {
        let app = app(searching());
        let (say, said) = channel();
        let write = move |_: &dyn Archive, _, out: &mut dyn Write| {
            let failed = loop {
                if let Err(error) = out.write_all(&[0; CHUNK]) {
                    break error;
                }
            };
            let _ = say.send(failed.kind());
            Err(Failure::Unwritable(failed))
        };
        drop(send(app.door.clone(), &Caller::Here, 1, ("text/plain", "endless.txt".to_owned()), write).await);
        let kind = tokio::task::spawn_blocking(move || said.recv()).await.expect("it is waited for");
        assert_eq!(kind, Ok(io::ErrorKind::BrokenPipe));
    }
}
