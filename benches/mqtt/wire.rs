//! One connection to a broker, with large reads and writes. It neither reconnects nor times out.

use std::io::ErrorKind;
use std::net::SocketAddr;

use tokio::net::TcpStream;

use crate::frame;

/// Bytes per read, so that one system call reads many small messages.
const ROOM: usize = 256 * 1024;

pub(crate) struct Wire {
    stream: TcpStream,
    came: Vec<u8>,
    /// Start and end of the received bytes that are not parsed yet.
    from: usize,
    until: usize,
}

impl Wire {
    pub(crate) async fn connect(server: SocketAddr, client: &str) -> std::io::Result<Wire> {
        let stream = TcpStream::connect(server).await?;
        stream.set_nodelay(true)?;
        let mut wire = Wire { stream, came: vec![0; ROOM], from: 0, until: 0 };
        wire.write(&frame::connect(client)).await?;
        let (first, body) = wire.awaited().await?;
        if first >> 4 != frame::CONNACK || body[1] != 0 {
            return Err(std::io::Error::other(format!("CONNECT is answered with {first:#x} {body:?}")));
        }
        Ok(wire)
    }

    /// Subscribes and waits for the SUBACK.
    pub(crate) async fn subscribe(&mut self, filter: &str, qos: u8) -> std::io::Result<()> {
        self.write(&frame::subscribe(filter, qos)).await?;
        let (first, body) = self.awaited().await?;
        if first >> 4 != frame::SUBACK || body[2] != qos {
            return Err(std::io::Error::other(format!("SUBSCRIBE is answered with {first:#x} {body:?}")));
        }
        Ok(())
    }

    pub(crate) async fn write(&self, mut bytes: &[u8]) -> std::io::Result<()> {
        while !bytes.is_empty() {
            match self.stream.try_write(bytes) {
                Ok(written) => bytes = &bytes[written..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => self.stream.writable().await?,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Reads once, as many bytes as are available.
    pub(crate) async fn read(&mut self) -> std::io::Result<()> {
        self.came.copy_within(self.from..self.until, 0);
        self.until -= self.from;
        self.from = 0;
        loop {
            match self.stream.try_read(&mut self.came[self.until..]) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => {
                    self.until += length;
                    return Ok(());
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => self.stream.readable().await?,
                Err(error) => return Err(error),
            }
        }
    }

    /// Next complete frame: its first byte and its body.
    pub(crate) fn next(&mut self) -> Option<(u8, &[u8])> {
        let (first, body, length) = frame::first(&self.came[self.from..self.until])?;
        self.from += length;
        Some((first, body))
    }

    async fn awaited(&mut self) -> std::io::Result<(u8, Vec<u8>)> {
        loop {
            if let Some((first, body)) = self.next() {
                return Ok((first, body.to_vec()));
            }
            self.read().await?;
        }
    }
}
