//! For `guests`: what becomes of a client before it is served.

use tokio::sync::{mpsc, watch};

use super::*;
use crate::access::Access;
use crate::inbound::mqtt::identity::Identity;
use crate::inbound::mqtt::limits::CONNECTIONS;
use crate::inbound::mqtt::session::testing::topics;
use crate::runtime::obedient::obedient;
use crate::runtime::within::within;
use crate::wire::fixture::idle;

/// Safety A5, S9: however many come with one name, no more of them wait than there are seats.
#[tokio::test(start_paused = true)]
async fn whoever_waits_for_the_name_of_another_goes_when_his_seat_is_needed() {
    let (handle, _script) = obedient(idle());
    let (give, _answers) = mpsc::channel(1);
    let secret = Token::draw().expect("the system gives chance");
    let house = House::new(Gatehouse::new(topics()), Orders::new(handle, topics(), true, give), secret);
    let (_engines, engine) = watch::channel(Arc::new(Engine::hanging("127.0.0.1:9".parse().expect("an address"))));
    let origin = Origin { from: "127.0.0.1".parse().expect("an address"), caller: None, access: Access::Open };

    let mut hello = BytesMut::new();
    write::connect(&mut hello, "panel", false, 60, ("anna", "x"));
    let connect = connect::read(&hello[2..]).expect("it is one");
    let identity = Identity::of(&connect, &origin, &house.0.secret).expect("everybody is let in");
    let name = Name { who: identity.name(), client: "panel".to_owned() };
    let mut hangs = house.0.slots.take(name, true).await;

    let (mut client, stream) = tokio::io::duplex(1024);
    let visitor = Visitor::over(stream, origin);
    let waiting = house.let_wait(visitor.origin.from);
    let served = tokio::spawn(house.clone().entertain(visitor, waiting, (engine, Handle::current())));
    client.write_all(&hello).await.expect("it is taken");
    within("somebody of the same name", hangs.wanted()).await;
    let holder = identity.holder().expect("it has a seat");
    let _newer: Vec<_> = (0..CONNECTIONS).map(|_| house.0.seats.take(holder.clone(), Duration::MAX)).collect();
    tokio::time::timeout(AGAIN, served).await.expect("it waits no longer").expect("it ends in order");
    assert_eq!(client.read(&mut [0]).await.ok(), Some(0));
}
