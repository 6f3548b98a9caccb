//! The bound: two bare sockets and one thread, which acknowledges every message and copies it to every subscriber,
//! whatever the topic. The bound checks, stores and limits nothing; no broker on this machine can be much faster.

use std::cell::RefCell;
use std::io::ErrorKind;
use std::rc::Rc;

use tokio::net::{TcpListener, TcpStream};
use tokio::task::{LocalSet, spawn_local};

use crate::frame;

/// Bytes per read.
const ROOM: usize = 256 * 1024;

type Subscribers = Rc<RefCell<Vec<Rc<TcpStream>>>>;

/// Serves on this local port until the process is killed.
pub(crate) fn serve(port: u16) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("the system gives a runtime");
    let served = LocalSet::new().block_on(&runtime, async {
        let listener = TcpListener::bind(("127.0.0.1", port)).await?;
        let subscribers = Subscribers::default();
        loop {
            let (stream, _) = listener.accept().await?;
            stream.set_nodelay(true)?;
            spawn_local(copy(Rc::new(stream), Rc::clone(&subscribers)));
        }
    });
    let _: std::io::Result<()> = served;
}

async fn copy(stream: Rc<TcpStream>, subscribers: Subscribers) {
    let (mut came, mut length) = (vec![0; ROOM], 0);
    while stream.readable().await.is_ok() {
        match stream.try_read(&mut came[length..]) {
            Ok(0) => break,
            Ok(read) => length += read,
            Err(error) if error.kind() == ErrorKind::WouldBlock => continue,
            Err(_) => break,
        }
        let (mut taken, mut answers, mut said) = (0, Vec::new(), Vec::new());
        while let Some((first, body, whole)) = frame::first(&came[taken..length]) {
            match first >> 4 {
                1 => answers.extend_from_slice(&[0x20, 2, 0, 0]),
                8 => {
                    answers.extend_from_slice(&[0x90, 3, body[0], body[1], body[body.len() - 1]]);
                    subscribers.borrow_mut().push(Rc::clone(&stream));
                }
                frame::PUBLISH => {
                    said.extend_from_slice(&came[taken..taken + whole]);
                    if let (Some(id), _) = frame::published(first, body) {
                        frame::puback(&mut answers, id);
                    }
                }
                _ => {}
            }
            taken += whole;
        }
        came.copy_within(taken..length, 0);
        length -= taken;
        let readers = subscribers.borrow().clone();
        for reader in readers {
            write(&reader, &said).await;
        }
        write(&stream, &answers).await;
    }
    subscribers.borrow_mut().retain(|reader| !Rc::ptr_eq(reader, &stream));
}

async fn write(to: &TcpStream, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        match to.try_write(bytes) {
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::WouldBlock && to.writable().await.is_ok() => {}
            Err(_) => return,
        }
    }
}
