//! Requests that the scanner finds in the bytes of an HTTP client: the result does not depend on how the bytes are
//! cut. Where hyper accepts the bytes, both find the same methods and targets in the same order, so the scanner
//! neither takes a piece of a body for a request nor misses a request. The first byte sets the length of the pieces.
#![no_main]

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use hallsweep_fuzz::doors::http::scanning::{Heard, Scanner, names};
use hyper::body::{Body, Bytes, Frame, Incoming};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response};
use hyper_util::rt::TokioIo;
use libfuzzer_sys::fuzz_target;
use std::pin::{Pin, pin};
use std::task::{Context, Poll};
use tokio::io::{AsyncReadExt, AsyncWriteExt};

/// Empty body of an answer.
struct Nothing;

impl Body for Nothing {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        Poll::Ready(None)
    }

    fn is_end_stream(&self) -> bool {
        true
    }
}

/// Method and target of each request that hyper accepts. The last one may have a body whose end hyper does not find.
async fn taken(bytes: &[u8]) -> Vec<(String, String)> {
    let (mut client, server) = tokio::io::duplex(bytes.len() + 1);
    let requests = Rc::new(RefCell::new(Vec::new()));
    let seen = Rc::clone(&requests);
    let service = service_fn(move |request: Request<Incoming>| {
        let seen = Rc::clone(&seen);
        async move {
            let target = request.uri().path().to_owned();
            seen.borrow_mut().push((request.method().to_string(), target));
            let mut body = pin!(request.into_body());
            while let Some(Ok(_)) = std::future::poll_fn(|cx| body.as_mut().poll_frame(cx)).await {}
            Ok::<_, Infallible>(Response::new(Nothing))
        }
    });
    client.write_all(bytes).await.expect("there is room for all");
    client.shutdown().await.expect("it is open");
    let mut http = http1::Builder::new();
    let connection = http.half_close(true).auto_date_header(false).serve_connection(TokioIo::new(server), service);
    let mut answers = Vec::new();
    // The result of the connection itself does not matter here.
    let _ = tokio::join!(connection, client.read_to_end(&mut answers));
    requests.take()
}

fn heard(bytes: &[u8], piece: usize) -> Vec<Heard> {
    let (mut scanner, mut all) = (Scanner::new("hallsweep-8080"), Vec::new());
    for mut piece in bytes.chunks(piece) {
        while !piece.is_empty() {
            let (taken, heard) = scanner.take(piece);
            assert!(taken > 0, "it goes on");
            piece = &piece[taken..];
            all.extend(heard);
        }
    }
    all
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&cut, bytes)) = bytes.split_first() else { return };
    let all = heard(bytes, usize::from(cut) + 1);
    assert_eq!(all, heard(bytes, bytes.len().max(1)), "however it is cut");
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    let taken = runtime.block_on(taken(bytes));
    let heads: Vec<_> = all.iter().filter_map(|heard| if let Heard::Head(head) = heard { Some(head) } else { None }).collect();
    assert!(heads.len() >= taken.len(), "{} of {taken:?}", heads.len());
    for (head, (method, path)) in heads.iter().zip(&taken) {
        let kept = &method.as_bytes()[..method.len().min(head.method.len())];
        assert_eq!(head.method, kept, "{taken:?}");
        for stop in names::STOPS {
            if path == stop {
                let is_safe = ["GET", "HEAD", "OPTIONS", "TRACE"].iter().any(|safe| method.eq_ignore_ascii_case(safe));
                assert_eq!(names::stop(&head.method, &head.path).is_some(), !is_safe, "{method} {path}");
            }
        }
    }
});
