//! Tests messages that a router delivers: each arrives once, and none is lost on the way.

use std::sync::{Arc, Mutex};

use super::scene::{OPERATOR, Scene, TestRights, publish};
use crate::packet::Qos;
use crate::{Broker, RoutedDelivery, Router, Subscriber, filter};

/// A router that stores the messages that it has to deliver, and knows the subscriptions.
#[derive(Clone, Debug, Default)]
struct TestRouter(Arc<Mutex<Held>>);

#[derive(Debug, Default)]
struct Held {
    readers: Vec<(String, Arc<Subscriber>)>,
    deliveries: Vec<RoutedDelivery>,
}

impl Router for TestRouter {
    fn subscribe(&self, filter: &str, subscriber: &Arc<Subscriber>) {
        self.0.lock().unwrap().readers.push((filter.to_owned(), Arc::clone(subscriber)));
    }

    fn unsubscribe(&self, filter: &str, subscriber: &Arc<Subscriber>) {
        self.0.lock().unwrap().readers.retain(|(known, reader)| known != filter || !Arc::ptr_eq(reader, subscriber));
    }

    fn carry(&self, delivery: RoutedDelivery) {
        self.0.lock().unwrap().deliveries.push(delivery);
    }
}

fn broker() -> (Arc<Broker>, TestRouter) {
    let router = TestRouter::default();
    (Arc::new(Broker::with_router(TestRights, router.clone())), router)
}

#[test]
fn a_router_is_told_who_reads_what_and_brings_each_message_once() {
    let (broker, router) = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut readers = [writer.reader(&[("a/#", Qos::Zero)]), writer.reader(&[("a/+", Qos::One), ("a/b", Qos::Two)])];
    writer.client(&[publish(0x34, "a/b", "x", 7), publish(0x30, "nobody", "y", 0)].concat()).unwrap();
    assert!(readers.iter_mut().all(|reader| reader.read().is_empty()), "it is on its way");
    {
        let Held { readers, deliveries } = &mut *router.0.lock().unwrap();
        assert_eq!((readers.len(), deliveries.len(), deliveries[0].topic()), (3, 1, "a/b"));
        for (_, reader) in readers.iter().filter(|(filter, _)| filter::matches(filter, "a/b")) {
            deliveries[0].arrive(reader);
        }
        assert!(deliveries[0].is_over());
        deliveries.clear();
    }
    assert_eq!(readers.each_mut().map(Scene::read), [["a/b=x q0"], ["a/b=x q2"]]);
    drop(readers);
    assert!(router.0.lock().unwrap().readers.is_empty(), "whoever has gone lets his filters go");
}

/// When a router ends, dropping its deliveries passes the messages to the remaining readers.
#[test]
fn what_was_not_brought_is_when_the_passage_is_over() {
    let (broker, router) = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut readers = [writer.reader(&[("a", Qos::One)]), writer.reader(&[("a", Qos::One)])];
    for payload in ["1", "2", "3"] {
        writer.client(&publish(0x32, "a", payload, 7)).unwrap();
    }
    let mut deliveries = std::mem::take(&mut router.0.lock().unwrap().deliveries);
    deliveries[0].arrive(&readers[1].connection.subscriber());
    drop(deliveries);
    assert_eq!(readers.each_mut().map(Scene::read), [["a=1 q1", "a=2 q1", "a=3 q1"]; 2]);
}

/// A publisher in a flood also waits for messages that the router has not delivered yet.
#[test]
fn what_is_on_its_way_counts_as_what_waits_and_once() {
    let (broker, router) = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut reader = writer.reader(&[("a", Qos::Zero)]);
    let lags = |reader: &Scene| reader.connection.subscriber().lags();
    while !lags(&reader) {
        writer.client(&publish(0x30, "a", "x", 0)).unwrap();
    }
    let on_their_way = std::mem::take(&mut router.0.lock().unwrap().deliveries);
    let count = on_their_way.len();
    drop(on_their_way);
    assert!(lags(&reader));
    assert_eq!((reader.read().len(), lags(&reader)), (count, false));
    for _ in 0..count - 1 {
        writer.client(&publish(0x30, "a", "x", 0)).unwrap();
    }
    assert!(!lags(&reader), "nothing of the first time is left");
}
