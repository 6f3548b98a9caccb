//! A server on coap-rs as its examples build one: `/temperature` returns what was last put there and can be observed,
//! `/large` is 50 kB. coap-rs itself handles messages, observers and blocks.

use std::net::SocketAddr;
use std::sync::{Arc, PoisonError, RwLock};

use coap::Server;
use coap::server::UdpCoapListener;
use coap_lite::{CoapRequest, ContentFormat, RequestType, ResponseType};
use tokio::net::UdpSocket;

/// Size of `/large` in bytes: 49 blocks of 1,024.
const LARGE: usize = 49 * 1024;

type Request = Box<CoapRequest<SocketAddr>>;

#[derive(Default)]
struct TestApp {
    temperature: RwLock<Vec<u8>>,
}

fn main() {
    let runtime = tokio::runtime::Runtime::new().expect("the system gives threads");
    runtime.block_on(async {
        let socket = UdpSocket::bind("127.0.0.1:0").await.expect("a free port");
        println!("coap://{}", socket.local_addr().expect("it is bound"));
        let server = Server::from_listeners(vec![Box::new(UdpCoapListener::from_socket(socket))]);
        let app = Arc::new(TestApp::default());
        let run = server.run(move |request: Request| {
            let app = Arc::clone(&app);
            async move { app.answered(request) }
        });
        run.await.expect("the socket stays");
    });
}

impl TestApp {
    fn answered(&self, mut request: Request) -> Request {
        let (method, path) = (*request.get_method(), request.get_path());
        let given = std::mem::take(&mut request.message.payload);
        let Some(response) = request.response.as_mut() else { return request };
        match (method, path.as_str()) {
            (RequestType::Get, "temperature") => {
                response.message.set_content_format(ContentFormat::ApplicationJSON);
                response.message.payload = self.temperature.read().unwrap_or_else(PoisonError::into_inner).clone();
            }
            (RequestType::Get, "large") => response.message.payload = (0..LARGE).map(|at| (at % 251) as u8).collect(),
            (RequestType::Put, "temperature") => {
                *self.temperature.write().unwrap_or_else(PoisonError::into_inner) = given;
                response.set_status(ResponseType::Changed);
            }
            _ => response.set_status(ResponseType::NotFound),
        }
        request
    }
}
