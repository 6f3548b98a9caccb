//! SUBSCRIBE and UNSUBSCRIBE: which filters a client holds, what the router is told of them, and one answer to the client for each
//! packet. The router answers in the order in which it is asked.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt::Display;
use std::sync::Arc;

use super::duplicates::Duplicates;
use super::outstanding::Outstanding;
use super::{ClientConnection, Ended};
use crate::filter;
use crate::frame::{Kind, Malformed};
use crate::limits::{ASKED, FILTERS};
use crate::packet::filters::Filters;
use crate::packet::{Qos, write};
use crate::subscriber_lag::LagGuard;

/// What is remembered of a client between its connections.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Session {
    /// The filters it holds, each with the QoS that was granted: 0 or 1.
    pub(crate) filters: BTreeMap<Arc<str>, Qos>,
    /// The ids of its messages of QoS 2 that it has not released, and by what such a message is known.
    pub(crate) unreleased: BTreeMap<u16, u64>,
    /// By what messages are known that were sent and that it has not acknowledged.
    pub(crate) unacknowledged: Vec<u64>,
    /// While it is away, what it reads is to reach the router.
    pub(crate) absence: Absence,
}

impl Session {
    /// That of a client who holds these filters, with the QoS that was granted for each, and nothing else.
    #[must_use]
    pub fn holding(filters: impl IntoIterator<Item = (Arc<str>, Qos)>) -> Session {
        Session { filters: filters.into_iter().collect(), ..Session::default() }
    }

    /// The filters it holds.
    pub fn filters(&self) -> impl Iterator<Item = &str> {
        self.filters.keys().map(|filter| &**filter)
    }

    /// How many messages of QoS 2 it has not released.
    #[must_use]
    pub fn unreleased(&self) -> usize {
        self.unreleased.len()
    }
}

/// Somebody who comes again, and holds his filters until this is dropped.
#[derive(Clone, Debug, Default)]
pub(crate) struct Absence {
    lag_guard: Option<Arc<LagGuard>>,
}

/// What is remembered of a client is the same whether he is away or not.
impl PartialEq for Absence {
    fn eq(&self, _: &Absence) -> bool {
        true
    }
}

impl Eq for Absence {}

impl From<LagGuard> for Absence {
    fn from(mut lag_guard: LagGuard) -> Absence {
        lag_guard.leave();
        Absence { lag_guard: Some(Arc::new(lag_guard)) }
    }
}

/// The filters that a client holds, and what it waits for.
#[derive(Debug, Default)]
pub(super) struct Subscriptions {
    held: BTreeMap<Arc<str>, Held>,
    pending: VecDeque<Pending>,
    /// For how many filters the router is to answer, each counted as often as it was asked.
    asked: usize,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    qos: Qos,
    told: Told,
}

/// What the router knows of a filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Told {
    Nothing,
    AnotherQos,
    All,
}

/// An answer of the router's that is awaited.
#[derive(Debug)]
enum Pending {
    /// A SUBACK for so many filters: then the client gets this one, and what is kept for these filters.
    Subscribed { asked: usize, answer: Option<(u16, Vec<u8>)>, filters: BTreeSet<Arc<str>> },
    /// So many UNSUBACKs: then the client gets one.
    Unsubscribed { answer: Option<u16>, left: usize },
}

impl Subscriptions {
    pub(super) fn into_session(self, duplicates: Duplicates, outstanding: Outstanding, lag_guard: LagGuard) -> Session {
        let filters = self.held.into_iter().map(|(filter, held)| (filter, held.qos)).collect();
        let unacknowledged = outstanding.into_unacknowledged();
        Session { filters, unreleased: duplicates.into_unreleased(), unacknowledged, absence: lag_guard.into() }
    }

    pub(super) fn held(&self) -> impl Iterator<Item = (&Arc<str>, Qos)> {
        self.held.iter().map(|(filter, held)| (filter, held.qos))
    }

    fn told(&self, told: &[Told]) -> Vec<(Arc<str>, Qos)> {
        let held = self.held.iter().filter(|(_, held)| told.contains(&held.told));
        held.map(|(filter, held)| (Arc::clone(filter), held.qos)).collect()
    }

    /// Whether the router has to answer first, before it is asked anything else.
    pub(super) const fn has_asked_much(&self) -> bool {
        self.asked >= ASKED
    }

    fn wait(&mut self, pending: Pending) {
        self.asked += match pending {
            Pending::Subscribed { asked, .. } => asked,
            Pending::Unsubscribed { left, .. } => left,
        };
        self.pending.push_back(pending);
    }
}

impl ClientConnection {
    pub(super) fn resume(&mut self, session: Session) {
        self.duplicates = Duplicates::resumed(session.unreleased);
        if let Some(before) = &session.absence.lag_guard {
            self.lag_guard.inherit(before);
        }
        self.outstanding = Outstanding::resumed(session.unacknowledged);
        for (filter, qos) in &session.filters {
            match self.accept(filter, *qos) {
                Ok((filter, _)) => self.lag_guard.hold(&filter),
                Err(why) => self.refusals.note(filter.as_bytes(), why),
            }
        }
        self.tell_router(1, None, BTreeSet::new());
    }

    pub(super) fn subscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_subscribe(body))?;
        let (mut codes, mut accepted) = (Vec::new(), BTreeSet::new());
        for (filter, qos) in filters {
            match self.accept(filter, qos.min(Qos::One)) {
                Ok((filter, qos)) => {
                    accepted.insert(filter);
                    codes.push(qos as u8);
                }
                Err(why) => {
                    self.refusals.note(filter.as_bytes(), why);
                    codes.push(write::REFUSED);
                }
            }
        }
        self.tell_router(filters.id, Some((filters.id, codes)), accepted);
        Ok(())
    }

    pub(super) fn unsubscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_unsubscribe(body))?;
        let mut known = Vec::new();
        for (filter, _) in filters {
            if self.subscriptions.held.remove(filter).is_some() {
                self.lag_guard.strike(filter);
                self.deliveries.stop(filter);
                known.push(filter);
            }
        }
        if known.is_empty() {
            write::ack(self.to_client.end(), Kind::Unsuback, filters.id);
            return Ok(());
        }
        self.subscriptions.wait(Pending::Unsubscribed { answer: Some(filters.id), left: known.len() });
        write::unsubscribe(&mut self.to_router, filters.id, &known);
        Ok(())
    }

    /// A packet with more filters than are taken ends the connection, and that is said.
    fn few<'a>(&mut self, filters: Result<Filters<'a>, Malformed>) -> Result<Filters<'a>, Ended> {
        if let Err(wrong @ Malformed::ManyFilters) = filters {
            self.refusals.note(b"", wrong);
        }
        Ok(filters?)
    }

    pub(super) fn subscribed(&mut self, codes: &[u8]) -> Result<(), Ended> {
        let Some(Pending::Subscribed { asked, answer, filters }) = self.subscriptions.pending.pop_front() else {
            return Err(Ended::Router("a SUBACK of nothing"));
        };
        if codes.contains(&write::REFUSED) {
            return Err(Ended::Router("a SUBACK that refuses a filter"));
        }
        self.subscriptions.asked -= asked;
        self.answer(answer, filters);
        Ok(())
    }

    pub(super) fn unsubscribed(&mut self) -> Result<(), Ended> {
        let Some(Pending::Unsubscribed { answer, left }) = self.subscriptions.pending.front_mut() else {
            return Err(Ended::Router("an UNSUBACK of nothing"));
        };
        *left -= 1;
        self.subscriptions.asked -= 1;
        if *left > 0 {
            return Ok(());
        }
        if let Some(id) = answer {
            write::ack(self.to_client.end(), Kind::Unsuback, *id);
        }
        self.subscriptions.pending.pop_front();
        Ok(())
    }

    /// Takes a filter, or says why not. When it is held at another QoS, that is changed.
    fn accept(&mut self, filter: &str, qos: Qos) -> Result<(Arc<str>, Qos), Box<dyn Display>> {
        filter::filter(filter).map_err(|unfit| Box::new(unfit) as Box<dyn Display>)?;
        if !self.broker.rights.may_subscribe(self.principal, filter) {
            return Err(Box::new("that is the program's own business"));
        }
        if let Some((name, held)) = self.subscriptions.held.get_key_value(filter) {
            let told = if held.told == Told::All && held.qos != qos { Told::AnotherQos } else { held.told };
            let name = Arc::clone(name);
            self.subscriptions.held.insert(Arc::clone(&name), Held { qos, told });
            return Ok((name, qos));
        }
        if self.subscriptions.held.len() >= FILTERS {
            return Err(Box::new(format!("one connection holds at most {FILTERS} filters")));
        }
        if !self.broker.budget.admits_filter(&self.payer, filter) {
            return Err(Box::new("more filters than there are for its sender"));
        }
        let name: Arc<str> = Arc::from(filter);
        self.lag_guard.ask(&name);
        self.subscriptions.held.insert(Arc::clone(&name), Held { qos, told: Told::Nothing });
        Ok((name, qos))
    }

    /// Tells the router what it does not know yet; when it knows all, the client is answered at once. The router does not change the
    /// QoS of a filter: such a one is let go and taken again.
    fn tell_router(&mut self, id: u16, answer: Option<(u16, Vec<u8>)>, filters: BTreeSet<Arc<str>>) {
        let (new, changed) =
            (self.subscriptions.told(&[Told::Nothing, Told::AnotherQos]), self.subscriptions.told(&[Told::AnotherQos]));
        if new.is_empty() {
            return self.answer(answer, filters);
        }
        if !changed.is_empty() {
            self.subscriptions.wait(Pending::Unsubscribed { answer: None, left: changed.len() });
            let changed: Vec<&str> = changed.iter().map(|(filter, _)| &**filter).collect();
            write::unsubscribe(&mut self.to_router, id, &changed);
        }
        self.subscriptions.wait(Pending::Subscribed { asked: new.len(), answer, filters });
        let new: Vec<(&str, Qos)> = new.iter().map(|(filter, qos)| (&**filter, *qos)).collect();
        write::subscribe(&mut self.to_router, id, &new);
        for held in self.subscriptions.held.values_mut() {
            held.told = Told::All;
        }
    }

    /// Answers a SUBSCRIBE, and begins with what is kept for its filters.
    fn answer(&mut self, answer: Option<(u16, Vec<u8>)>, filters: BTreeSet<Arc<str>>) {
        if let Some((id, codes)) = answer {
            write::suback(self.to_client.end(), id, &codes);
        }
        for filter in filters {
            if let Some(held) = self.subscriptions.held.get(&filter) {
                self.lag_guard.hold(&filter);
                self.deliveries.start(filter, held.qos);
            }
        }
        // At once, so that it does not matter what came in the same piece behind it.
        self.deliver();
    }
}
