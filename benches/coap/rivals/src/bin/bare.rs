//! A lower bound: one socket, one codec and one thread, without deduplication, retransmission or limits.
//! `/temperature` returns what was last put there and notifies its observers; `/large` is 50 kB.

use std::net::SocketAddr;

use coap_lite::{CoapOption, ContentFormat, MessageClass, MessageType, Packet, RequestType, ResponseType};
use tokio::net::UdpSocket;

/// Size of `/large` in bytes: 49 blocks of 1,024.
const LARGE: usize = 49 * 1024;

/// Size of a block, in bytes.
const BLOCK: usize = 1024;

fn main() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build().expect("the system gives a socket");
    runtime.block_on(serve());
}

/// Served resources and the observers of the temperature.
struct TestApp {
    temperature: Vec<u8>,
    large: Vec<u8>,
    observers: Vec<(SocketAddr, Vec<u8>)>,
    number: u16,
}

async fn serve() {
    let socket = UdpSocket::bind("127.0.0.1:0").await.expect("a free port");
    println!("coap://{}", socket.local_addr().expect("it is bound"));
    let large = (0..LARGE).map(|at| (at % 251) as u8).collect();
    let mut app = TestApp { temperature: Vec::new(), large, observers: Vec::new(), number: 0 };
    let mut room = [0; 2048];
    loop {
        let Ok((length, peer)) = socket.recv_from(&mut room).await else { continue };
        let Ok(asked) = Packet::from_bytes(&room[..length]) else { continue };
        let MessageClass::Request(method) = asked.header.code else { continue };
        let answer = app.answer(&asked, method, peer);
        let _ = socket.send_to(&answer.to_bytes().expect("it is small"), peer).await;
        if method == RequestType::Put {
            for (peer, notification) in app.notifications() {
                let _ = socket.send_to(&notification, peer).await;
            }
        }
    }
}

impl TestApp {
    fn answer(&mut self, asked: &Packet, method: RequestType, peer: SocketAddr) -> Packet {
        let mut answer = Packet::new();
        answer.header.set_type(MessageType::Acknowledgement);
        answer.header.message_id = asked.header.message_id;
        answer.set_token(asked.get_token().to_vec());
        answer.header.code = MessageClass::Response(ResponseType::Content);
        let is_large = asked.get_first_option(CoapOption::UriPath).is_some_and(|path| path == b"large");
        if method == RequestType::Put {
            self.temperature.clone_from(&asked.payload);
            answer.header.code = MessageClass::Response(ResponseType::Changed);
        } else if is_large {
            self.block(asked, &mut answer);
        } else {
            self.observe(asked, peer, &mut answer);
            answer.set_content_format(ContentFormat::ApplicationJSON);
            answer.payload.clone_from(&self.temperature);
        }
        answer
    }

    /// Adds the requested block to the answer; the block size is always 1,024 bytes.
    fn block(&self, asked: &Packet, answer: &mut Packet) {
        let option = asked.get_first_option(CoapOption::Block2).map_or(&[][..], Vec::as_slice);
        let number = option.iter().fold(0, |value, byte| value << 8 | usize::from(*byte)) >> 4;
        let rest = &self.large[(number * BLOCK).min(LARGE)..];
        let more = rest.len() > BLOCK;
        let value = (number << 4 | usize::from(more) << 3 | 6) as u32;
        answer.add_option(CoapOption::Block2, value.to_be_bytes()[1..].to_vec());
        answer.payload = rest[..rest.len().min(BLOCK)].to_vec();
    }

    fn observe(&mut self, asked: &Packet, peer: SocketAddr, answer: &mut Packet) {
        if asked.get_option(CoapOption::Observe).is_some() {
            self.observers.push((peer, asked.get_token().to_vec()));
            answer.set_observe_value(self.number.into());
        }
    }

    /// Notifications for all observers, non-confirmable and sent once.
    fn notifications(&mut self) -> Vec<(SocketAddr, Vec<u8>)> {
        let temperature = &self.temperature;
        let number = &mut self.number;
        let told = |(peer, token): &(SocketAddr, Vec<u8>)| {
            *number = number.wrapping_add(1);
            let mut packet = Packet::new();
            packet.header.set_type(MessageType::NonConfirmable);
            packet.header.message_id = *number;
            packet.header.code = MessageClass::Response(ResponseType::Content);
            packet.set_token(token.clone());
            packet.set_observe_value((*number).into());
            packet.set_content_format(ContentFormat::ApplicationJSON);
            packet.payload.clone_from(temperature);
            (*peer, packet.to_bytes().expect("it is small"))
        };
        self.observers.iter().map(told).collect()
    }
}
