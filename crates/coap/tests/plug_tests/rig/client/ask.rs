//! A request of a client before it is put into messages.

use coap_endpoint::Method;

use crate::rig::message::{Message, option};

#[derive(Clone, Debug)]
pub(crate) struct Ask {
    pub(crate) method: Method,
    pub(crate) path: String,
    pub(crate) payload: Vec<u8>,
    pub(crate) accept: Option<u16>,
    pub(crate) observes: bool,
    /// The size exponent of the blocks that it sends and wants.
    pub(crate) exponent: u8,
    /// Whether the first request names that size, or only the second (RFC 7959, figures 3 and 4).
    pub(crate) is_early: bool,
}

impl Ask {
    pub(crate) fn get(path: &str) -> Ask {
        Ask {
            method: Method::Get,
            path: path.to_owned(),
            payload: Vec::new(),
            accept: None,
            observes: false,
            exponent: 6,
            is_early: false,
        }
    }

    pub(crate) fn of(method: Method, path: &str, payload: impl AsRef<[u8]>) -> Ask {
        Ask { method, payload: payload.as_ref().to_vec(), ..Ask::get(path) }
    }

    pub(crate) fn observe(path: &str) -> Ask {
        Ask { observes: true, ..Ask::get(path) }
    }

    /// With blocks of this size exponent, named in the first request.
    pub(crate) fn early(self, exponent: u8) -> Ask {
        Ask { exponent, is_early: true, ..self }
    }

    /// With blocks of this size exponent, named only after the first block has come.
    pub(crate) fn late(self, exponent: u8) -> Ask {
        Ask { exponent, is_early: false, ..self }
    }

    /// The request, without its payload.
    pub(crate) fn head(&self, id: u16, token: &[u8]) -> Message {
        let message = Message::con(self.method, id).token(token).path(&self.path);
        match self.accept {
            Some(format) => message.number(option::ACCEPT, u32::from(format)),
            None => message,
        }
    }

    /// Size in bytes of the blocks that it sends.
    pub(crate) const fn size(&self) -> usize {
        16 << self.exponent
    }
}
