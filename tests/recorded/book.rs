//! Recorded texts by kind, and their comparison with earlier records. This module does not depend on the program.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Length in bytes above which a text may be replaced by its digest.
const SHORT: usize = 160;

/// Rule for what is written out in full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    /// A long text is written out this many times per title, then as its digest.
    Long(usize),
    /// Long texts of a kind are written out until they take this many bytes together; a text longer than a quarter of
    /// that is written as its digest. Folded texts become one digest per kind.
    Short(usize),
}

/// Recorded texts.
pub(crate) struct Book {
    kinds: BTreeMap<&'static str, String>,
    /// Digest of the text last shown under each title.
    shown: HashMap<(&'static str, String), Vec<u8>>,
    /// Number of long texts written out under each title.
    written_out: HashMap<(&'static str, String), usize>,
    /// Bytes of long texts written out of each kind.
    spent: HashMap<&'static str, usize>,
    /// Texts folded so far; `None` when folding is off.
    folded: Option<BTreeMap<&'static str, Folded>>,
    /// Current place, such as `seed 1 · revision 12`.
    pub(crate) place: String,
    size: Size,
}

/// Many texts as one digest.
#[derive(Default)]
struct Folded {
    things: usize,
    digest: Sha256,
}

impl Book {
    pub(crate) fn new(size: Size) -> Book {
        Book {
            kinds: BTreeMap::new(),
            shown: HashMap::new(),
            written_out: HashMap::new(),
            spent: HashMap::new(),
            folded: None,
            place: String::new(),
            size,
        }
    }

    /// From now on, folds the texts into one digest per kind, if the size is `Short`.
    pub(crate) fn fold(&mut self) {
        if matches!(self.size, Size::Short(_)) {
            self.folded = Some(BTreeMap::new());
        }
    }

    /// Ends folding and writes the digests.
    pub(crate) fn unfold(&mut self) {
        for (kind, Folded { things, digest }) in self.folded.take().into_iter().flatten() {
            let digest = hex(&digest.finalize()[..12]);
            let line = format!("== {} · {things} things, sha256 {digest}", self.place);
            self.write_on(kind, &line);
        }
    }

    /// Treats every text as new, for a new mission.
    pub(crate) fn forget(&mut self) {
        self.shown.clear();
    }

    /// Writes a text, unless it equals the text last shown under this title.
    pub(crate) fn show(&mut self, kind: &'static str, title: &str, body: &[u8]) {
        let digest = Sha256::digest(body).to_vec();
        if self.shown.insert((kind, title.to_owned()), digest.clone()) != Some(digest) {
            self.write(kind, title, body);
        }
    }

    /// Writes a text under a title.
    pub(crate) fn write(&mut self, kind: &'static str, title: &str, body: &[u8]) {
        if let Some(folded) = &mut self.folded {
            let folded = folded.entry(kind).or_default();
            folded.things += 1;
            folded.digest.update(title.as_bytes());
            folded.digest.update(body);
            return;
        }
        let body = readable(body);
        let body = if self.is_written_out(kind, title, body.len()) { body } else { format!("… {}", digest(body.as_bytes())) };
        let head = format!("== {} · {title}", self.place);
        self.write_on(kind, &head);
        self.write_on(kind, &body);
    }

    fn is_written_out(&mut self, kind: &'static str, title: &str, length: usize) -> bool {
        if length <= SHORT {
            return true;
        }
        match self.size {
            Size::Long(most) => {
                let times = self.written_out.entry((kind, title.to_owned())).or_default();
                *times += 1;
                *times <= most
            }
            Size::Short(most) => {
                let spent = self.spent.entry(kind).or_default();
                let is_written_out = length <= most / 4 && *spent + length <= most;
                *spent += if is_written_out { length } else { 0 };
                is_written_out
            }
        }
    }

    /// Appends a line to the texts of a kind.
    pub(crate) fn write_on(&mut self, kind: &'static str, line: &str) {
        writeln!(self.kinds.entry(kind).or_default(), "{line}").expect("a text takes everything");
    }

    /// Kinds and their texts.
    pub(crate) fn kinds(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.kinds.iter().map(|(kind, page)| (*kind, page.as_str()))
    }

    /// Writes one file per kind into this folder.
    pub(crate) fn save(&self, folder: &Path) {
        std::fs::create_dir_all(folder).expect("the folder can be made");
        for (kind, page) in self.kinds() {
            std::fs::write(file(folder, kind), page).expect("the folder can be written to");
        }
    }

    /// First line of each kind that differs from the files in this folder, described in words.
    pub(crate) fn differences(&self, folder: &Path) -> Vec<String> {
        self.kinds().filter_map(|(kind, page)| difference(&file(folder, kind), page)).collect()
    }
}

/// Length and shortened digest of some bytes.
pub(crate) fn digest(bytes: &[u8]) -> String {
    format!("{} bytes, sha256 {}", bytes.len(), hex(&Sha256::digest(bytes)[..12]))
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Text unchanged; other bytes in hexadecimal.
pub(crate) fn readable(body: &[u8]) -> String {
    let is_text = |text: &&str| text.chars().all(|letter| !letter.is_control() || matches!(letter, '\n' | '\r' | '\t'));
    std::str::from_utf8(body).ok().filter(is_text).map_or_else(|| format!("0x{}", hex(body)), |text| text.replace('\r', "␍"))
}

fn file(folder: &Path, kind: &str) -> PathBuf {
    folder.join(format!("{kind}.txt"))
}

fn difference(path: &Path, page: &str) -> Option<String> {
    let Ok(kept) = std::fs::read_to_string(path) else { return Some(format!("{} is not there", path.display())) };
    if kept == page {
        return None;
    }
    let (mut kept, mut page, mut head) = (kept.lines(), page.lines(), "");
    for number in 1.. {
        let (before, now) = (kept.next(), page.next());
        if before != now {
            let said = |line: Option<&str>| line.map_or("nothing more".to_owned(), |line| format!("{line:?}"));
            let (before, now) = (said(before), said(now));
            return Some(format!("{}:{number}, under {head:?}\n  before {before}\n  now    {now}", path.display()));
        }
        match now {
            Some(line) if line.starts_with("== ") => head = line,
            Some(_) => {}
            None => break,
        }
    }
    Some(format!("{} ends otherwise", path.display()))
}
