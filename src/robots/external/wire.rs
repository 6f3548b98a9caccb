//! The connections to robots outside this program: TCP, WebSocket, or a serial device. The driver decides what is
//! sent; `link` decides when to reconnect.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::pin::Pin;
use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use serial2_tokio::SerialPort;
use tokio::net::{TcpSocket, TcpStream};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream};

use hallsweep_core::robot::RobotId;

/// Maximum time to connect.
const CALL: Duration = Duration::from_secs(3);

/// Maximum time to send a few bytes. A robot that does not accept them in this time counts as disconnected.
const SENDING: Duration = Duration::from_millis(500);

/// Maximum time for the other side to close the connection.
const CLOSING: Duration = Duration::from_millis(500);

/// Maximum number of bytes to read at once.
const PIECE: usize = 16 * 1024;

/// Maximum size in bytes of a message over WebSocket.
const MESSAGE: usize = 64 * 1024;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Address {
    /// `HOST:PORT`. For a robot on this machine there is also the local address from which to connect.
    Tcp(String, Option<Ipv4Addr>),
    /// `HOST:PORT`, over WebSocket.
    WebSocket(String),
    /// A serial device, and its speed in bits per second.
    Serial(String, u32),
}

type Calling = Pin<Box<dyn Future<Output = io::Result<Wire>> + Send>>;
type Closing = Pin<Box<dyn Future<Output = bool> + Send>>;

pub(super) enum Wire {
    Tcp(TcpStream),
    WebSocket(Box<WebSocketStream<MaybeTlsStream<TcpStream>>>),
    Serial(SerialPort),
}

impl Address {
    pub(super) fn call(&self) -> Calling {
        let address = self.clone();
        if let Address::Serial(..) = address {
            // The device is opened on this thread, so that a device that hangs keeps no second thread waiting.
            return Box::pin(address.called());
        }
        Box::pin(async move {
            let called = tokio::time::timeout(CALL, address.called());
            called.await.unwrap_or_else(|_| Err(io::Error::new(io::ErrorKind::TimedOut, "it does not answer")))
        })
    }

    async fn called(self) -> io::Result<Wire> {
        match self {
            Address::Tcp(at, own) => {
                let stream = match from_ourselves(&at, own).await {
                    Some(stream) => stream,
                    None => TcpStream::connect(at).await?,
                };
                // Each message must go out at once, in one segment.
                stream.set_nodelay(true)?;
                Ok(Wire::Tcp(stream))
            }
            Address::WebSocket(at) => {
                let bounds = WebSocketConfig::default().max_message_size(Some(MESSAGE)).max_frame_size(Some(MESSAGE));
                // Pongs (WebSocket's answers to pings) are not buffered when the robot does not accept them.
                let bounds = bounds.write_buffer_size(0).max_write_buffer_size(MESSAGE);
                let connected = tokio_tungstenite::connect_async_with_config(format!("ws://{at}/"), Some(bounds), true);
                let (stream, _) = connected.await.map_err(io::Error::other)?;
                Ok(Wire::WebSocket(Box::new(stream)))
            }
            Address::Serial(device, baud) => {
                let opened = tokio::task::spawn_blocking(move || SerialPort::open(device, baud)).await;
                Ok(Wire::Serial(opened.map_err(io::Error::other)??))
            }
        }
    }
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Address::Tcp(at, _) => f.write_str(at),
            Address::WebSocket(at) => write!(f, "ws://{at}"),
            Address::Serial(device, _) => f.write_str(device),
        }
    }
}

impl Wire {
    /// Receives the next bytes, or the next message. Returns an error when the connection has ended. Nothing is lost
    /// if the caller stops waiting.
    pub(super) async fn receive(&mut self) -> io::Result<Vec<u8>> {
        match self {
            Wire::Tcp(stream) => loop {
                stream.readable().await?;
                let mut bytes = vec![0; PIECE];
                match stream.try_read(&mut bytes) {
                    Ok(count) => return received(bytes, count),
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                    Err(error) => return Err(error),
                }
            },
            Wire::WebSocket(stream) => loop {
                match stream.next().await {
                    None => return Err(ended()),
                    Some(Err(error)) => return Err(io::Error::other(error)),
                    Some(Ok(Message::Text(text))) => return Ok(text.as_bytes().to_vec()),
                    Some(Ok(Message::Binary(bytes))) => return Ok(bytes.to_vec()),
                    Some(Ok(Message::Close(_))) => return Err(ended()),
                    Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Frame(_))) => {}
                }
            },
            Wire::Serial(port) => {
                let mut bytes = vec![0; PIECE];
                let count = port.read(&mut bytes).await?;
                received(bytes, count)
            }
        }
    }

    pub(super) async fn send(&mut self, bytes: Vec<u8>) -> io::Result<()> {
        let sent = async {
            match self {
                Wire::Tcp(stream) => write_whole(stream, &bytes).await,
                Wire::WebSocket(stream) => {
                    let text = String::from_utf8(bytes).map_err(io::Error::other)?;
                    stream.send(Message::text(text)).await.map_err(io::Error::other)
                }
                Wire::Serial(port) => port.write_all(&bytes).await,
            }
        };
        let late = || io::Error::new(io::ErrorKind::TimedOut, "it does not accept data");
        tokio::time::timeout(SENDING, sent).await.unwrap_or_else(|_| Err(late()))
    }

    /// Drops the connection. A serial device is dropped on another thread, because the system may wait until unsent
    /// bytes are sent.
    pub(super) fn abandon(self) {
        if let Wire::Serial(port) = self {
            tokio::task::spawn_blocking(move || drop(port));
        }
    }

    /// Closes the connection, and waits until the other side has closed it too. So late actions of the other side do
    /// not affect the next connection. The result says whether the other side has closed.
    pub(super) fn close(self) -> Closing {
        Box::pin(async move {
            let Wire::Tcp(mut stream) = self else { return false };
            let end = async {
                tokio::io::AsyncWriteExt::shutdown(&mut stream).await?;
                let mut bytes = vec![0; PIECE];
                loop {
                    stream.readable().await?;
                    match stream.try_read(&mut bytes) {
                        Ok(0) => return Ok::<(), io::Error>(()),
                        Ok(_) => {}
                        Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                        Err(error) => return Err(error),
                    }
                }
            };
            matches!(tokio::time::timeout(CLOSING, end).await, Ok(Ok(())))
        })
    }
}

/// A loopback address for each robot of this program. The virtual robot's server distinguishes its clients by their
/// addresses. It sends its messages to the newest client of each address.
pub(super) fn own_address(robot: &RobotId) -> Ipv4Addr {
    let [high, low] = u16::try_from(std::process::id() % 65_536).unwrap_or_default().to_be_bytes();
    let sum = robot.name().bytes().fold(0_u8, |sum, byte| sum.wrapping_mul(31).wrapping_add(byte));
    Ipv4Addr::new(127, 64 + sum % 128, high, low)
}

/// Connects from the address `own`. Returns `None` when the robot is on another machine, or when no connection can be
/// made.
async fn from_ourselves(at: &str, own: Option<Ipv4Addr>) -> Option<TcpStream> {
    let own = own?;
    let is_here = |address: &SocketAddr| matches!(address.ip(), IpAddr::V4(ip) if ip.is_loopback());
    let robot = tokio::net::lookup_host(at).await.ok()?.find(is_here)?;
    let socket = TcpSocket::new_v4().ok()?;
    socket.bind((own, 0).into()).ok()?;
    socket.connect(robot).await.ok()
}

/// Sends a message in one write if the system accepts all of it, as it does for a few bytes. Some robots cannot
/// handle a message in two pieces.
async fn write_whole(stream: &TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        stream.writable().await?;
        match stream.try_write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn received(mut bytes: Vec<u8>, count: usize) -> io::Result<Vec<u8>> {
    bytes.truncate(count);
    if count == 0 { Err(ended()) } else { Ok(bytes) }
}

fn ended() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "the robot closed the connection")
}
