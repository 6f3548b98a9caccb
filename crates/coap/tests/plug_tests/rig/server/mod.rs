//! A test application with the resources of the ETSI plug tests. It remembers every request that reached it, so that a
//! test can see that something was done once. Messages, tokens and blocks do not reach it.

pub(crate) mod links;
pub(crate) mod thing;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use coap_endpoint::{Answer, Code, Format, Method, Request, Response, link_format};

use thing::{Thing, long_body};

/// How long `/separate` takes for its answer.
pub(crate) const SLOW: Duration = Duration::from_millis(1200);

/// The format of XML, for which the endpoint has no constant.
pub(crate) const XML: Format = Format(41);

pub(crate) enum Said {
    Now(Answer),
    Later(Duration, Answer),
}

pub(crate) struct Server {
    pub(crate) things: BTreeMap<String, Thing>,
    /// The things of `/model`: robot, map, lamp; an empty one does not exist.
    pub(crate) model: [String; 3],
    pub(crate) slow: Duration,
    pub(crate) slow_observable: bool,
    pub(crate) asked: Vec<Request>,
    pub(crate) has_changed: bool,
}

impl Server {
    pub(crate) fn new() -> Server {
        let large = long_body(1280);
        let things = [
            ("/test", Thing::text("a test")),
            ("/validate", Thing::text("valid")),
            ("/seg1/seg2/seg3", Thing::text("three segments")),
            ("/large", Thing::bytes(&large, Format::TEXT)),
            ("/large-update", Thing::bytes(&large, Format::TEXT)),
            ("/large-post", Thing::bytes(&large, Format::TEXT)),
            ("/obs", Thing::text("seen 0").observable(60)),
            ("/obs-non", Thing::text("seen 0").observable(60)),
            ("/obs-large", Thing::bytes(&large, Format::TEXT).observable(60)),
            ("/link1", Thing::text("link 1")),
            ("/link2", Thing::text("link 2")),
            ("/link3", Thing::text("link 3")),
            ("/path/sub1", Thing::text("below")),
        ];
        Server {
            things: things.map(|(path, thing)| (path.to_owned(), thing)).into(),
            model: ["robot 0", "map 0", "lamp 0"].map(str::to_owned),
            slow: SLOW,
            slow_observable: false,
            asked: Vec::new(),
            has_changed: false,
        }
    }

    pub(crate) fn set(&mut self, path: &str, body: impl AsRef<[u8]>) {
        self.things.get_mut(path).unwrap_or_else(|| panic!("there is no {path}")).set(body.as_ref());
        self.has_changed = true;
    }

    pub(crate) fn set_model(&mut self, which: usize, text: &str) {
        text.clone_into(&mut self.model[which]);
        self.has_changed = true;
    }

    pub(crate) fn count(&self, method: Method, path: &str) -> usize {
        self.asked.iter().filter(|request| request.method == method && request.path_text() == path).count()
    }

    pub(crate) fn answer(&mut self, request: &Request) -> Said {
        self.asked.push(request.clone());
        if request.path_text() == "/separate" {
            let body = if request.method == Method::Get { "it took long" } else { "done at last" };
            let response = Response::content(Format::TEXT, body.as_bytes());
            let answer = if self.slow_observable { Answer::observable(response) } else { Answer::once(response) };
            return Said::Later(self.slow, answer);
        }
        let response = match request.method {
            Method::Get | Method::Fetch => return Said::Now(self.shown(request)),
            Method::Put | Method::Patch | Method::IPatch => self.put(request),
            Method::Post => self.post(request),
            Method::Delete => self.delete(request),
        };
        Said::Now(Answer::once(response))
    }

    pub(crate) fn things(&self, request: &Request) -> Vec<Arc<Response>> {
        if request.path_text() == "/model" {
            let there = self.model.iter().filter(|text| !text.is_empty());
            return there.map(|text| Arc::new(Response::content(Format::TEXT, text.as_bytes()))).collect();
        }
        let thing = self.things.get(&request.path_text());
        vec![Arc::new(thing.map_or_else(|| missing(request), |thing| thing.response(request)))]
    }

    fn shown(&self, request: &Request) -> Answer {
        let path = request.path_text();
        if path == "/model" {
            let whole = Response::content(Format::TEXT, self.model.join("\n").into_bytes());
            return Answer { response: Arc::new(whole), observed: self.things(request) };
        }
        match self.things.get(&path) {
            Some(thing) if thing.is_observable => Answer::observable(thing.response(request)),
            Some(thing) => Answer::once(thing.response(request)),
            None => Answer::once(made_up(request)),
        }
    }

    fn put(&mut self, request: &Request) -> Response {
        let path = request.path_text();
        let thing = self.things.get(&path);
        if let Err(refused) = request.conditions.met(thing.is_some(), thing.map(Thing::tag)) {
            return refused;
        }
        let Some(thing) = self.things.get_mut(&path) else {
            if !path.starts_with("/create") {
                return missing(request);
            }
            self.things.insert(path, Thing::bytes(&request.payload, request.format.unwrap_or(Format::TEXT)));
            return Response::new(Code::CREATED);
        };
        thing.set(&request.payload);
        thing.format = request.format.unwrap_or(thing.format);
        self.has_changed = true;
        Response::new(Code::CHANGED)
    }

    fn post(&mut self, request: &Request) -> Response {
        let path = request.path_text();
        match path.as_str() {
            "/test" => Response { location: words(&["location1", "location2", "location3"]), ..Response::new(Code::CREATED) },
            "/location-query" => Response { location_query: words(&["first=1", "second=2"]), ..Response::new(Code::CREATED) },
            "/large-create" => {
                self.things.insert("/large-create/1".to_owned(), Thing::bytes(&request.payload, Format::TEXT));
                Response { location: words(&["large-create", "1"]), ..Response::new(Code::CREATED) }
            }
            "/large-post" => {
                let reversed: Vec<u8> = request.payload.iter().rev().copied().collect();
                Response { code: Code::CHANGED, ..Response::content(Format::TEXT, reversed) }
            }
            _ if self.things.contains_key(&path) => {
                Response::refusal(Code::METHOD_NOT_ALLOWED, format!("POST is nothing to be done with {path}"))
            }
            _ => missing(request),
        }
    }

    fn delete(&mut self, request: &Request) -> Response {
        self.has_changed |= self.things.remove(&request.path_text()).is_some();
        Response::new(Code::DELETED)
    }
}

/// Resources that are not stored but made for each request.
fn made_up(request: &Request) -> Response {
    let links = |links: &[_], queries: &[String]| Response::content(Format::LINKS, link_format(links, queries).into_bytes());
    match request.segments().as_slice() {
        ["query"] => Response::content(Format::TEXT, request.queries.join("&").into_bytes()),
        ["multi-format"] => request.negotiated(&[Format::TEXT, XML]).map_or_else(
            |refused| refused,
            |format| Response::content(format, if format == XML { &b"<xml/>"[..] } else { b"plain" }),
        ),
        ["path"] => links(&links::below_path(), &[]),
        [".well-known", "core"] => links(&links::links(), &request.queries),
        _ => missing(request),
    }
}

fn missing(request: &Request) -> Response {
    Response::refusal(Code::NOT_FOUND, format!("there is no {}", request.path_text()))
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}
