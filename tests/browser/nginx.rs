//! nginx as a proxy before the program, which it serves only under a prefix, with the configuration of the
//! documentation.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;

use crate::program::{Deadline, PATIENCE};
use crate::{Data, GLANCE};

/// Path of Debian's package.
pub(crate) const NGINX: &str = "/usr/sbin/nginx";

/// Prefix under which the program is served, and its address in the documentation.
const PREFIX: &str = "/hall";
const DOCUMENTED: &str = "http://127.0.0.1:8080/";

pub(crate) struct Nginx {
    child: Child,
    port: u16,
    folder: PathBuf,
    _data: Data,
}

impl Nginx {
    /// Starts a proxy before the program at this address.
    pub(crate) fn before(program: &str, scenario: &str) -> Nginx {
        let data = Data::new(&format!("nginx-{scenario}"));
        let folder = PathBuf::from(&data.0);
        std::fs::create_dir_all(&folder).expect("a folder of ours");
        let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port is free");
        let port = free.local_addr().expect("it is bound").port();
        drop(free);
        let temporary: String = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"]
            .map(|kind| format!("{kind}_temp_path {}/{kind};\n", folder.display()))
            .concat();
        let settings = format!(
            "daemon off;\nmaster_process off;\npid {folder}/pid;\nerror_log {folder}/error.log;\nevents {{}}\nhttp {{\n\
             log_format asked '$status $request_uri';\naccess_log {folder}/access.log asked;\n{temporary}\
             server {{\nlisten 127.0.0.1:{port};\nlocation / {{ return 404; }}\n{documented}\n}}\n}}\n",
            folder = folder.display(),
            documented = documented().replace(DOCUMENTED, &format!("http://{program}/")),
        );
        let path = folder.join("nginx.conf");
        std::fs::write(&path, settings).expect("the folder can be written");
        let mut command = Command::new(NGINX);
        command.args(["-e", "error.log", "-p"]).arg(&folder).arg("-c").arg(path).stdin(Stdio::null());
        let nginx = Nginx { child: command.spawn().expect("nginx starts"), port, folder, _data: data };
        let deadline = Deadline::within(PATIENCE);
        while TcpStream::connect(nginx.address()).is_err() {
            assert!(!deadline.has_passed(), "nginx does not open its port: {}", nginx.wrote("error.log"));
            sleep(GLANCE);
        }
        nginx
    }

    fn address(&self) -> SocketAddr {
        (Ipv4Addr::LOCALHOST, self.port).into()
    }

    /// Address of the program through the proxy.
    pub(crate) fn url(&self) -> String {
        format!("http://{}{PREFIX}", self.address())
    }

    /// Panics unless MQTT over WebSocket passes through the proxy.
    pub(crate) fn carries_mqtt(&self) {
        let mut stream = TcpStream::connect(self.address()).expect("it is there");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket has a patience");
        let asked = format!(
            "GET {PREFIX}/mqtt HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: mqtt\r\n\r\n",
            self.address()
        );
        stream.write_all(asked.as_bytes()).expect("it reads");
        let mut status = [0; 12];
        stream.read_exact(&mut status).expect("it answers");
        assert_eq!(String::from_utf8_lossy(&status), "HTTP/1.1 101");
    }

    /// Panics if anything outside the prefix was requested.
    pub(crate) fn was_asked_within_its_prefix(&self) {
        let log = self.wrote("access.log");
        let asked: Vec<&str> = log.lines().filter_map(|line| Some(line.split_once(' ')?.1)).collect();
        let is_within = |path: &&str| path.strip_prefix(PREFIX).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        let outside: Vec<&str> = asked.iter().copied().filter(|path| !is_within(path)).collect();
        assert!(asked.len() > 5, "hardly anything was asked: {log}");
        assert!(outside.is_empty(), "asked outside {PREFIX}: {outside:?}");
    }

    fn wrote(&self, file: &str) -> String {
        std::fs::read_to_string(self.folder.join(file)).unwrap_or_default()
    }
}

impl Drop for Nginx {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Configuration for a prefix in the documentation.
fn documented() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/access.md");
    let text = std::fs::read_to_string(path).expect("it is there");
    let mut blocks = text.split("```nginx\n").skip(1).filter_map(|rest| rest.split("```").next());
    blocks.find(|block| block.contains("location /hall/")).expect("a prefix in docs/access.md").to_owned()
}
