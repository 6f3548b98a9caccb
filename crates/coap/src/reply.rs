//! Writes a response: its options, and the requested block of its body. Whether it may be sent is not decided here.

use super::block::Block;
use super::code::Code;
use super::limits::BODY;
use super::message::{Outgoing, Token};
use super::options::number;
use super::response::Response;

/// The options of a response that do not come from the application.
#[derive(Clone, Debug, Default)]
pub(super) struct ReplyOptions {
    /// The block of the request's body that is answered (RFC 7959, section 2.2).
    pub(super) block1: Option<Block>,
    /// The requested block of the answer's body; `None` for the first, of the largest size.
    pub(super) block2: Option<Block>,
    pub(super) wants_size: bool,
    /// The Observe number of a notification (RFC 7641, section 4.4).
    pub(super) observe: Option<u32>,
    pub(super) echo: Option<Vec<u8>>,
}

pub(super) fn message(token: Token, response: &Response, shape: &ReplyOptions) -> Outgoing {
    let length = response.body.len();
    let wanted = shape.block2.unwrap_or(Block::FIRST);
    // Only a success has later blocks. For an error, the first block is sent whichever block was requested.
    let can_be_later = response.code.is_success() && length > 0;
    let wanted = if can_be_later { wanted } else { Block { number: 0, ..wanted } };
    let Some((block, range)) = wanted.within(length) else {
        let words = format!("this block does not exist: the body has {length} bytes");
        let past = Response::refusal(Code::BAD_REQUEST, words);
        return message(token, &past, &ReplyOptions { block2: None, ..shape.clone() });
    };
    let is_part = block.more || block.number > 0;
    let sliced = is_part || (shape.block2.is_some() && response.code == Code::CONTENT);
    let with_size = shape.wants_size || (is_part && block.number == 0);
    // Options must follow in the order of their numbers.
    let mut message = Outgoing::new(response.code, token, range.len());
    response.tag.iter().for_each(|tag| message.add(number::ETAG, tag.bytes()));
    shape.observe.iter().for_each(|sequence| message.add_number(number::OBSERVE, *sequence));
    response.location.iter().for_each(|segment| message.add(number::LOCATION_PATH, segment.as_bytes()));
    response.format.iter().for_each(|format| message.add_number(number::CONTENT_FORMAT, u32::from(format.0)));
    response.max_age.iter().for_each(|seconds| message.add_number(number::MAX_AGE, *seconds));
    response.location_query.iter().for_each(|part| message.add(number::LOCATION_QUERY, part.as_bytes()));
    if sliced {
        message.add_number(number::BLOCK2, block.value());
    }
    shape.block1.iter().for_each(|block| message.add_number(number::BLOCK1, block.value()));
    if with_size {
        message.add_number(number::SIZE2, u32::try_from(length).unwrap_or(u32::MAX));
    }
    if response.code == Code::TOO_LARGE {
        message.add_number(number::SIZE1, u32::try_from(BODY).unwrap_or(u32::MAX));
    }
    shape.echo.iter().for_each(|echo| message.add(number::ECHO, echo));
    message.carry(&response.body[range]);
    message
}
