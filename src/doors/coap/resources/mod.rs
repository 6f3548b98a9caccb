//! The part of this door that knows hallsweep. It finds the resource of a request, and then its representation or its
//! action. If it finds neither, it answers with a problem. Answers are given at once where possible. A command is
//! sent immediately, so that commands keep their order, and only its result is awaited. The endpoint handles
//! messages, blocks and observers.

mod actions;
mod cache;
mod caller;
mod discovery;
mod etag;
mod old;
mod photos;
mod problem;
mod reads;
mod shows;
mod stop;
mod table;
#[cfg(test)]
mod testing;

use std::sync::Arc;

use self::cache::RepresentationCache;
use self::caller::Caller;
use self::old::OldModel;
use self::photos::Photos;
use self::problem::Problem;
use self::table::{Action, FoundPath, Table};
use super::application::{Application, Reply};
use crate::api::door;
use crate::api::fields::in_short;
use crate::doors::log_throttle::LogThrottle;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::figures::Connected;
use crate::runtime::handle::Handle;
use coap_endpoint::{Answer, Conditions, Method, RefusedRequest, Request, Response};
use hallsweep_core::asked::Asked;
use hallsweep_core::command;
use hallsweep_core::refused::{Refusal, RefusalKind, Refused};

pub struct Resources {
    handle: Handle,
    archive: ArchiveReader,
    table: Table,
    cache: RepresentationCache,
    old: OldModel,
    photos: Arc<Photos>,
    strangers: LogThrottle,
    manual_driving: bool,
}

impl Resources {
    pub fn new(handle: Handle, archive: ArchiveReader, manual_driving: bool) -> Resources {
        let cache = RepresentationCache::default();
        let old = OldModel::new(handle.snapshot());
        let (table, photos, strangers) = (Table::default(), Arc::default(), LogThrottle::default());
        Resources { handle, archive, table, cache, old, photos, strangers, manual_driving }
    }
}

impl Application for Resources {
    /// Answers a request. Must be called inside a runtime.
    fn answer(&self, request: &Request) -> Reply {
        if stop::is_stop(request) {
            return self.stop(request);
        }
        self.taken(request).unwrap_or_else(|problem| self.refused(request, &problem))
    }

    fn handle_change(&self) {
        self.old.look(&self.handle.snapshot());
    }

    fn things(&self, request: &Request) -> Vec<Arc<Response>> {
        self.seen(request).unwrap_or_else(|problem| vec![Arc::new(problem.response(request))])
    }

    const IS_STOP: fn(&Request) -> bool = stop::is_stop;

    const STOP_WORDS: &[[u8; 4]] = stop::WORDS;

    fn undone(&self) -> u64 {
        self.handle.releases()
    }

    fn observed(&self) -> Connected {
        self.handle.figures().connected(door::COAP)
    }

    /// Records the refusal of a known sender (safety A6), as `refused` does.
    fn note_busy(&self, request: &Request) {
        if Caller::of(request.peer) == Caller::Here {
            let words = "too many commands were under way".to_owned();
            let refusal = Refusal { code: "tooMany", kind: RefusalKind::Unavailable, words };
            self.handle.note_refused_at_once(caller::issuer(request.peer), asked_of(request), Refused::InWords(refusal));
        }
    }

    /// Records a refusal by the endpoint (safety A6), as `refused` does.
    fn note(&self, refused: RefusedRequest) {
        let refusal = Refusal { code: "malformed", kind: RefusalKind::Mismatch, words: refused.words };
        let asked = Asked::Words(in_short(&refused.asked));
        self.handle.note_refused_at_once(caller::issuer(refused.peer), asked, Refused::InWords(refusal));
    }
}

impl Resources {
    fn taken(&self, request: &Request) -> Result<Reply, Problem> {
        let found = self.table.find(&request.path).ok_or_else(|| Problem::nothing_at(request))?;
        match (&found.row.shows, found.row.action(request.method)) {
            (Some(shown), _) if request.method == Method::Get => self.show(shown, found.number, request),
            (_, Some(act)) => self.act(act, &found, request),
            (_, None) => Err(Problem::not_answered(request, found.row)),
        }
    }

    fn act(&self, act: Action, found: &FoundPath<'_>, request: &Request) -> Result<Reply, Problem> {
        let caller = Caller::of(request.peer);
        caller.check(act.need()).map_err(|refused| Problem::refused(&refused))?;
        let (command, epoch) = actions::command(act, found.number, request, self.manual_driving)?;
        let terms = actions::terms(act, request)?;
        self.may_change(found, request)?;
        let asked = command::Request { id: terms.id, epoch, ..command::Request::new(command, caller::issuer(request.peer)) };
        let (given, request) = (self.handle.carry_out(asked), request.clone());
        Ok(Reply::Later(Box::pin(async move {
            Answer::once(match given.await {
                Ok(done) => actions::accepted(terms.form, &done),
                Err(not_done) => Problem::from(not_done).response(&request),
            })
        })))
    }

    /// Checks `If-Match` and `If-None-Match`. They are compared with the tags of the present representations in all
    /// formats.
    fn may_change(&self, found: &FoundPath<'_>, request: &Request) -> Result<(), Problem> {
        if request.conditions == Conditions::default() {
            return Ok(());
        }
        let met = |tag| request.conditions.met(true, tag);
        let tags = self.tags(found.row, found.number);
        if tags.into_iter().any(|tag| met(Some(tag)).is_ok()) {
            return Ok(());
        }
        met(None).map_err(|response| Problem::condition(&response))
    }

    /// Answers a refused request. Refused changes from this machine are recorded (safety A6). Those from other
    /// machines are only logged, because strangers must not be able to fill the disk.
    fn refused(&self, request: &Request, problem: &Problem) -> Reply {
        let answer = Answer::once(problem.response(request));
        if request.method == Method::Get || !problem.is_for_record() {
            return Reply::Now(answer);
        }
        let asked = problem.asked().unwrap_or_else(|| asked_of(request));
        if Caller::of(request.peer) == Caller::Beyond {
            if let Some(refused) = self.strangers.one_more() {
                let (from, why) = (request.peer.ip(), problem.detail());
                tracing::info!(refused, %from, %asked, why, "requests from other machines were refused; this is the latest one");
            }
            return Reply::Now(answer);
        }
        let noted = self.handle.clone();
        let (issuer, refused) = (caller::issuer(request.peer), problem.for_record());
        Reply::Later(Box::pin(async move {
            // An error means that the program is ending. Nothing can be recorded then.
            let _ = noted.note_refused(issuer, asked, refused).await;
            answer
        }))
    }
}

fn asked_of(request: &Request) -> Asked {
    Asked::Words(format!("{} {}", request.method.name(), in_short(&request.path_text())))
}

#[cfg(test)]
mod tests;
