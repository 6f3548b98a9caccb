//! The doubles of the virtual robot's page and servers in real time, on a local port.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, mpsc};
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio_tungstenite::tungstenite::Message;

use super::page::{Page, Scene};
use super::server::{Client, Server, Version};

/// A server and its page, which run until this is dropped.
pub(crate) struct VirtualRobot {
    shared: Arc<Shared>,
    address: SocketAddr,
    /// Closed on drop, which ends the thread of the server.
    _end: tokio::sync::oneshot::Sender<()>,
}

struct Shared {
    server: Mutex<Server>,
    clients: Mutex<BTreeMap<Client, UnboundedSender<Vec<u8>>>>,
    began: Instant,
}

impl VirtualRobot {
    pub(crate) fn standing_in(scene: Scene, version: Version) -> VirtualRobot {
        let page = Page::open(scene, Page::steady(), Duration::ZERO);
        #[expect(clippy::disallowed_methods, reason = "the double lives by the real clock")]
        let began = Instant::now();
        let server = Mutex::new(Server::new(version, Some(page)));
        let shared = Arc::new(Shared { server, clients: Mutex::default(), began });
        let (say, said) = mpsc::channel();
        let (end, ended) = tokio::sync::oneshot::channel();
        let serving = Arc::clone(&shared);
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
            runtime.block_on(async {
                let listener = TcpListener::bind("127.0.0.1:0").await.expect("a free port");
                say.send(listener.local_addr().expect("it is bound")).expect("it is waited for");
                tokio::select! {
                    () = serve(serving, listener, version) => {}
                    _ = ended => {}
                }
            });
        });
        VirtualRobot { shared, address: said.recv().expect("the double starts"), _end: end }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn server(&self) -> MutexGuard<'_, Server> {
        self.shared.server()
    }

    /// Cuts all connections without a notice.
    pub(crate) fn cut(&self) {
        self.shared.clients.lock().expect("nobody panicked").clear();
    }

    /// Cell in which the robot really is.
    pub(crate) fn cell(&self) -> (i32, i32) {
        self.server().page.as_ref().expect("a page is open").cell().0
    }
}

impl Shared {
    fn server(&self) -> MutexGuard<'_, Server> {
        self.server.lock().expect("nobody panicked")
    }
}

async fn serve(shared: Arc<Shared>, listener: TcpListener, version: Version) {
    tokio::spawn(live(Arc::clone(&shared)));
    loop {
        let Ok((stream, from)) = listener.accept().await else { return };
        let shared = Arc::clone(&shared);
        // A refused connection is closed at once, as on a port on which nothing listens.
        let Some(client) = shared.server().connect(&from.ip().to_string()) else { continue };
        let (say, said) = unbounded_channel();
        shared.clients.lock().expect("nobody panicked").insert(client, say);
        let address = from.ip().to_string();
        tokio::spawn(async move {
            if version == Version::First {
                speak(&shared, stream, said).await;
            } else {
                speak_in_messages(&shared, stream, said).await;
            }
            shared.clients.lock().expect("nobody panicked").remove(&client);
            shared.server().end(&address, client);
        });
    }
}

/// Advances the time in the page, and delivers the messages of the server to its clients.
async fn live(shared: Arc<Shared>) {
    loop {
        tokio::time::sleep(Duration::from_millis(1)).await;
        let mut server = shared.server();
        server.pass_to(shared.began.elapsed());
        let mut clients = shared.clients.lock().expect("nobody panicked");
        if server.is_dead {
            clients.clear();
        }
        for (client, bytes) in std::mem::take(&mut server.sent) {
            if let Some(say) = clients.get(&client) {
                // A client that has disconnected receives nothing.
                let _ = say.send(bytes);
            }
        }
    }
}

async fn speak(shared: &Shared, mut stream: TcpStream, mut said: UnboundedReceiver<Vec<u8>>) {
    let mut bytes = vec![0; 4096];
    loop {
        tokio::select! {
            read = stream.read(&mut bytes) => match read {
                Ok(count) if count > 0 => shared.server().receive(&bytes[..count]),
                Ok(_) | Err(_) => return,
            },
            out = said.recv() => match out {
                Some(out) => if stream.write_all(&out).await.is_err() { return },
                None => return heard_before(shared, &stream),
            }
        }
    }
}

/// Processes the bytes that had arrived before the connection was cut.
fn heard_before(shared: &Shared, stream: &TcpStream) {
    let mut bytes = vec![0; 4096];
    if let Ok(count @ 1..) = stream.try_read(&mut bytes) {
        shared.server().receive(&bytes[..count]);
    }
}

async fn speak_in_messages(shared: &Shared, stream: TcpStream, mut said: UnboundedReceiver<Vec<u8>>) {
    let Ok(mut stream) = tokio_tungstenite::accept_async(stream).await else { return };
    loop {
        tokio::select! {
            read = stream.next() => match read {
                Some(Ok(Message::Text(text))) => shared.server().receive(text.as_bytes()),
                Some(Ok(_)) => {}
                Some(Err(_)) | None => return,
            },
            out = said.recv() => match out {
                Some(out) => {
                    let text = String::from_utf8(out).expect("JSON is text");
                    if stream.send(Message::text(text)).await.is_err() { return }
                }
                None => return,
            }
        }
    }
}
