//! Accepts programs, at a port or at a serial device. At a port each new program replaces the last one. A serial
//! device is opened again after it was unplugged.

use std::future;
use std::io;
use std::time::Duration;

use serial2_tokio::SerialPort;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;

use crate::runtime::clock::Clock;

/// Pause before the next attempt, when a port cannot accept or a device cannot be opened.
const AGAIN: Duration = Duration::from_millis(500);

#[derive(Clone, Debug)]
pub enum End {
    /// The address where programs connect, such as `127.0.0.1:8300`; port 0 means any free port.
    Port(String),
    /// A serial device, and its speed in bits per second.
    Device(String, u32),
}

/// `Display` is the message for the person who started the emulator.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    #[error(
        "cannot listen on {at} for programs: {error}; choose another address of this machine with --listen, such as 127.0.0.1:0 \
         for a free port"
    )]
    Listen { at: String, error: io::Error },
    #[error(
        "the serial device {device} cannot be opened at {baud} baud: {error}; check that the device is plugged in and that you \
         may open it, and name the device with --serial, such as /dev/ttyUSB0"
    )]
    Device { device: String, baud: u32, error: io::Error },
    #[error("the simulated robot ended after an internal error: start it again, and look at the log above")]
    SimulationEnded,
}

pub(super) type Stream = Box<dyn Bytes>;

pub(super) trait Bytes: AsyncRead + AsyncWrite + Send + Unpin {}

impl<S: AsyncRead + AsyncWrite + Send + Unpin> Bytes for S {}

pub(super) enum Wire {
    Port(TcpListener, Duration),
    Device { device: String, baud: u32, opened: Option<Stream>, again_at: Duration },
}

impl Wire {
    pub(super) async fn open(end: End) -> Result<(Wire, String), EmulatorError> {
        match end {
            End::Port(at) => {
                let unusable = |error| EmulatorError::Listen { at: at.clone(), error };
                let listener = TcpListener::bind(&at).await.map_err(unusable)?;
                let place = listener.local_addr().map_err(unusable)?.to_string();
                Ok((Wire::Port(listener, Duration::ZERO), place))
            }
            End::Device(device, baud) => {
                let opened = SerialPort::open(&device, baud);
                let unusable = |error| EmulatorError::Device { device: device.clone(), baud, error };
                let opened: Option<Stream> = Some(Box::new(opened.map_err(unusable)?));
                let place = device.clone();
                Ok((Wire::Device { device, baud, opened, again_at: Duration::ZERO }, place))
            }
        }
    }

    /// Waits for the next program. At a serial device the next program comes only after the last one has gone.
    pub(super) async fn next(&mut self, clock: &Clock, is_connected: bool) -> Stream {
        loop {
            match self {
                Wire::Port(listener, again_at) => {
                    clock.reach(Some(*again_at)).await;
                    match listener.accept().await {
                        Ok((stream, _)) => {
                            // Without this option answers arrive later, but the robot still works.
                            let _ = stream.set_nodelay(true);
                            return Box::new(stream);
                        }
                        Err(_) => *again_at = clock.since_start() + AGAIN,
                    }
                }
                Wire::Device { .. } if is_connected => return future::pending().await,
                Wire::Device { device, baud, opened, again_at } => {
                    if let Some(stream) = opened.take() {
                        return stream;
                    }
                    clock.reach(Some(*again_at)).await;
                    match SerialPort::open(&*device, *baud) {
                        Ok(stream) => return Box::new(stream),
                        Err(_) => *again_at = clock.since_start() + AGAIN,
                    }
                }
            }
        }
    }

    pub(super) fn close(&mut self, clock: &Clock) {
        if let Wire::Device { again_at, .. } = self {
            *again_at = clock.since_start() + AGAIN;
        }
    }
}
