//! Tests of the socket loop over real sockets of this machine. The application does what the path of a request says.
//! The tests have a file of their own, so that `serve` stays short.

use std::net::SocketAddr;
use std::sync::Mutex;

use coap_lite::{CoapOption, MessageClass, MessageType, Packet};
use tokio::net::UdpSocket;
use tokio::sync::{Notify, Semaphore, oneshot};
use tokio::task::JoinHandle;

use super::*;
use crate::api::door;
use crate::api::tests::fixture::searching;
use crate::doors::coap::pending::{COMMANDS, READS};
use crate::runtime::figures::Figures;
use coap_endpoint::{Answer, Code, Format, Method, RefusedRequest, Request, Response};

/// Maximum time that a test waits.
const PATIENCE: Duration = Duration::from_secs(30);

/// Does what the path of a request says. `revision` returns the state, and `hang` waits until the test releases it.
struct Obedient {
    states: watch::Receiver<Arc<Snapshot>>,
    go: Arc<Semaphore>,
    /// Notified before the application panics at state 13.
    unlucky: Arc<Notify>,
    /// The paths of all requests, in order.
    asked: Arc<Mutex<Vec<String>>>,
    /// The paths of commands that were refused because too many were under way.
    busy: Arc<Mutex<Vec<String>>>,
}

impl Obedient {
    fn revision(&self) -> Response {
        Response::content(Format::TEXT, self.states.borrow().revision.0.to_string().into_bytes())
    }
}

impl Application for Obedient {
    const IS_STOP: fn(&Request) -> bool = |request| request.segments() == ["stop"];

    const STOP_WORDS: &[[u8; 4]] = &[*b"stop"];

    fn note(&self, _: RefusedRequest) {}

    fn undone(&self) -> u64 {
        0
    }

    fn observed(&self) -> Connected {
        Figures::default().connected(door::COAP)
    }

    fn note_busy(&self, request: &Request) {
        self.busy.lock().unwrap().push(request.path_text());
    }

    fn answer(&self, request: &Request) -> Reply {
        let go = Arc::clone(&self.go);
        self.asked.lock().unwrap().push(request.path_text());
        match request.segments()[..] {
            ["panic"] => panic!("it was told to"),
            ["panic", "later"] => Reply::Later(Box::pin(async { panic!("it was told to") })),
            ["hang"] => Reply::Later(Box::pin(async move {
                drop(go.acquire().await);
                Answer::once(Response::new(Code::CHANGED))
            })),
            ["stop"] => Reply::Later(Box::pin(async { Answer::once(Response::new(Code::CHANGED)) })),
            ["revision"] => Reply::Now(Answer::observable(self.revision())),
            ["take"] => Reply::Now(Answer::once(Response::content(Format::TEXT, request.payload.len().to_string().into_bytes()))),
            _ => Reply::Now(Answer::once(Response::new(Code::NOT_FOUND))),
        }
    }

    fn things(&self, _: &Request) -> Vec<Arc<Response>> {
        if self.states.borrow().revision.0 == 13 {
            self.unlucky.notify_one();
            panic!("an unlucky number");
        }
        vec![Arc::new(self.revision())]
    }
}

struct TestApp {
    address: SocketAddr,
    states: watch::Sender<Arc<Snapshot>>,
    go: Arc<Semaphore>,
    unlucky: Arc<Notify>,
    asked: Arc<Mutex<Vec<String>>>,
    busy: Arc<Mutex<Vec<String>>>,
    closing: oneshot::Sender<()>,
    door: JoinHandle<()>,
}

struct Client {
    socket: UdpSocket,
    id: u16,
}

fn app() -> TestApp {
    let socket = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = socket.local_addr().unwrap();
    let socket = Socket::new(socket).unwrap();
    let states = watch::Sender::new(Arc::new(searching()));
    let (closing, closed) = oneshot::channel();
    let go = Arc::new(Semaphore::new(0));
    let unlucky = Arc::new(Notify::new());
    let (asked, busy) = (Arc::default(), Arc::default());
    let application = Obedient {
        states: states.subscribe(),
        go: Arc::clone(&go),
        unlucky: Arc::clone(&unlucky),
        asked: Arc::clone(&asked),
        busy: Arc::clone(&busy),
    };
    let door = tokio::spawn(serve(socket, [7; 32], application, states.subscribe(), async { drop(closed.await) }));
    TestApp { address, states, go, unlucky, asked, busy, closing, door }
}

impl TestApp {
    async fn client(&self) -> Client {
        let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        socket.connect(self.address).await.unwrap();
        Client { socket, id: 0 }
    }

    fn show(&self, revision: u64) {
        self.states.send_modify(|state| {
            let revision = hallsweep_core::units::Revision(revision);
            *state = Arc::new(Snapshot { revision, ..Snapshot::clone(state) });
        });
    }
}

impl Client {
    /// Sends a confirmable request and returns its message id.
    async fn send(&mut self, method: Method, path: &str, adorn: impl FnOnce(&mut Packet)) -> u16 {
        self.id += 1;
        let mut packet = Packet::new();
        packet.header.set_type(MessageType::Confirmable);
        packet.header.code = MessageClass::from(method.code().0);
        packet.header.message_id = self.id;
        packet.set_token(self.id.to_be_bytes().to_vec());
        path.split('/').for_each(|segment| packet.add_option(CoapOption::UriPath, segment.as_bytes().to_vec()));
        adorn(&mut packet);
        self.socket.send(&packet.to_bytes_unlimited().unwrap()).await.unwrap();
        self.id
    }

    /// Returns the next message with a payload or code. A separate response is acknowledged.
    async fn next(&self) -> Packet {
        let mut buffer = vec![0; 64 * 1024];
        loop {
            let received =
                tokio::time::timeout(PATIENCE, self.socket.recv(&mut buffer)).await.expect("the door answers").unwrap();
            let packet = Packet::from_bytes(&buffer[..received]).expect("the door speaks CoAP");
            if packet.header.get_type() == MessageType::Confirmable {
                let [high, low] = packet.header.message_id.to_be_bytes();
                self.socket.send(&[0x60, 0, high, low]).await.unwrap();
            }
            if packet.header.code != MessageClass::Empty {
                return packet;
            }
        }
    }

    async fn ask(&mut self, method: Method, path: &str) -> Packet {
        self.send(method, path, |_| {}).await;
        self.next().await
    }
}

fn code(packet: &Packet) -> Code {
    Code(u8::from(packet.header.code))
}

/// Safety A7.
#[tokio::test]
async fn a_mistake_of_the_application_ends_one_request_and_no_more() {
    let app = app();
    let mut client = app.client().await;
    for path in ["panic", "panic/later", "panic"] {
        let answer = client.ask(Method::Post, path).await;
        assert_eq!(code(&answer), Code::INTERNAL);
        assert!(String::from_utf8_lossy(&answer.payload).contains("its log says more"));
    }
    assert_eq!(code(&client.ask(Method::Get, "revision").await), Code::CONTENT);
}

/// Fills this many places with requests that hang.
async fn fill(client: &mut Client, method: Method, places: usize) {
    for begun in 1..=places {
        client.send(method, "hang", |packet| packet.header.set_type(MessageType::NonConfirmable)).await;
        // Datagrams may be lost even on loopback if many are queued. An answer shows that the requests before it have
        // arrived.
        if begun % 16 == 0 || begun == places {
            assert_eq!(code(&client.ask(Method::Get, "revision").await), Code::CONTENT);
        }
    }
}

/// Safety S1, A5, A6.
#[tokio::test]
async fn when_many_commands_are_under_way_others_are_asked_to_wait_and_stop_is_taken() {
    let app = app();
    let mut client = app.client().await;
    fill(&mut client, Method::Post, COMMANDS).await;
    let mut other = app.client().await;
    let busy = other.ask(Method::Post, "hang").await;
    assert_eq!(code(&busy), Code::UNAVAILABLE);
    assert_eq!(busy.get_first_option(CoapOption::MaxAge), Some(&vec![2]));
    assert_eq!(code(&other.ask(Method::Put, "take").await), Code::UNAVAILABLE, "it might have begun something");
    let busy: Vec<String> = app.busy.lock().unwrap().iter().map(|path| path.trim_start_matches('/').to_owned()).collect();
    assert_eq!(busy, ["hang", "take"], "they are on record");
    assert_eq!(code(&other.ask(Method::Get, "revision").await), Code::CONTENT, "looks go on");
    assert_eq!(code(&other.ask(Method::Post, "stop").await), Code::CHANGED);
    app.go.close();
    for _ in 0..COMMANDS {
        assert_eq!(code(&client.next().await), Code::CHANGED, "those who hung are answered");
    }
    assert_eq!(code(&other.ask(Method::Put, "take").await), Code::CONTENT);
}

/// Safety A5.
#[tokio::test]
async fn looks_that_hang_keep_out_neither_commands_nor_what_is_at_hand() {
    let app = app();
    let mut client = app.client().await;
    fill(&mut client, Method::Get, READS).await;
    let mut other = app.client().await;
    assert_eq!(code(&other.ask(Method::Get, "hang").await), Code::UNAVAILABLE);
    assert_eq!(code(&other.ask(Method::Get, "revision").await), Code::CONTENT);
    assert_eq!(code(&other.ask(Method::Put, "take").await), Code::CONTENT);
    app.go.close();
    for _ in 0..READS {
        assert_eq!(code(&client.next().await), Code::CHANGED, "those who hung are answered");
    }
    assert_eq!(code(&other.ask(Method::Get, "hang").await), Code::CHANGED);
}

#[tokio::test]
async fn observers_see_every_change_that_lasts() {
    let app = app();
    let mut client = app.client().await;
    let token = client.send(Method::Get, "revision", |packet| packet.add_option(CoapOption::Observe, Vec::new())).await;
    let first = client.next().await;
    assert!(first.get_first_option(CoapOption::Observe).is_some());
    // State 13 makes the application panic. Its notification is skipped.
    for (revision, seen) in [(31, "31"), (13, "32"), (33, "33")] {
        app.show(revision);
        if revision == 13 {
            app.unlucky.notified().await;
            app.show(32);
        }
        let news = client.next().await;
        assert_eq!((news.get_token(), &*String::from_utf8_lossy(&news.payload)), (&token.to_be_bytes()[..], seen));
    }
}

/// Safety A7.
#[tokio::test]
async fn no_datagram_ends_the_loop_and_none_is_taken_for_a_shorter_one() {
    let app = app();
    let mut client = app.client().await;
    for garbage in [&[][..], &[0xFF], &[0x40, 0x01], &[0x4F; 40]] {
        client.socket.send(garbage).await.unwrap();
    }
    client.send(Method::Put, "take", |packet| packet.payload = vec![b'x'; 60_000]).await;
    assert_eq!(code(&client.next().await), Code::TOO_LARGE);
    client.send(Method::Put, "take", |packet| packet.payload = vec![b'x'; 5000]).await;
    assert_eq!(client.next().await.payload, b"5000");
    // A client may leave before its answer comes.
    let mut gone = app.client().await;
    gone.send(Method::Post, "hang", |_| {}).await;
    drop(gone);
    app.go.close();
    assert_eq!(code(&client.ask(Method::Get, "revision").await), Code::CONTENT);
}

fn datagram(method: Method, path: &str, id: u16) -> Vec<u8> {
    let mut packet = Packet::new();
    packet.header.set_type(MessageType::Confirmable);
    packet.header.code = MessageClass::from(method.code().0);
    packet.header.message_id = id;
    packet.add_option(CoapOption::UriPath, path.as_bytes().to_vec());
    packet.to_bytes().unwrap()
}

/// Safety S1, S7. All datagrams are queued before the door reads, because nothing is awaited until then.
#[tokio::test]
async fn a_stop_overtakes_looks_that_wait_and_no_command_that_came_before_it() {
    const READS: u16 = 300;
    let app = app();
    let sender = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    for id in 0..READS {
        sender.send_to(&datagram(Method::Get, "revision", id), app.address).unwrap();
    }
    for (id, (method, path)) in
        (READS..).zip([(Method::Put, "take"), (Method::Put, "take"), (Method::Post, "stop"), (Method::Put, "last")])
    {
        sender.send_to(&datagram(method, path, id), app.address).unwrap();
    }
    let everything = usize::from(READS) + 4;
    tokio::time::timeout(PATIENCE, async {
        while app.asked.lock().unwrap().len() < everything {
            tokio::task::yield_now().await;
        }
    })
    .await
    .expect("everything is answered");
    let asked = app.asked.lock().unwrap();
    let place = |path: &str| asked.iter().rposition(|asked| asked.trim_start_matches('/') == path).unwrap();
    assert!(place("stop") <= BATCH + 2, "{} of {everything}", place("stop"));
    assert!(place("take") < place("stop") && place("stop") < place("last"));
}

/// Returns the paths requested from a door, in order.
fn asked(driver: &Driver<Obedient>) -> Vec<String> {
    driver.application.asked.lock().unwrap().clone()
}

fn driver() -> (Driver<Obedient>, SocketAddr) {
    let bound = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = bound.local_addr().unwrap();
    let states = watch::channel(Arc::new(searching())).1;
    let (go, unlucky) = (Arc::new(Semaphore::new(0)), Arc::default());
    let application = Obedient { states, go, unlucky, asked: Arc::default(), busy: Arc::default() };
    let driver = Driver {
        socket: Socket::new(bound).unwrap(),
        endpoint: Endpoint::new([7; 32]).with_urgent(Obedient::IS_STOP, HALTED),
        application,
        pending: PendingAnswers::default(),
        backlog: Backlog::new(Obedient::IS_STOP),
        filter: FloodFilter::new(Obedient::STOP_WORDS),
        observed: Vec::new(),
        hearings: 0,
        clock: Clock::default(),
    };
    (driver, address)
}

/// Safety S1, S7, S9. More datagrams are sent than can be received in one turn. The clock is paused, because on a
/// busy machine a turn could end after a few datagrams.
#[tokio::test(start_paused = true)]
async fn while_more_comes_than_is_heard_less_is_let_through_and_everything_again_afterwards() {
    let ((mut driver, address), sender) = (driver(), std::net::UdpSocket::bind("127.0.0.1:0").unwrap());
    (0..100).for_each(|id| {
        sender.send_to(&datagram(Method::Get, "revision", id), address).unwrap();
    });
    for id in 100..103 {
        let large = [&datagram(Method::Put, "take", id)[..], &[0xFF], &[b'x'; 30_000]].concat();
        sender.send_to(&large, address).unwrap();
    }
    driver.socket.readable().await;
    driver.turn().await;
    let due = driver.filter.due().expect("less is let through");
    driver.clock.reach(Some(due)).await;
    driver.loosen();
    assert_eq!(driver.filter.due(), None);
}

/// Safety S9: on a busy machine a turn may end after a datagram or two. That is no flood.
#[test]
fn few_datagrams_in_a_long_turn_are_no_flood() {
    assert!(!is_flood([1, 0, 0, 0], 60) && !is_flood([20, 20, 20, 3], HEARING_BYTES - 1));
    assert!(is_flood([20, 20, 20, 4], 4_000) && is_flood([0, 1, 0, 0], HEARING_BYTES));
}

/// Safety S1, S7: answering the datagrams before a STOP takes several turns. A datagram that comes meanwhile is not
/// handled before that STOP, even if another STOP follows it. The clock is paused, so the limit of a turn is 64 KiB.
#[tokio::test(start_paused = true)]
async fn what_is_urgent_is_answered_in_turns_and_nothing_that_comes_meanwhile_before_it() {
    for waits in ["take", "stop"] {
        let ((mut driver, address), sender) = (driver(), std::net::UdpSocket::bind("127.0.0.1:0").unwrap());
        let mut ids = 0..;
        let mut asks = |path| datagram(Method::Post, path, ids.next().unwrap());
        for last in 1..=60 {
            let large = [&asks(waits)[..], &[0xFF], &[b'x'; 1300]].concat();
            driver.backlog.hear(SocketAddr::from(([127, 0, 1, last], 1)), &large);
        }
        driver.backlog.hear(sender.local_addr().unwrap(), &asks("stop"));
        for path in ["late", "stop"] {
            sender.send_to(&asks(path), address).unwrap();
        }
        driver.socket.readable().await;
        driver.turn().await;
        assert!((40..52).contains(&asked(&driver).len()), "{} in one turn", asked(&driver).len());
        while asked(&driver).len() < 63 {
            driver.turn().await;
        }
        let first = format!("/{waits}");
        let order = [first.as_str(); 60].into_iter().chain(["/stop", "/late", "/stop"]).collect::<Vec<_>>();
        assert_eq!(asked(&driver), order);
    }
}

/// Safety S1, S7: the clock is paused, so only the number of bytes limits what is received in a turn.
#[tokio::test(start_paused = true)]
async fn a_stop_is_found_before_any_look_is_answered_and_in_a_flood_without_end_all_have_answers() {
    let ((mut driver, address), sender) = (driver(), std::net::UdpSocket::bind("127.0.0.1:0").unwrap());
    let mut ids = 0..;
    let mut large = |method, path| [&datagram(method, path, ids.next().unwrap())[..], &[0xFF], &[b'x'; 15_000]].concat();
    let waits = |driver: &mut Driver<Obedient>, id| driver.backlog.hear(address, &datagram(Method::Get, "revision", id));
    waits(&mut driver, 1);
    (0..6).for_each(|_| assert!(sender.send_to(&large(Method::Get, "revision"), address).is_ok()));
    sender.send_to(&datagram(Method::Post, "stop", 1000), address).unwrap();
    driver.socket.readable().await;
    while asked(&driver).is_empty() {
        driver.turn().await;
    }
    assert_eq!((asked(&driver)[0].as_str(), asked(&driver).len()), ("/stop", 8));
    for round in [2, 3] {
        waits(&mut driver, round);
        let before = asked(&driver).len();
        for turn in 1..=HEARINGS {
            assert_eq!(asked(&driver).len(), before, "it is heard first, {turn} times");
            // The path contains a word of a STOP, so these datagrams are not filtered.
            (0..5).for_each(|_| assert!(sender.send_to(&large(Method::Put, "nonstop"), address).is_ok()));
            driver.socket.readable().await;
            driver.turn().await;
        }
        assert!(asked(&driver).len() > before, "now it is answered");
    }
}

/// Waiting requests are noticed even if nothing more arrives.
#[test]
fn whatever_waits_alone_is_known_to_wait() {
    let peer = SocketAddr::from(([127, 0, 0, 1], 1));
    let [look, command, stop] = [(Method::Get, "revision"), (Method::Put, "take"), (Method::Post, "stop")]
        .map(|(method, path)| datagram(method, path, 1));
    for bytes in [look, command, stop, vec![0x60, 0, 0, 1]] {
        let mut backlog = Backlog::new(Obedient::IS_STOP);
        assert!(backlog.is_empty());
        backlog.hear(peer, &bytes);
        assert!(!backlog.is_empty(), "{bytes:02x?}");
        assert_eq!(backlog.take(), Some((peer, bytes.into())));
        assert!(backlog.is_empty() && backlog.take().is_none());
    }
}

#[tokio::test]
async fn what_is_under_way_is_answered_before_the_end() {
    let app = app();
    let mut client = app.client().await;
    client.send(Method::Post, "hang", |_| {}).await;
    assert_eq!(code(&client.ask(Method::Get, "revision").await), Code::CONTENT, "so the one before was begun");
    app.closing.send(()).unwrap();
    app.go.close();
    assert_eq!(code(&client.next().await), Code::CHANGED);
    tokio::time::timeout(PATIENCE, app.door).await.expect("it ends").unwrap();
}

#[tokio::test]
async fn the_end_does_not_wait_for_what_hangs() {
    let app = app();
    let mut client = app.client().await;
    client.send(Method::Post, "hang", |_| {}).await;
    assert_eq!(code(&client.ask(Method::Get, "revision").await), Code::CONTENT, "so the one before was begun");
    drop(app.closing);
    tokio::time::timeout(PATIENCE, app.door).await.expect("it ends").unwrap();
}
