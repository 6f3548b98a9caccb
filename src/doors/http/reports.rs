//! The report of a mission, and its record as a list, as downloads. The operator's page with its STOP stays open. A
//! download is as large as the record of its mission. It is written in parts, as fast as the client reads. Only a few
//! downloads run at once, and each key has a share. `report` has the contents.

use std::io::{self, BufWriter, Write};
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use futures_util::{StreamExt, stream};
use tokio::sync::mpsc;

use super::HttpDoor;
use super::language::Spoken;
use super::missions::unknown;
use super::peer::LetIn;
use super::problem::Problem;
use super::query::Query;
use super::reading::Number;
use crate::access::Caller;
use crate::doors::connection_limits::{QuotaLimits, RequestQuota};
use crate::phrases::Language;
use crate::report::{Failure, Report, list};
use crate::runtime::archive::{Archive, Span};
use hallsweep_core::units::{MissionId, Seq};

/// Limits of simultaneous downloads. A key may have at most half of them. One is reserved for a key without a
/// download.
const PLACES: QuotaLimits = QuotaLimits { most: 4, of_one_key: 2, kept: 1, few: 1 };

/// Size of a part in bytes. Up to `AHEAD` parts wait until the client has read the earlier ones.
const CHUNK: usize = 64 * 1024;
const AHEAD: usize = 4;

/// Maximum time for a download, even if its client reads slowly. A large download over a slow line takes minutes.
const PATIENCE: Duration = Duration::from_secs(600);

#[derive(Clone, Debug)]
pub(super) struct Reports(RequestQuota);

impl Default for Reports {
    fn default() -> Reports {
        Reports(RequestQuota::new(PLACES))
    }
}

pub(super) async fn report(
    door: HttpDoor,
    LetIn(caller): LetIn,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Response, Problem> {
    let language = language_of(&query)?.unwrap_or(language);
    let name = Report::file_name(MissionId(id));
    send(door, &caller, id, "text/html; charset=utf-8", name, move |archive, mission, out| {
        let report = Report::new(archive, mission, language)?;
        report.map_or(Ok(()), |report| report.write(out))
    })
    .await
}

pub(super) async fn lines(door: HttpDoor, LetIn(caller): LetIn, Number(id): Number, query: Query) -> Result<Response, Problem> {
    query.only(&[])?;
    let name = format!("hallsweep-mission-{id}.jsonl");
    send(door, &caller, id, "application/jsonl", name, list::write_lines).await
}

pub(super) async fn table(
    door: HttpDoor,
    LetIn(caller): LetIn,
    Spoken(language): Spoken,
    Number(id): Number,
    query: Query,
) -> Result<Response, Problem> {
    let language = language_of(&query)?.unwrap_or(language);
    let name = format!("hallsweep-mission-{id}.csv");
    send(door, &caller, id, "text/csv; charset=utf-8", name, move |archive, mission, out| {
        list::write_table(archive, mission, language, out)
    })
    .await
}

fn language_of(query: &Query) -> Result<Option<Language>, Problem> {
    query.only(&["language"])?;
    Ok(query.word("language", &Language::ALL.map(Language::tag))?.and_then(Language::tagged))
}

/// Answers with a file about an existing mission. The file is sent while it is being written.
async fn send(
    door: HttpDoor,
    caller: &Caller,
    id: u64,
    media_type: &'static str,
    name: String,
    write: impl FnOnce(&dyn Archive, MissionId, &mut dyn Write) -> Result<(), Failure> + Send + 'static,
) -> Result<Response, Problem> {
    let mission = MissionId(id);
    door.hall.archive.look_up(move |archive| archive.mission(mission)).await?.ok_or_else(|| unknown(id))?;
    let is_kept = door.hall.archive.look_up(move |archive| archive.timeline(mission, Span::after(Seq(0)), 1)).await?;
    if is_kept.is_empty() {
        return Err(Problem::not_found(format!("mission {id} has no stored entry any more")));
    }
    let place = door.hall.reports.0.take(door.process.access.key_of(caller)).map_err(Problem::too_many_reports)?;
    let (parts, to_be_sent) = mpsc::channel(AHEAD);
    let (sent, mut written) = mpsc::channel(1);
    tokio::spawn(hand_on(to_be_sent, sent));
    let archive = door.hall.archive.archive();
    tokio::task::spawn_blocking(move || {
        let mut out = BufWriter::with_capacity(CHUNK, Pipe(parts.clone()));
        let ended = write(&*archive, mission, &mut out).and_then(|()| Ok(out.flush()?));
        // After a failure, this drops the buffered bytes instead of writing them.
        drop(out.into_parts());
        if let Err(failure) = &ended {
            tracing::debug!(%failure, mission = id, "a report or record was not written completely");
        }
        // An error does not matter: the client may be gone.
        let _ = parts.blocking_send(ended.map(|()| Bytes::new()));
        drop(place);
    });
    // If writing fails before the first part, the client still gets an error answer.
    let first = match next(&mut written).await {
        Err(Failure::Unreadable(unreadable)) => return Err(unreadable.into()),
        Ok(part) if part.is_empty() => {
            return Err(Problem::not_found(format!("mission {id} cannot be shown: all of its entries are marked as lost")));
        }
        first => first,
    };
    let headers = [
        (header::CONTENT_TYPE, media_type.to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    Ok((StatusCode::OK, headers, body(first, written)).into_response())
}

/// A part of a file. An empty part marks the end of the file. An error says why no more parts follow.
type FilePart = Result<Bytes, Failure>;

/// Passes on the parts until the time is over. After that, writing fails, and the client sees that the file is
/// incomplete.
async fn hand_on(mut written: mpsc::Receiver<FilePart>, to: mpsc::Sender<FilePart>) {
    let all = async {
        while let Some(part) = written.recv().await {
            if to.send(part).await.is_err() {
                break;
            }
        }
    };
    let _ = tokio::time::timeout(PATIENCE, all).await;
}

async fn next(written: &mut mpsc::Receiver<FilePart>) -> FilePart {
    written.recv().await.unwrap_or_else(|| Err(Failure::Unwritable(io::ErrorKind::TimedOut.into())))
}

fn body(first: FilePart, written: mpsc::Receiver<FilePart>) -> Body {
    let first = stream::once(async { first });
    let further = stream::unfold(Some(written), |written| async move {
        let mut written = written?;
        match next(&mut written).await {
            Ok(part) if part.is_empty() => None,
            Ok(part) => Some((Ok(part), Some(written))),
            Err(failure) => Some((Err(failure), None)),
        }
    });
    let parts = first.chain(further).map(|part| part.map_err(io::Error::other));
    // The compression layer polls once more after the end of the stream.
    Body::from_stream(parts.fuse())
}

/// The writing end of the channel for parts. Writing fails when the reading end is gone, or when the time is over.
struct Pipe(mpsc::Sender<FilePart>);

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
    use crate::api::tests::fixture::searching;
    use crate::runtime::archive::Unreadable;
    use crate::runtime::tests::within::within;

    fn half(
        app: &TestApp,
        write: impl FnOnce(&dyn Archive, MissionId, &mut dyn Write) -> Result<(), Failure> + Send + 'static,
    ) -> impl Future<Output = Result<Response, Problem>> {
        send(app.door.clone(), &Caller::Here, 1, "text/plain", "half.txt".to_owned(), write)
    }

    static PART: [u8; CHUNK] = [b'x'; CHUNK];

    fn endless(_: &dyn Archive, _: MissionId, out: &mut dyn Write) -> Result<(), Failure> {
        loop {
            out.write_all(&PART)?;
        }
    }

    /// Begins a download that does not end before the returned value is dropped.
    async fn begun(app: &TestApp) -> Result<(Sender<()>, Response), Problem> {
        let (end, ended) = channel::<()>();
        let write = move |_: &dyn Archive, _, out: &mut dyn Write| {
            out.write_all(&PART)?;
            let _ = ended.recv();
            Ok(())
        };
        Ok((end, half(app, write).await?))
    }

    async fn freed(app: &TestApp) {
        within("a place", async {
            while begun(app).await.is_err() {
                tokio::task::yield_now().await;
            }
        })
        .await;
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
        freed(&app).await;
    }

    fn fails(after: &'static [u8]) -> impl FnOnce(&dyn Archive, MissionId, &mut dyn Write) -> Result<(), Failure> {
        move |_, _, out| {
            out.write_all(after)?;
            Err(Failure::Unreadable(Unreadable("a mouse was at it".to_owned())))
        }
    }

    #[tokio::test]
    async fn what_cannot_be_read_is_said_while_nothing_was_sent() {
        let app = app(searching());
        let failed = half(&app, fails(b"half")).await.expect_err("it cannot be read");
        let (status, problem) = super::super::testing::read(failed.into_response()).await;
        assert_eq!((status.as_u16(), &problem["code"]), (503, &"unreadable".into()));
        assert!(problem["detail"].as_str().is_some_and(|words| words.contains("a mouse was at it")), "{problem}");
        let none = half(&app, |_, _, _| Ok(())).await.expect_err("there is nothing");
        assert_eq!(none.into_response().status(), 404);
    }

    /// Without an error at the end, an incomplete file would be taken for a complete one.
    #[tokio::test]
    async fn what_was_not_written_to_its_end_does_not_end_well() {
        let app = app(searching());
        let response = half(&app, fails(&PART)).await.expect("it begins");
        assert!(within("the end", to_bytes(response.into_body(), usize::MAX)).await.is_err());
    }

    /// Safety A5.
    #[tokio::test(start_paused = true)]
    async fn who_reads_nothing_keeps_no_place_for_longer_than_ten_minutes() {
        let app = app(searching());
        let mut unread = Vec::new();
        for _ in 0..PLACES.most {
            unread.push(half(&app, endless).await.expect("there is a place"));
        }
        assert!(begun(&app).await.is_err(), "all are taken");
        tokio::time::advance(PATIENCE).await;
        freed(&app).await;
        for response in unread {
            assert!(to_bytes(response.into_body(), usize::MAX).await.is_err(), "it is no whole file");
        }
    }

    /// Safety A5.
    #[tokio::test(start_paused = true)]
    async fn who_has_read_for_ten_minutes_reads_no_more() {
        let app = app(searching());
        let mut reading = half(&app, endless).await.expect("it begins").into_body().into_data_stream();
        for _ in 0..2 * AHEAD {
            assert!(reading.next().await.expect("it goes on").is_ok());
        }
        tokio::time::advance(PATIENCE).await;
        let mut last = Ok(Bytes::new());
        while let Some(part) = reading.next().await {
            last = part;
        }
        assert!(last.expect_err("it does not end well").to_string().contains("timed out"));
    }

    #[tokio::test]
    async fn whoever_leaves_ends_the_writing() {
        let app = app(searching());
        let (say, said) = channel();
        let write = move |archive: &dyn Archive, mission, out: &mut dyn Write| {
            let failed = endless(archive, mission, out);
            let _ = say.send(matches!(&failed, Err(Failure::Unwritable(error)) if error.kind() == io::ErrorKind::BrokenPipe));
            failed
        };
        drop(half(&app, write).await);
        let is_broken = tokio::task::spawn_blocking(move || said.recv()).await.expect("it is waited for");
        assert_eq!(is_broken, Ok(true));
    }
}
