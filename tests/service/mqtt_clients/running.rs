//! A running client: started, read while it runs, told what to publish, and ended in order or killed. The choice of
//! the client and the meaning of its output are elsewhere.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::thread::sleep;
use std::time::Duration;

use super::client::{Client, mosquitto_pub};
use super::told::{Hello, Message, Say};
use crate::program::{Deadline, Program};
use crate::third_party::ended;

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval between two looks at the output.
const GLANCE: Duration = Duration::from_millis(5);

pub(crate) struct RunningClient<'a> {
    client: Client,
    door: SocketAddr,
    hello: Hello<'a>,
    child: Child,
    /// Lines for the client's standard input, which is closed when this is dropped.
    input: Option<mpsc::Sender<String>>,
    printed: Arc<Mutex<Printed>>,
    said: usize,
}

/// Output of the client.
#[derive(Default)]
struct Printed {
    heard: Vec<Message>,
    /// Messages of the client about its connection.
    words: Vec<String>,
}

impl<'a> RunningClient<'a> {
    /// Starts a client and waits until it is connected and subscribed.
    pub(crate) fn begin(client: Client, program: &Program, hello: Hello<'a>) -> RunningClient<'a> {
        let process = RunningClient::knock(client, program, hello);
        process.until_word("Subscribed");
        process
    }

    /// Starts a client without waiting.
    pub(crate) fn knock(client: Client, program: &Program, hello: Hello<'a>) -> RunningClient<'a> {
        let door = client.door(program);
        let mut command = client.command(door, &hello);
        let started = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = started.unwrap_or_else(|error| panic!("{client:?}: {error}"));
        let printed = Arc::new(Mutex::new(Printed::default()));
        note(child.stdout.take().expect("standard output is a pipe"), Arc::clone(&printed));
        note(child.stderr.take().expect("standard error is a pipe"), Arc::clone(&printed));
        let input = Some(tell(child.stdin.take().expect("standard input is a pipe")));
        RunningClient { client, door, hello, child, input, printed, said: 0 }
    }

    /// Publishes a message. At QoS 0 it has been sent when this returns, otherwise it has been acknowledged.
    pub(crate) fn say(&mut self, say: Say) {
        self.say_all(std::slice::from_ref(&say));
    }

    /// Publishes messages in order.
    pub(crate) fn say_all(&mut self, all: &[Say]) {
        if self.client.is_mosquitto() {
            all.iter().for_each(|say| drop(mosquitto_pub(self.door, &self.hello, *say, self.client.is_five())));
            return;
        }
        let lines = all.iter().map(|say| format!("{}\n", say.json())).collect();
        // A send error is ignored: the wait below shows whether the client still reads.
        let _ = self.input.as_ref().expect("it has not left yet").send(lines);
        self.said += all.len();
        let said = self.said;
        self.until_words("everything is said", |words| {
            let done = words.iter().filter(|word| *word == "Said").count();
            (done >= said).then_some(())
        });
    }

    /// All messages that the client has received.
    pub(crate) fn heard(&self) -> Vec<Message> {
        self.printed().heard.clone()
    }

    /// Waits until `find` succeeds on the received messages, and returns its result.
    pub(crate) fn until<T>(&self, wanted: &str, find: impl Fn(&[Message]) -> Option<T>) -> T {
        self.wait(wanted, |printed| find(&printed.heard))
    }

    /// Waits until the newest message on a topic matches, and returns it.
    pub(crate) fn until_newest(&self, topic: &str, wanted: &str, is_so: impl Fn(&Message) -> bool) -> Message {
        let newest = |heard: &[Message]| heard.iter().rfind(|message| message.topic == topic).filter(|it| is_so(it)).cloned();
        self.until(&format!("{topic}: {wanted}"), newest)
    }

    /// Waits until the client reports a refusal with this return code of CONNACK.
    pub(crate) fn until_refused(&self, code: u8) {
        let reason = match code {
            4 => "bad user name or password",
            5 => "not authori",
            other => panic!("no client has a sentence for {other} here"),
        };
        self.until_words(&format!("CONNACK {code}"), |words| {
            let is_refusal = |word: &str| word.contains("refused") || word.contains("connection error");
            let says = |word: &String| word.to_lowercase().replace("username", "user name");
            words.iter().map(says).find(|word| is_refusal(word) && word.contains(reason)).map(drop)
        });
    }

    /// Granted code for each filter: a QoS, or 128 for any refusal.
    pub(crate) fn granted(&self) -> Vec<u8> {
        let word = self.until_word("Subscribed");
        let codes = word.rsplit(": ").next().expect("codes").split(", ");
        codes.map(|code| code.parse::<u8>().expect("a code").min(128)).collect()
    }

    /// Waits for a message about the connection with this beginning, and returns it.
    pub(crate) fn until_word(&self, beginning: &str) -> String {
        self.until_words(beginning, |words| words.iter().find(|word| word.starts_with(beginning)).cloned())
    }

    /// Waits until `find` succeeds on the messages about the connection, and returns its result.
    pub(crate) fn until_words<T>(&self, wanted: &str, find: impl Fn(&[String]) -> Option<T>) -> T {
        self.wait(wanted, |printed| find(&printed.words))
    }

    /// Ends the client in order, as a user does, and waits for its end.
    pub(crate) fn leave(mut self) {
        if self.client.is_mosquitto() {
            let told = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
            assert!(told.expect("kill is there").success());
        }
        drop(self.input.take());
        let has_ended = ended(&mut self.child).is_some();
        if !has_ended && self.client.is_mosquitto() {
            // Its signal handler waits for a lock that the program itself holds: seen in 1 of about 220 runs.
            return self.break_off();
        }
        assert!(has_ended, "{:?} did not end when it was told to; {}", self.client, self.printed().end());
    }

    /// Kills the client, so that the broker receives no DISCONNECT.
    pub(crate) fn break_off(mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("it ends");
    }

    fn printed(&self) -> MutexGuard<'_, Printed> {
        self.printed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<T>(&self, wanted: &str, find: impl Fn(&Printed) -> Option<T>) -> T {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let printed = self.printed();
            if let Some(found) = find(&printed) {
                return found;
            }
            assert!(!deadline.has_passed(), "{:?}: never: {wanted}; {}", self.client, printed.end());
            drop(printed);
            sleep(GLANCE);
        }
    }
}

impl Printed {
    /// The last received messages and connection messages, for the message of a failed test.
    fn end(&self) -> String {
        let heard = &self.heard[self.heard.len().saturating_sub(10)..];
        let words = &self.words[self.words.len().saturating_sub(30)..];
        format!("heard {}, at last {heard:#?}\n{words:#?}", self.heard.len())
    }
}

/// Kills the client, so that a failed test leaves no process behind.
impl Drop for RunningClient<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A separate thread writes the input, so that a client that does not read does not block the test.
fn tell(mut pipe: impl Write + Send + 'static) -> mpsc::Sender<String> {
    let (input, lines) = mpsc::channel::<String>();
    std::thread::spawn(move || while lines.recv().is_ok_and(|line| pipe.write_all(line.as_bytes()).is_ok()) {});
    input
}

fn note(pipe: impl Read + Send + 'static, printed: Arc<Mutex<Printed>>) {
    std::thread::spawn(move || {
        for line in BufReader::new(pipe).lines().map_while(Result::ok) {
            let mut printed = printed.lock().unwrap_or_else(PoisonError::into_inner);
            if line.starts_with('{') { printed.heard.push(Message::read(&line)) } else { printed.words.push(line) }
        }
    });
}
