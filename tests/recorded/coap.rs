//! The CoAP door as its clients see it, before answers are cut into blocks: code, options and payload of every
//! resource, in each format that discovery lists.

use std::sync::Arc;

use super::book::{Book, readable};
use super::doors::{
    Application, ArchiveReader, CoapRequest, CoapResponse, Conditions, Format, Method, Reply, Resources, Snapshot,
};
use super::test_app::TestApp;

/// Every format of this door, and one that the door does not have.
const FORMATS: [Format; 9] = [
    Format::TEXT,
    Format::LINKS,
    Format::BYTES,
    Format::PNG,
    Format::JSON,
    Format::CBOR,
    Format::SENML_JSON,
    Format::PROBLEM,
    Format(9999),
];

/// A door that is called without sockets.
pub(crate) struct Coap {
    resources: Resources,
}

impl Coap {
    /// Creates a door of this app; `manual_driving` sets whether old clients may drive.
    pub(crate) fn new(app: &TestApp, manual_driving: bool) -> Coap {
        let archive = ArchiveReader::new(app.memory.archive());
        Coap { resources: Resources::new(app.handle.clone(), archive, manual_driving) }
    }

    /// Sends a request and returns its answer, followed by what an observer would get.
    pub(crate) async fn ask(&self, request: &CoapRequest) -> (bool, String) {
        let answer = match self.resources.answer(request) {
            Reply::Now(answer) => answer,
            Reply::Later(answer) => answer.await,
        };
        let first = Arc::clone(&answer.response);
        let watched: String = answer
            .observed
            .iter()
            .map(|seen| if *seen == first { "\n(observed)".to_owned() } else { format!("\n(observed) {}", shown(seen)) })
            .collect();
        (first.code.is_success(), shown(&first) + &watched)
    }

    /// Records every resource that shows a state, in each of its formats; single pieces only if `is_worth` is set.
    pub(crate) async fn look(&self, book: &mut Book, state: &Snapshot, is_worth: bool) {
        self.resources.handle_change();
        for (path, formats) in self.discovered() {
            let ids: Vec<u64> = if path.contains("{id}") && is_worth {
                state.luggage.iter().map(|piece| piece.id.0).chain([999]).collect()
            } else {
                vec![0]
            };
            if path.contains("{id}") && !is_worth {
                continue;
            }
            for id in ids {
                self.look_at(book, &path.replace("{id}", &id.to_string()), &formats, is_worth).await;
            }
        }
    }

    async fn look_at(&self, book: &mut Book, path: &str, formats: &[Format], is_worth: bool) {
        for accept in formats.iter().copied().map(Some).chain(is_worth.then_some(None)) {
            let request = CoapRequest { accept, ..request(Method::Get, path, None, "") };
            let (_, said) = self.ask(&request).await;
            let format = accept.map_or("any format".to_owned(), |format| format.to_string());
            book.show("coap", &format!("GET {path} · {format}"), said.as_bytes());
            if is_worth && accept.is_none() {
                let things = self.resources.things(&request);
                let things: Vec<String> = things.iter().map(|thing| shown(thing)).collect();
                book.show("coap", &format!("things of {path}"), things.join("\n").as_bytes());
            }
        }
    }

    /// Every path that discovery lists, with its formats, and the paths of single pieces.
    fn discovered(&self) -> Vec<(String, Vec<Format>)> {
        let Reply::Now(answer) = self.resources.answer(&request(Method::Get, "/.well-known/core", None, "")) else {
            panic!("discovery is answered at once");
        };
        let list = String::from_utf8_lossy(&answer.response.body).into_owned();
        let listed = list.split(",<").filter_map(|link| {
            let (path, rest) = link.trim_start_matches('<').split_once('>')?;
            let numbers = rest.split(";ct=").nth(1)?.split(';').next()?.trim_matches('"').to_owned();
            let formats = numbers.split(' ').filter_map(|number| number.parse().ok().map(Format)).collect();
            Some((path.to_owned(), formats))
        });
        let core = ("/.well-known/core".to_owned(), vec![Format::LINKS]);
        let piece = ("/luggage/{id}".to_owned(), vec![Format::JSON, Format::CBOR]);
        let photo = ("/luggage/{id}/photo".to_owned(), vec![Format::PNG, Format::BYTES]);
        listed.filter(|(path, _): &(String, Vec<Format>)| !path.starts_with("/luggage/")).chain([core, piece, photo]).collect()
    }

    /// Records what does not depend on the state, unknown paths, and what a remote client may not do.
    pub(crate) async fn look_round(&self, book: &mut Book) {
        for path in ["/robot", "/map", "/temperature", "/resourcemodel", "/luggage/999", "/.well-known/core", "/nowhere", "/"] {
            for accept in FORMATS {
                let (_, said) = self.ask(&CoapRequest { accept: Some(accept), ..request(Method::Get, path, None, "") }).await;
                book.write("coap", &format!("GET {path} · {accept}"), said.as_bytes());
            }
        }
        for query in ["rt=map", "rt=*", "href=/rob*", "obs", "ct=110", "title=*", "x=1"] {
            let (_, said) = self.ask(&request(Method::Get, &format!("/.well-known/core?{query}"), None, "")).await;
            book.write("coap", &format!("GET /.well-known/core?{query}"), said.as_bytes());
        }
        for method in [Method::Delete, Method::Put, Method::Fetch, Method::Patch] {
            let (_, said) = self.ask(&request(method, "/robot", None, "")).await;
            book.write("coap", &format!("{} /robot", method.name()), said.as_bytes());
        }
        for (method, path) in [(Method::Get, "/robot"), (Method::Post, "/commands/start"), (Method::Post, "/commands/stop")] {
            let beyond = CoapRequest { peer: "192.0.2.7:40000".parse().expect("an address"), ..request(method, path, None, "") };
            let (_, said) = self.ask(&beyond).await;
            book.write("coap", &format!("{} {path} from beyond this machine", method.name()), said.as_bytes());
        }
        for conditions in
            [Conditions { if_match: vec![None], if_none_match: false }, Conditions { if_match: vec![], if_none_match: true }]
        {
            let (_, said) =
                self.ask(&CoapRequest { conditions, ..request(Method::Put, "/strategy", None, r#"{"name":"snail"}"#) }).await;
            book.write("coap", "PUT /strategy under a condition", said.as_bytes());
        }
    }
}

/// Request from this machine; `path` may contain a query.
pub(crate) fn request(method: Method, path: &str, format: Option<Format>, payload: impl AsRef<[u8]>) -> CoapRequest {
    let (path, query) = path.split_once('?').unwrap_or((path, ""));
    CoapRequest {
        peer: "127.0.0.1:40000".parse().expect("an address"),
        method,
        path: path.split('/').skip(1).map(str::to_owned).filter(|segment| !segment.is_empty()).collect(),
        queries: query.split('&').filter(|query| !query.is_empty()).map(str::to_owned).collect(),
        format,
        accept: None,
        conditions: Conditions::default(),
        payload: payload.as_ref().to_vec(),
    }
}

/// Code, options and payload as text.
fn shown(response: &CoapResponse) -> String {
    let tag = response.tag.map(|tag| format!(" · tag {}", super::book::hex(tag.bytes())));
    let format = response.format.map(|format| format!(" · format {}", format.0));
    let age = response.max_age.map(|seconds| format!(" · max-age {seconds}"));
    let location = response.location.iter().map(|part| format!(" · /{part}"));
    let query = response.location_query.iter().map(|part| format!(" · ?{part}"));
    let options: String = format.into_iter().chain(tag).chain(age).chain(location).chain(query).collect();
    format!("{}{options}\n{}", response.code, readable(&response.body))
}
