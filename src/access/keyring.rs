//! The keys of the running program. They are looked up in memory, so that a STOP never waits for a disk. A thread
//! checks whether the key file has changed, so that a replaced token soon becomes invalid. The code here never
//! changes a key.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use super::error::AccessError;
use super::file::{KeyFile, Stamp, written};
use super::keys::{Keys, SignedIn};
use super::moment::Moment;
use super::session::{self, Person};
use super::token::{chance, hexadecimal};
use crate::storage::private_file::Readers;

/// Interval at which the key file is checked. A removed key stays valid for this time at most.
const GLANCE: Duration = Duration::from_millis(250);

/// The keys known to the running program. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Keyring {
    keys: Arc<Mutex<Arc<Keys>>>,
    /// Distinguishes this run of the program from all other runs. Random, since the wall clock may show the same time at two
    /// starts.
    run: Arc<str>,
}

#[derive(Debug)]
pub struct Opened {
    pub keyring: Keyring,
    pub is_new: bool,
    /// Why the existing keys cannot be read. Nobody is admitted until the file is mended.
    pub unusable: Option<AccessError>,
}

impl Keyring {
    /// Opens the keys of this data folder, and creates an operator's key when no keys exist. Later changes of the
    /// file are applied too.
    pub fn open(folder: &Path) -> Result<Opened, AccessError> {
        let file = KeyFile::within(folder);
        // The stamp is taken before the file is read, so that a change in between is noticed and read.
        let seen = file.stamp().ok();
        let kept = file.read_with_readers();
        let is_new = matches!(kept, Ok(None));
        let (keys, unusable) = match kept {
            Ok(Some((keys, readers))) => {
                say_who_else(&file, readers);
                (keys, None)
            }
            Ok(None) => {
                let keys = Keys::first()?;
                file.write(&keys)?;
                if let Ok(Some((_, readers))) = file.read_with_readers() {
                    say_who_else(&file, readers);
                }
                (keys, None)
            }
            Err(error) => {
                tracing::error!(%error, "nobody can sign in");
                (Keys::none(), Some(error))
            }
        };
        let keyring = Keyring::of(keys)?;
        let theirs = Arc::downgrade(&keyring.keys);
        std::thread::spawn(move || follow(&theirs, Followed { file, seen }));
        Ok(Opened { keyring, is_new, unusable })
    }

    /// Makes an operator's key that is not stored.
    pub fn in_memory() -> Result<Keyring, AccessError> {
        Keyring::of(Keys::first()?)
    }

    pub fn of(keys: Keys) -> Result<Keyring, AccessError> {
        let run = hexadecimal(&chance()?[..8]).into();
        Ok(Keyring { keys: Arc::new(Mutex::new(Arc::new(keys))), run })
    }

    /// Whether nobody has a key, because the key file cannot be used.
    pub fn is_unusable(&self) -> bool {
        self.keys().iter().next().is_none()
    }

    pub fn keys(&self) -> Arc<Keys> {
        Arc::clone(&lock(&self.keys))
    }

    /// Returns the owner of a token. Takes the same time for every text.
    pub fn check(&self, token: &str) -> Option<SignedIn> {
        self.keys().check(token)
    }

    /// Opens a session for the owner of this token; returns the value of the session cookie.
    pub fn sign_in(&self, token: &str, person: &Person, now: Moment) -> Option<String> {
        let keys = self.keys();
        let signed_in = keys.check(token)?;
        keys.named(&signed_in.name).ok().map(|key| session::sealed(key, &self.run, person, now))
    }

    pub fn session(&self, cookie: &str, now: Moment) -> Option<SignedIn> {
        session::opened(&self.keys(), &self.run, cookie, now)
    }

    /// Whether a caller is still valid: the key exists with the same token, role and halls, and the session has not ended.
    pub fn still_knows(&self, signed_in: &SignedIn, now: Moment) -> bool {
        let lasts = signed_in.end.is_none_or(|end| end.is_ahead(now));
        lasts && self.keys().named(&signed_in.name).is_ok_and(|key| key.still_is(signed_in))
    }
}

fn lock(keys: &Mutex<Arc<Keys>>) -> MutexGuard<'_, Arc<Keys>> {
    keys.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Logs who can read the keys besides the owner, if this is accepted.
fn say_who_else(file: &KeyFile, readers: Readers) {
    let file = file.path().display();
    match readers {
        Readers::Owner | Readers::Others(_) => {}
        Readers::Group => tracing::info!(%file, "the group that may write to the data folder can read the keys"),
        Readers::OfVolume => {
            tracing::warn!(%file, "all files on this volume have the same mode: everybody who can use the volume can read the \
                                   keys");
        }
    }
}

struct Followed {
    file: KeyFile,
    seen: Option<Stamp>,
}

impl Followed {
    /// Applies a change of the file. An unreadable file changes nothing: no new keys are accepted, and everybody who
    /// could press STOP still can.
    fn look(&mut self, current: &Mutex<Arc<Keys>>) {
        let stamp = self.file.stamp().ok();
        if stamp == self.seen {
            return;
        }
        let file = self.file.path().display();
        match self.file.read() {
            // The keys are the same: only the time of the file has changed, or this program wrote the file when it
            // started.
            Ok(Some(keys)) if written(&keys) == written(&lock(current)) => {}
            Ok(Some(keys)) => {
                *lock(current) = Arc::new(keys);
                tracing::info!(%file, "the keys have changed");
            }
            Ok(None) => tracing::error!(%file, "the key file is missing: the keys that were read before stay valid"),
            Err(error) => tracing::error!(%error, "the new keys cannot be used: the keys that were read before stay valid"),
        }
        self.seen = stamp;
    }
}

fn follow(keys: &Weak<Mutex<Arc<Keys>>>, mut followed: Followed) {
    loop {
        std::thread::sleep(GLANCE);
        let Some(keys) = keys.upgrade() else { return };
        followed.look(&keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::role::Role;
    use crate::storage::tests::scratch::Scratch;

    const NOW: Moment = Moment { elapsed: Duration::from_secs(1000), unix_s: 1_795_262_400 };

    /// Waits until the thread has applied a change, even on a busy machine.
    fn until(what: &str, is_so: impl Fn() -> bool) {
        for _ in 0..600 {
            if is_so() {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("never came to be: {what}");
    }

    fn token(keyring: &Keyring) -> String {
        keyring.keys().iter().next().unwrap().token.reveal().to_owned()
    }

    /// Safety A1.
    #[test]
    fn the_first_start_makes_a_key_and_the_next_finds_it() {
        let folder = Scratch::new();
        let first = Keyring::open(&folder.0).unwrap();
        let next = Keyring::open(&folder.0).unwrap();
        assert!(first.is_new && !next.is_new);
        assert_eq!(token(&first.keyring), token(&next.keyring));
        let signed_in = next.keyring.check(&token(&first.keyring)).unwrap();
        assert_eq!((&*signed_in.name, signed_in.role), ("operator", Role::Operator));
    }

    #[test]
    fn a_rotated_key_ends_its_tokens_sessions_and_whoever_is_signed_in() {
        let folder = Scratch::new();
        let keyring = Keyring::open(&folder.0).unwrap().keyring;
        let old = token(&keyring);
        let cookie = keyring.sign_in(&old, &Person::new("Anna").unwrap(), NOW).unwrap();
        let (by_token, by_cookie) = (keyring.check(&old).unwrap(), keyring.session(&cookie, NOW).unwrap());
        assert!(keyring.still_knows(&by_token, NOW) && keyring.still_knows(&by_cookie, NOW));
        let later = Moment { elapsed: NOW.elapsed + Duration::from_secs(crate::access::SESSION_S.unsigned_abs()), ..NOW };
        assert!(!keyring.still_knows(&by_cookie, later), "a session ends by itself");
        let mut keys = (*keyring.keys()).clone();
        keys.rotate("operator").unwrap();
        KeyFile::within(&folder.0).write(&keys).unwrap();
        until("the old token is refused", || keyring.check(&old).is_none());
        assert_eq!(keyring.session(&cookie, NOW), None);
        assert!(!keyring.still_knows(&by_token, NOW) && !keyring.still_knows(&by_cookie, NOW));
        assert!(keyring.check(keys.named("operator").unwrap().token.reveal()).is_some());
    }

    /// Safety A1.
    #[test]
    fn a_hand_that_changes_the_halls_of_a_key_ends_what_is_open_with_it_and_nothing_else() {
        let folder = Scratch::new();
        let file = KeyFile::within(&folder.0);
        let mut keys = Keys::first().unwrap();
        let shown = keys.add("lobby", Role::Viewer, None).unwrap().token.reveal().to_owned();
        file.write(&keys).unwrap();
        let keyring = Keyring::of(keys).unwrap();
        let mut followed = Followed { seen: file.stamp().ok(), file: file.clone() };
        let cookie = keyring.sign_in(&shown, &Person::default(), NOW).unwrap();
        let signed_in = || [keyring.check(&shown).unwrap(), keyring.session(&cookie, NOW).unwrap()];
        let operator = keyring.check(&token(&keyring)).unwrap();
        let whole = std::fs::read_to_string(file.path()).unwrap();
        for line in ["halls = [\"south\"]\n", "halls = [\"south\", \"east\"]\n", "halls = [\"east\", \"south\"]\n", ""] {
            let before = signed_in();
            std::fs::write(file.path(), whole.replace("role = \"viewer\"\n", &format!("role = \"viewer\"\n{line}"))).unwrap();
            followed.look(&keyring.keys);
            assert_eq!(before.map(|before| keyring.still_knows(&before, NOW)), [false; 2], "{line}");
            assert_eq!(signed_in().map(|after| keyring.still_knows(&after, NOW)), [true; 2], "{line}");
            assert!(keyring.still_knows(&operator, NOW), "others are left alone");
        }
        let before = signed_in();
        std::fs::write(file.path(), whole.replace("\"viewer\"\n", "\"viewer\"\nhalls = []\n")).unwrap();
        followed.look(&keyring.keys);
        assert!(before.iter().all(|before| keyring.still_knows(before, NOW)), "what is malformed changes nothing");
    }

    /// Safety S1: an unreadable file admits nobody new, and locks nobody out.
    #[test]
    fn a_file_that_cannot_be_read_lets_nobody_in_and_shuts_nobody_out() {
        let folder = Scratch::new();
        let file = KeyFile::within(&folder.0);
        let keyring = Keyring::in_memory().unwrap();
        file.write(&keyring.keys()).unwrap();
        let mut followed = Followed { seen: file.stamp().ok(), file: file.clone() };
        let (known, stranger) = (token(&keyring), "cd".repeat(32));
        for ruined in [Some("nonsense"), Some(""), None] {
            match ruined {
                Some(text) => std::fs::write(file.path(), text).unwrap(),
                None => std::fs::remove_file(file.path()).unwrap(),
            }
            followed.look(&keyring.keys);
            assert!(keyring.check(&stranger).is_none() && keyring.check("").is_none());
            assert!(keyring.check(&known).is_some(), "an operator can still stop the robot");
        }
        let keys = Keys::first().unwrap();
        file.write(&keys).unwrap();
        followed.look(&keyring.keys);
        assert!(keyring.check(&known).is_none(), "the mended file counts");
        assert!(keyring.check(&token(&Keyring::of(keys).unwrap())).is_some());
    }

    /// Safety R5: with a damaged key file the start succeeds, but nobody is admitted. The mended file is used at
    /// once.
    #[test]
    fn a_ruined_file_lets_nobody_in_until_it_is_mended() {
        let folder = Scratch::new();
        let token = token(&Keyring::open(&folder.0).unwrap().keyring);
        let file = KeyFile::within(&folder.0).path().to_owned();
        let whole = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, "nonsense").unwrap();
        let Opened { keyring, is_new, unusable } = Keyring::open(&folder.0).unwrap();
        assert!(!is_new && unusable.unwrap().to_string().contains("access.toml"));
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "nonsense", "it stays as it is");
        for shown in [token.as_str(), "", "nonsense"] {
            assert!(keyring.is_unusable() && keyring.check(shown).is_none() && keyring.session(shown, NOW).is_none());
        }
        std::fs::write(&file, whole).unwrap();
        until("the mended file counts", || keyring.check(&token).is_some());
        assert!(!keyring.is_unusable());
    }

    #[test]
    fn keys_in_memory_are_new_each_time() {
        assert_ne!(token(&Keyring::in_memory().unwrap()), token(&Keyring::in_memory().unwrap()));
    }
}
