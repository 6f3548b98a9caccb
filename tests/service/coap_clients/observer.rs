//! A client that observes a resource: started, read while it runs, and ended as a user ends it. The choice of the
//! client and the meaning of its output are elsewhere.

use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::ask::Ask;
use super::client::Client;
use crate::program::Deadline;
use crate::third_party::ended;

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval between two looks at the output.
const GLANCE: Duration = Duration::from_millis(5);

/// Beginning and end of each kind of item of `/resourcemodel`. They separate the items, because not every client
/// prints a separator.
const ITEMS: [(&str, &str); 3] = [("robot( ", "))"), ("roomMap( ", "' )"), ("luggage( ", "' ) )")];

pub(crate) struct Observer {
    client: Client,
    child: Child,
    printed: Arc<Mutex<Vec<u8>>>,
    /// Standard error: messages apart from the observed resource.
    words: Arc<Mutex<Vec<u8>>>,
}

impl Observer {
    /// Starts the observation and waits for the first output.
    pub(crate) fn start(client: Client, url: &str, ask: Ask) -> Observer {
        let ask = Ask { observe: true, ..ask };
        let mut command: Command = client.command(url, &ask);
        let started = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = started.unwrap_or_else(|error| panic!("{client:?}: {error}"));
        let printed = note(child.stdout.take().expect("standard output is a pipe"));
        let words = note(child.stderr.take().expect("standard error is a pipe"));
        let observer = Observer { client, child, printed, words };
        observer.until("something is printed", |text| !text.is_empty());
        observer
    }

    pub(crate) fn text(&self) -> String {
        text_of(&self.printed)
    }

    /// The last 2000 bytes of each output stream, for the message of a failed test.
    fn last_words(&self) -> String {
        let end = |text: &str| {
            let begin = text.len().saturating_sub(2_000);
            String::from_utf8_lossy(&text.as_bytes()[begin..]).into_owned()
        };
        format!("at the end it saw\n{}\nand said\n{}", end(&self.text()), end(&text_of(&self.words)))
    }

    /// Waits until the output matches, and returns the output.
    pub(crate) fn until(&self, wanted: &str, is_so: impl Fn(&str) -> bool) -> String {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let text = self.text();
            if is_so(&text) {
                return text;
            }
            assert!(!deadline.has_passed(), "{:?} never came to see that {wanted}; {}", self.client, self.last_words());
            sleep(GLANCE);
        }
    }

    /// Waits until the latest observed JSON value matches, and returns that value.
    pub(crate) fn until_json(&self, wanted: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let text = self.until(wanted, |text| values(text).last().is_some_and(&is_so));
        values(&text).pop().expect("there was one just now")
    }

    /// Waits until the latest item of `/resourcemodel` that begins with `head` matches, and returns that item.
    pub(crate) fn until_item(&self, head: &str, wanted: &str, is_so: impl Fn(&str) -> bool) -> String {
        let latest = |text: &str| items(text).into_iter().rfind(|item| item.starts_with(head));
        let text = self.until(wanted, |text| latest(text).is_some_and(|item| is_so(&item)));
        latest(&text).expect("there was one just now")
    }

    /// Ends the client as Ctrl-C does.
    pub(crate) fn end(mut self) {
        let told = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        assert!(told.expect("kill is there").success());
        let has_ended = ended(&mut self.child).is_some();
        assert!(has_ended, "{:?} did not end when it was told to; {}", self.client, self.last_words());
    }
}

/// Kills the client, so that a failed test leaves no process behind.
impl Drop for Observer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Collects the output of a pipe in a separate thread.
fn note(mut pipe: impl Read + Send + 'static) -> Arc<Mutex<Vec<u8>>> {
    let noted = Arc::new(Mutex::new(Vec::new()));
    let into = Arc::clone(&noted);
    std::thread::spawn(move || {
        let mut some = [0; 4096];
        while let Ok(length @ 1..) = pipe.read(&mut some) {
            into.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(&some[..length]);
        }
    });
    noted
}

fn text_of(noted: &Mutex<Vec<u8>>) -> String {
    String::from_utf8_lossy(&noted.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
}

/// Complete JSON values in a text, in order.
pub(crate) fn values(text: &str) -> Vec<Value> {
    serde_json::Deserializer::from_str(text).into_iter().map_while(Result::ok).collect()
}

/// Complete items of `/resourcemodel` in a text, in order.
pub(crate) fn items(text: &str) -> Vec<String> {
    let begun = |(head, tail): &(&str, &'static str)| -> Vec<(usize, &'static str)> {
        text.match_indices(head).map(|(place, _)| (place, *tail)).collect()
    };
    let mut begun: Vec<(usize, &str)> = ITEMS.iter().flat_map(begun).collect();
    begun.sort_unstable();
    let whole =
        |(start, tail): &(usize, &str)| text[*start..].find(tail).map(|end| text[*start..start + end + tail.len()].to_owned());
    begun.iter().filter_map(whole).collect()
}
