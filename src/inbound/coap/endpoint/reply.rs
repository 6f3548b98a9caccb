//! How a response is written: its options, and the block of its body that is wanted. Whether it may be sent is not here.

use coap_lite::{CoapOption, Packet};

use super::block::Block;
use super::code::Code;
use super::limits::BODY;
use super::message::{Kind, Token, add_number, headed};
use super::options::number;
use super::response::Response;

/// What goes with a response beside what the application says.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// The block of the request's body that is answered.
    pub(super) block1: Option<Block>,
    /// The block of the answer's body that is wanted.
    pub(super) block2: Option<Block>,
    /// Whether the length of the whole body is wanted.
    pub(super) wants_size: bool,
    /// The place in the order of notifications.
    pub(super) observe: Option<u32>,
    /// What the client is asked to send back.
    pub(super) echo: Option<Vec<u8>>,
}

/// The message that carries a response.
#[must_use]
pub(super) fn packet(kind: Kind, id: u16, token: Token, response: &Response, shape: &Shape) -> Packet {
    let length = response.body.len();
    let wanted = shape.block2.unwrap_or(Block::FIRST);
    // Only of what is there can a later block be asked for: of an error its beginning is sent, whatever was asked for.
    let can_be_later = response.code.is_success() && length > 0;
    let wanted = if can_be_later { wanted } else { Block { number: 0, ..wanted } };
    let Some((block, range)) = wanted.within(length) else {
        let words = format!("there is no such block: the whole has {length} bytes");
        let past = Response::refusal(Code::BAD_REQUEST, words);
        return packet(kind, id, token, &past, &Shape { block2: None, ..shape.clone() });
    };
    let mut packet = headed(kind, response.code, id, token);
    add_what_it_says(&mut packet, response);
    let is_part = block.more || block.number > 0;
    let sliced = is_part || (shape.block2.is_some() && response.code == Code::CONTENT);
    if sliced {
        add_number(&mut packet, number::BLOCK2, block.value());
    }
    if shape.wants_size || (is_part && block.number == 0) {
        add_number(&mut packet, number::SIZE2, u32::try_from(length).unwrap_or(u32::MAX));
    }
    if let Some(block) = shape.block1 {
        add_number(&mut packet, number::BLOCK1, block.value());
    }
    if let Some(sequence) = shape.observe {
        add_number(&mut packet, number::OBSERVE, sequence);
    }
    if let Some(echo) = &shape.echo {
        packet.add_option(CoapOption::from(number::ECHO), echo.clone());
    }
    packet.payload = response.body[range].to_vec();
    packet
}

fn add_what_it_says(packet: &mut Packet, response: &Response) {
    if let Some(tag) = response.tag {
        packet.add_option(CoapOption::from(number::ETAG), tag.bytes().to_vec());
    }
    for segment in &response.location {
        packet.add_option(CoapOption::from(number::LOCATION_PATH), segment.clone().into_bytes());
    }
    if let Some(format) = response.format {
        add_number(packet, number::CONTENT_FORMAT, u32::from(format.0));
    }
    if let Some(seconds) = response.max_age {
        add_number(packet, number::MAX_AGE, seconds);
    }
    for part in &response.location_query {
        packet.add_option(CoapOption::from(number::LOCATION_QUERY), part.clone().into_bytes());
    }
    if response.code == Code::TOO_LARGE {
        add_number(packet, number::SIZE1, u32::try_from(BODY).unwrap_or(u32::MAX));
    }
}
