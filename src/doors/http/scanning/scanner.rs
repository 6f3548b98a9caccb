//! Follows the requests of a connection byte by byte. It finds where a head (request line and headers) ends, which
//! route the head names, who sends it, how long the body is, and where the next head begins. The scanner is lenient,
//! because a STOP with a fault is still a STOP. For a request that hyper accepts, it finds the same length as hyper.
//! It reads no socket, stores little even of a long head, and decides nothing.
//!
//! Of a head it stores the following parts. The size of each part is limited.
//!
//! ```text
//!   POST /api/v1/commands/stop?now HTTP/1.1        method and path
//!   POST http://localhost/h HTTP/1.1               also the host of this absolute address (RFC 9112, section 3.2.2)
//!   Host: localhost                                the headers of `Field`, each up to FIELDS or KEYS times
//!    folded                                        continues the line before
//!   Cookie: a=b; hallsweep-8080=…                  only the pairs with our name
//!   X-Anything: …                                  skipped
//! ```

use super::body::Chunks;
use super::names;

/// Maximum number of bytes stored of a body that may say STOP. If a body is longer than this, only its beginning is
/// searched.
const BODY: usize = 16 * 1024;

/// A part of a request that is now complete.
#[derive(Debug, PartialEq, Eq)]
pub enum Heard {
    /// A head: which route it names, and who sends it.
    Head(Head),
    /// The body of the request whose head was found last. A request without a body has no such part.
    Body,
}

#[derive(Debug)]
pub struct Scanner {
    head: HeadReader,
    at: ScannerState,
    heads: u64,
    said: BodyStart,
}

/// The beginning of a body that may say STOP. Empty for any other body.
#[derive(Debug, Default)]
struct BodyStart {
    is_kept: bool,
    bytes: Vec<u8>,
}

#[derive(Debug)]
enum ScannerState {
    Head,
    /// Number of bytes of the body that have not come yet.
    Body(u64),
    Chunks(Chunks),
    /// The beginning of the next request cannot be found. hyper ends such a connection.
    Lost,
}

impl Scanner {
    /// Creates a scanner for a new connection. `cookie` is the name of the session cookie.
    pub fn new(cookie: &str) -> Scanner {
        Scanner { head: HeadReader::new(cookie), at: ScannerState::Head, heads: 0, said: BodyStart::default() }
    }

    /// Reads up to the first byte that completes a part. Returns the number of bytes read, and the part.
    pub fn take(&mut self, bytes: &[u8]) -> (usize, Option<Heard>) {
        let mut taken = 0;
        while let Some(&byte) = bytes.get(taken) {
            let heard = match &mut self.at {
                ScannerState::Head => {
                    let passed = self.head.passes_by(&bytes[taken..]);
                    if passed > 0 {
                        taken += passed;
                        continue;
                    }
                    taken += 1;
                    self.head.push(byte).map(|head| self.begin_body(head))
                }
                ScannerState::Body(left) => {
                    let here = usize::try_from(*left).unwrap_or(usize::MAX).min(bytes.len() - taken);
                    self.said.keep(&bytes[taken..taken + here]);
                    taken += here;
                    *left -= here as u64;
                    (*left == 0).then_some(Heard::Body)
                }
                ScannerState::Chunks(chunks) => {
                    let (here, ended) = chunks.take(&bytes[taken..], |data| self.said.keep(data));
                    taken += here;
                    match ended {
                        Some(Ok(())) => Some(Heard::Body),
                        Some(Err(())) => {
                            // This byte makes the chunk invalid, but it may be part of a STOP.
                            self.said.keep(&bytes[taken - 1..taken]);
                            self.at = ScannerState::Lost;
                            None
                        }
                        None => None,
                    }
                }
                ScannerState::Lost => {
                    self.said.keep(&bytes[taken..]);
                    return (bytes.len(), None);
                }
            };
            if let Some(heard) = heard {
                if heard == Heard::Body {
                    self.at = ScannerState::Head;
                }
                return (taken, Some(heard));
            }
        }
        (taken, None)
    }

    /// Number of complete heads since the connection began.
    pub fn heads(&self) -> u64 {
        self.heads
    }

    /// Whether the next byte belongs to a head.
    pub fn is_between(&self) -> bool {
        matches!(self.at, ScannerState::Head)
    }

    /// Whether the present head begins with a byte that cannot begin a method. No server waits for the end of such a
    /// head.
    pub fn is_no_request(&self) -> bool {
        matches!(self.at, ScannerState::Head) && self.head.is_no_method()
    }

    /// Returns the stored part of the last request's body. Empty unless that body may say STOP.
    pub fn said(&self) -> &[u8] {
        &self.said.bytes
    }

    fn begin_body(&mut self, head: Head) -> Heard {
        self.heads += 1;
        self.said = BodyStart { is_kept: names::says_by_body(&head.method, &head.path).is_some(), bytes: Vec::new() };
        self.at = match head.body {
            BodyLength::Known(0) => ScannerState::Head,
            BodyLength::Known(length) => ScannerState::Body(length),
            BodyLength::Chunked => ScannerState::Chunks(Chunks::default()),
            BodyLength::Unknown => ScannerState::Lost,
        };
        Heard::Head(head)
    }
}

impl BodyStart {
    fn keep(&mut self, bytes: &[u8]) {
        if self.is_kept {
            let room = BODY.saturating_sub(self.bytes.len());
            self.bytes.extend_from_slice(&bytes[..bytes.len().min(room)]);
        }
    }
}

/// Maximum number of bytes stored of a method, a path, a host or a value. Every real token, name or session is
/// shorter.
const TEXT: usize = 1024;

/// Maximum length in bytes of a header name that this scanner needs to recognise.
const NAME: usize = 32;

/// Maximum number of different values stored for one header. Headers with keys have the limit `KEYS`.
const FIELDS: usize = 4;

/// Maximum number of keys stored for one header. A valid key is found only if it is among these keys.
pub const KEYS: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Host,
    Origin,
    /// The header in which a browser says whether the request comes from a page of this origin.
    SecFetchSite,
    Authorization,
    /// A session: the pair with the name of our cookie in a `Cookie` header.
    Cookie,
    IdempotencyKey,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyLength {
    Known(u64),
    Chunked,
    /// The length in the head is invalid, or two fields contradict each other.
    Unknown,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Head {
    pub method: Vec<u8>,
    /// The path in the target, without scheme, host and query.
    pub path: Vec<u8>,
    /// The host in the target, if the target is an absolute address.
    pub host: Option<Vec<u8>>,
    /// Stored header fields, in the order of the request.
    pub fields: Vec<(Field, Vec<u8>)>,
    /// Whether a value for the host or the origin could not be stored. Then nobody can know whether that value is
    /// foreign.
    pub is_in_doubt: bool,
    pub body: BodyLength,
    pub wants_upgrade: bool,
}

#[derive(Debug)]
pub(super) struct HeadReader {
    cookie: String,
    head: Head,
    part: HeadPart,
    /// Whether the last byte was a carriage return. It ends the line even if no line feed follows.
    after_cr: bool,
    /// Whether no byte of the present line has come yet.
    is_new_line: bool,
    line: HeaderLine,
    /// Whether the last `Transfer-Encoding` ends with `chunked`. `None` without this header.
    is_chunked: Option<bool>,
    length: Option<u64>,
}

/// The stored part of one header line.
#[derive(Debug, Default)]
struct HeaderLine {
    name: Vec<u8>,
    value: Vec<u8>,
    what: Option<Named>,
    is_in_value: bool,
    is_long: bool,
}

#[derive(Clone, Copy, Debug)]
enum Named {
    Kept(Field),
    ContentLength,
    TransferEncoding,
    Upgrade,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HeadPart {
    Method,
    Path,
    /// The host of an absolute address. A `;` does not end it.
    Host,
    /// The query and the version.
    Rest,
    Fields,
}

impl HeadReader {
    pub(super) fn new(cookie: &str) -> HeadReader {
        HeadReader {
            cookie: cookie.to_owned(),
            head: Head::default(),
            part: HeadPart::Method,
            after_cr: false,
            is_new_line: true,
            line: HeaderLine::default(),
            is_chunked: None,
            length: None,
        }
    }

    /// Whether the first byte cannot begin a method (RFC 9110, section 5.6.2).
    pub(super) fn is_no_method(&self) -> bool {
        let first = self.head.method.first();
        first.is_some_and(|byte| !byte.is_ascii_graphic() || b"\"(),/:;<=>?@[\\]{}".contains(byte))
    }

    /// Returns the memory of all stored parts, in bytes.
    #[cfg(test)]
    pub(super) fn memory(&self) -> usize {
        let fields = self.head.fields.iter().map(|(_, value)| value.capacity()).sum::<usize>();
        fields
            + self.head.method.capacity()
            + self.head.path.capacity()
            + self.head.host.as_ref().map_or(0, Vec::capacity)
            + self.line.name.capacity()
            + self.line.value.capacity()
    }

    /// Returns how many of the next bytes can be skipped because `push` would ignore them. Large heads consist mostly
    /// of such bytes.
    pub(super) fn passes_by(&self, bytes: &[u8]) -> usize {
        let HeaderLine { name, what, is_in_value, is_long, .. } = &self.line;
        let end = match (self.part, what) {
            (HeadPart::Rest, _) => b'\n',
            (HeadPart::Fields, None) if *is_in_value => b'\n',
            (HeadPart::Fields, Some(_)) if *is_long => b';',
            (HeadPart::Fields, None) if name.len() > NAME => b':',
            _ => return 0,
        };
        if self.after_cr || self.is_new_line {
            return 0;
        }
        bytes.iter().position(|byte| matches!(byte, b'\r' | b'\n') || *byte == end).unwrap_or(bytes.len())
    }

    /// Reads one byte. Returns the head if it is complete after this byte.
    pub(super) fn push(&mut self, byte: u8) -> Option<Head> {
        match byte {
            b'\n' if self.is_new_line && self.part == HeadPart::Fields => {
                self.end_field();
                return Some(self.end());
            }
            b'\n' => self.end_line(),
            b'\r' => {
                self.after_cr = true;
                return None;
            }
            _ => {
                if self.after_cr && !self.is_new_line {
                    self.end_line();
                }
                self.put(byte);
            }
        }
        self.after_cr = false;
        None
    }

    fn end_line(&mut self) {
        self.is_new_line = true;
        if self.part != HeadPart::Fields && !self.head.method.is_empty() {
            self.part = HeadPart::Fields;
        }
    }

    fn put(&mut self, byte: u8) {
        let begins_line = std::mem::take(&mut self.is_new_line);
        let is_space = matches!(byte, b' ' | b'\t');
        match self.part {
            HeadPart::Method if is_space => {
                if !self.head.method.is_empty() {
                    self.part = HeadPart::Path;
                }
            }
            HeadPart::Method => drop(keep(&mut self.head.method, byte)),
            HeadPart::Path if is_space => {
                if !self.head.path.is_empty() {
                    self.part = HeadPart::Rest;
                }
            }
            HeadPart::Path if matches!(byte, b'?' | b'#' | b';') => self.part = HeadPart::Rest,
            HeadPart::Path if byte == b'/' && self.is_behind_scheme() => {
                self.part = HeadPart::Host;
                self.head.path.clear();
                self.head.host = Some(Vec::new());
            }
            HeadPart::Path => drop(keep(&mut self.head.path, byte)),
            HeadPart::Host if is_space || matches!(byte, b'?' | b'#') => self.part = HeadPart::Rest,
            HeadPart::Host if byte == b'/' => {
                self.part = HeadPart::Path;
                self.head.path.push(byte);
            }
            HeadPart::Host => {
                let is_kept = self.head.host.as_mut().and_then(|host| keep(host, byte)).is_some();
                self.head.is_in_doubt |= !is_kept;
            }
            HeadPart::Rest => {}
            HeadPart::Fields => {
                if begins_line && !is_space {
                    self.end_field();
                }
                self.put_in_field(byte);
            }
        }
    }

    /// Whether the target, as far as it was read, ends with the first of the two slashes after the scheme and the
    /// colon.
    fn is_behind_scheme(&self) -> bool {
        let path = &self.head.path;
        self.head.host.is_none() && path.ends_with(b":/") && !path[..path.len() - 1].contains(&b'/')
    }

    fn put_in_field(&mut self, byte: u8) {
        let line = &mut self.line;
        if !line.is_in_value {
            if byte == b':' {
                line.is_in_value = true;
                line.what = named(&line.name);
            } else if line.name.len() <= NAME {
                line.name.push(byte);
            }
            return;
        }
        match line.what {
            None => {}
            Some(Named::Kept(Field::Cookie)) if byte == b';' => {
                self.keep_pair();
                self.line.value.clear();
                self.line.is_long = false;
            }
            Some(_) => line.is_long |= keep(&mut line.value, byte).is_none(),
        }
    }

    /// Evaluates a header line. Called when the next line does not continue it.
    fn end_field(&mut self) {
        match self.line.what {
            None => {}
            Some(Named::Kept(Field::Cookie)) => self.keep_pair(),
            Some(Named::Kept(field)) => {
                let (value, is_long) = (self.line.value.trim_ascii().to_vec(), self.line.is_long);
                self.keep_field(field, value, is_long);
            }
            Some(Named::ContentLength) => self.content_length(),
            Some(Named::TransferEncoding) => {
                let last = self.line.value.rsplit(|byte| *byte == b',').next().unwrap_or_default();
                let is_chunked = last.trim_ascii().eq_ignore_ascii_case(b"chunked");
                self.is_chunked = Some(is_chunked && !self.line.is_long && self.line.value.is_ascii());
            }
            Some(Named::Upgrade) => self.head.wants_upgrade = true,
        }
        self.line = HeaderLine::default();
    }

    fn keep_pair(&mut self) {
        let pair = self.line.value.trim_ascii();
        let is_ours = pair.strip_prefix(self.cookie.as_bytes()).is_some_and(|rest| rest.first() == Some(&b'='));
        if is_ours && !self.line.is_long {
            let pair = pair.to_vec();
            self.keep_field(Field::Cookie, pair, false);
        }
    }

    fn keep_field(&mut self, field: Field, value: Vec<u8>, is_long: bool) {
        let of_it = self.head.fields.iter().filter(|(other, _)| *other == field);
        let most = if matches!(field, Field::Authorization | Field::Cookie) { KEYS } else { FIELDS };
        let is_lost = is_long || of_it.clone().count() >= most;
        if of_it.clone().any(|(_, other)| *other == value) && !is_long {
            return;
        }
        if !is_lost {
            self.head.fields.push((field, value));
        } else if matches!(field, Field::Host | Field::Origin | Field::SecFetchSite) {
            self.head.is_in_doubt = true;
        }
    }

    /// Reads the length as hyper does: it must consist of digits, and several lengths must be equal. A length after a
    /// `Transfer-Encoding` is ignored.
    fn content_length(&mut self) {
        if self.is_chunked.is_some() {
            return;
        }
        let digits = self.line.value.trim_ascii();
        let value = digits.iter().try_fold(0u64, |sum, byte| {
            let digit = char::from(*byte).to_digit(10)?;
            sum.checked_mul(10)?.checked_add(u64::from(digit))
        });
        let value = value.filter(|_| !digits.is_empty() && !self.line.is_long);
        match (value, self.length) {
            (Some(value), None) => self.length = Some(value),
            (Some(value), Some(before)) if value == before => {}
            (Some(_) | None, _) => self.head.body = BodyLength::Unknown,
        }
    }

    fn end(&mut self) -> Head {
        let fresh = HeadReader::new(&self.cookie);
        let HeadReader { mut head, is_chunked, length, .. } = std::mem::replace(self, fresh);
        head.body = match (head.body, is_chunked) {
            (BodyLength::Unknown, _) | (_, Some(false)) => BodyLength::Unknown,
            (_, Some(true)) => BodyLength::Chunked,
            (_, None) => BodyLength::Known(length.unwrap_or(0)),
        };
        head
    }
}

impl Default for BodyLength {
    fn default() -> BodyLength {
        BodyLength::Known(0)
    }
}

/// Stores a byte. Returns `None` when there is no room for it.
fn keep(text: &mut Vec<u8>, byte: u8) -> Option<()> {
    (text.len() < TEXT).then(|| text.push(byte))
}

fn named(name: &[u8]) -> Option<Named> {
    const NAMES: [(&[u8], Named); 9] = [
        (b"host", Named::Kept(Field::Host)),
        (b"origin", Named::Kept(Field::Origin)),
        (b"sec-fetch-site", Named::Kept(Field::SecFetchSite)),
        (b"authorization", Named::Kept(Field::Authorization)),
        (b"cookie", Named::Kept(Field::Cookie)),
        (b"idempotency-key", Named::Kept(Field::IdempotencyKey)),
        (b"content-length", Named::ContentLength),
        (b"transfer-encoding", Named::TransferEncoding),
        (b"upgrade", Named::Upgrade),
    ];
    let name = name.trim_ascii();
    NAMES.iter().find(|(known, _)| name.eq_ignore_ascii_case(known)).map(|(_, named)| *named)
}

#[cfg(test)]
#[path = "scanner_tests.rs"]
mod tests;
