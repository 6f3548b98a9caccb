//! Reads the first packet of a new client, and names the reasons for refusing or disconnecting a client.

use bytes::{Buf, BytesMut};
use tokio::io::AsyncReadExt;

use super::incoming::ClientReader;
use mqtt_gate::Ended;
use mqtt_gate::limits::CONNECT;
use mqtt_gate::packet::Version;
use mqtt_gate::packet::connect::{self, Connect, NoConnect};
use mqtt_gate::packet::write::Welcome;
use mqtt_gate::{Malformed, PacketKind, frame};

#[derive(Debug, thiserror::Error)]
pub(super) enum SentAway {
    #[error("the client sent no CONNECT in time")]
    Slow,
    #[error("the connection was closed before its CONNECT to make room for a newer connection")]
    GaveWay,
    #[error("the first packet is a {0:?}, not a CONNECT")]
    First(PacketKind),
    #[error(transparent)]
    Unfit(#[from] NoConnect),
    #[error(transparent)]
    Malformed(#[from] Malformed),
    #[error("the client was refused with {1:?}")]
    Refused(Version, Welcome),
    #[error("the connection broke: {0}")]
    Broken(#[from] std::io::Error),
    #[error("{0}")]
    Ended(Ended),
}

/// Reads the first packet of a client, which must be its CONNECT (MQTT 5, section 3.1).
pub(super) async fn introduction(reader: &mut ClientReader, heard: &mut BytesMut) -> Result<Connect, SentAway> {
    let mut wrong = None;
    loop {
        // Wrong flags are corrected here and reported after the whole packet has arrived. A STOP may follow the
        // packet, and its sender must be known first.
        if let Some(first) = heard.first_mut().filter(|first| **first >> 4 == PacketKind::Connect as u8 && **first & 15 != 0) {
            wrong = Some(Malformed::Kind(std::mem::replace(first, PacketKind::Connect.first_byte())));
        }
        if let Some(frame) = frame(heard, CONNECT)? {
            if frame.kind != PacketKind::Connect {
                return Err(SentAway::First(frame.kind));
            }
            if let Some(wrong) = wrong {
                return Err(wrong.into());
            }
            let connect = connect::read(&heard[frame.head..frame.length])?;
            heard.advance(frame.length);
            return Ok(connect);
        }
        if reader.read_buf(heard).await? == 0 {
            return Err(SentAway::Ended(Ended::Gone));
        }
    }
}
