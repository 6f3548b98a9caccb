//! Sessions that need no table in the program. The cookie names the user, and the beginning and the end of the
//! session. A MAC made with the key's own token proves that these are genuine. So a restart ends no session, and a
//! new token ends all sessions of its key. The door decides how a cookie is transported.
//!
//! ```text
//!   night-shift.1795262400.9b1e….1234.5f0c…  =  name . expiry in seconds since 1970 . run . seconds of that run at signing in
//!                                               . HMAC-SHA256(token, everything before it)
//!   night-shift.1795262400.9b1e….1234.416e6e61.5f0c…  =  the same with the name of a person, in hexadecimal digits
//!   night-shift.1795262400.5f0c…             =  the form of earlier versions, which names no run
//! ```
//!
//! In the run that opened the session, the session ends by elapsed time. So nobody can take STOP from an operator by
//! setting the machine's clock (safety S8). A later run must use the expiry and the wall clock.

use std::sync::Arc;
use std::time::Duration;

use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;
use subtle::ConstantTimeEq;

use super::keys::{Key, Keys, SignedIn};
use super::moment::{End, Moment, SESSION_S};
use super::token::hexadecimal;

/// Part of the text that the MAC covers. It keeps other MACs made with the same token from being accepted as
/// sessions.
const PURPOSE: &str = "hallsweep session 2";

/// Used in place of `PURPOSE` in cookies that name no run.
const PURPOSE_BEFORE: &str = "hallsweep session 1";

/// The name that a person gives when signing in; empty if none is given. Records and pages show it, so that several
/// people with one key can be told apart. It gives no rights.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Person(String);

impl Person {
    /// Maximum length in characters.
    pub const MOST: usize = 32;

    /// `None` for a name that is too long or has characters that are not allowed. Brackets, for example, are not
    /// allowed because records put the name in brackets.
    pub fn new(typed: &str) -> Option<Person> {
        let name = typed.split_whitespace().collect::<Vec<_>>().join(" ");
        // Hangul fillers count as letters, but are invisible.
        let is_blank = |letter: char| matches!(letter, '\u{115f}' | '\u{1160}' | '\u{3164}' | '\u{ffa0}');
        let is_sound = |letter: char| letter.is_alphanumeric() && !is_blank(letter) || " .'’-".contains(letter);
        (name.chars().count() <= Person::MOST && name.chars().all(is_sound)).then_some(Person(name))
    }
}

pub(super) fn sealed(key: &Key, run: &str, Person(person): &Person, now: Moment) -> String {
    let end_s = now.unix_s.saturating_add(SESSION_S);
    let person = if person.is_empty() { String::new() } else { format!(".{}", hexadecimal(person.as_bytes())) };
    let claim = format!("{}.{end_s}.{run}.{}{person}", key.name, now.elapsed.as_secs());
    let mac = seal(key, PURPOSE, &claim);
    format!("{claim}.{mac}")
}

/// Returns the owner of a session; `None` when the session has ended or was never opened.
pub(super) fn opened(keys: &Keys, run: &str, cookie: &str, now: Moment) -> Option<SignedIn> {
    let (claim, mac) = cookie.rsplit_once('.')?;
    let parts: Vec<&str> = claim.splitn(6, '.').collect();
    let (name, end_s, begin, person) = match parts[..] {
        [name, end_s, of, begin_s, person] => (name, end_s, Some((of, begin_s)), Some(person)),
        [name, end_s, of, begin_s] => (name, end_s, Some((of, begin_s)), None),
        [name, end_s] => (name, end_s, None, None),
        _ => return None,
    };
    let key = keys.named(name).ok()?;
    let expected = match begin {
        Some(_) => seal(key, PURPOSE, claim),
        None => seal(key, PURPOSE_BEFORE, &format!("{name}\n{end_s}")),
    };
    if !bool::from(expected.as_bytes().ct_eq(mac.as_bytes())) {
        return None;
    }
    let end = match begin {
        Some((of, begin_s)) if of == run => {
            End::Elapsed(Duration::from_secs(begin_s.parse::<u64>().ok()?.checked_add(SESSION_S.unsigned_abs())?))
        }
        _ => End::Unix(end_s.parse().ok()?),
    };
    let person = person.and_then(|digits| {
        let byte = |at| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
        let name: Option<Vec<u8>> = (0..digits.len()).step_by(2).map(byte).collect();
        String::from_utf8(name?).ok().map(Arc::from)
    });
    end.is_ahead(now).then(|| SignedIn { person, ..key.holder(Some(end)) })
}

fn seal(key: &Key, purpose: &str, claim: &str) -> String {
    let mut mac = Hmac::<Sha256>::new_from_slice(key.token.reveal().as_bytes()).expect("HMAC takes keys of any length");
    mac.update(format!("{purpose}\n{claim}").as_bytes());
    hexadecimal(&mac.finalize().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::role::Role;

    const NOW: i64 = 1_795_262_400;

    /// Seconds from the start of the program to the moment when somebody signs in.
    const BEGAN_S: u64 = 1000;

    /// The time `elapsed_s` seconds after signing in. In between, the wall clock was changed by `set_s` seconds.
    fn at(elapsed_s: i64, set_s: i64) -> Moment {
        let elapsed = Duration::from_secs(BEGAN_S.saturating_add_signed(elapsed_s));
        Moment { elapsed, unix_s: NOW + elapsed_s + set_s }
    }

    fn keys() -> Keys {
        let mut keys = Keys::first().unwrap();
        keys.add("lobby", Role::Viewer, None).unwrap();
        keys
    }

    fn cookie(keys: &Keys) -> String {
        sealed(keys.named("lobby").unwrap(), "run", &Person::default(), at(0, 0))
    }

    fn cookie_before(keys: &Keys, end_s: i64) -> String {
        let key = keys.named("lobby").unwrap();
        format!("lobby.{end_s}.{}", seal(key, "hallsweep session 1", &format!("lobby\n{end_s}")))
    }

    /// Safety S8, A2.
    #[test]
    fn in_its_own_run_a_session_is_its_owners_for_twelve_hours_however_the_clock_is_set() {
        let keys = keys();
        let cookie = cookie(&keys);
        for set_s in [0, -600, -3600, -400 * 86_400, 46_800, 30 * 86_400, i64::MIN / 2, i64::MAX / 2] {
            for later in [0, 1, SESSION_S - 1] {
                let signed_in = opened(&keys, "run", &cookie, at(later, set_s)).expect("it lasts");
                assert_eq!((&*signed_in.name, signed_in.role), ("lobby", Role::Viewer));
            }
            assert_eq!(opened(&keys, "run", &cookie, at(SESSION_S, set_s)), None, "{set_s}");
        }
    }

    /// Safety A2.
    #[test]
    fn in_a_later_run_the_wall_clock_says_when_a_session_ends_and_so_it_does_for_one_of_an_earlier_version() {
        let keys = keys();
        for cookie in [cookie(&keys), cookie_before(&keys, NOW + SESSION_S)] {
            // A later run ignores the elapsed time.
            let by_clock = |later: i64| {
                let after = |elapsed| Moment { elapsed: Duration::from_secs(elapsed), unix_s: NOW + later };
                let opened = [0, 10_000_000].map(|elapsed| opened(&keys, "later run", &cookie, after(elapsed)).is_some());
                assert_eq!(opened[0], opened[1]);
                opened[0]
            };
            assert!(by_clock(0) && by_clock(SESSION_S - 1) && !by_clock(SESSION_S));
            assert!(by_clock(-60), "the clock was put right");
            assert!(!by_clock(-3600), "the clock was wrong when it was made, or is wrong now");
        }
    }

    #[test]
    fn a_session_outlives_the_program_and_ends_with_the_token() {
        let mut keys = keys();
        let cookies = [cookie(&keys), cookie_before(&keys, NOW + SESSION_S)];
        let is_open = |keys: &Keys| cookies.each_ref().map(|cookie| opened(keys, "later run", cookie, at(0, 0)).is_some());
        assert_eq!(is_open(&keys.clone()), [true; 2], "nothing is remembered of it");
        keys.rotate("lobby").unwrap();
        assert_eq!(is_open(&keys), [false; 2]);
        keys.remove("lobby").unwrap();
        assert_eq!(is_open(&keys), [false; 2]);
    }

    /// Safety A1.
    #[test]
    fn a_session_has_the_halls_that_its_key_has_now() {
        let mut all: Vec<_> = keys().iter().cloned().collect();
        let limit = |all: &mut Vec<Key>, names: &[&str]| {
            all[1].halls = Some(crate::access::halls(names.iter().copied()).unwrap());
            Keys::new(all.clone()).unwrap()
        };
        let before = Keys::new(all.clone()).unwrap();
        let after = limit(&mut all, &["south"]);
        let other = limit(&mut all, &["east"]);
        for cookie in [cookie(&before), cookie(&after), cookie_before(&before, NOW + SESSION_S)] {
            let was = opened(&before, "run", &cookie, at(0, 0)).unwrap();
            for (keys, halls) in [(&after, "south"), (&other, "east")] {
                let signed_in = opened(keys, "run", &cookie, at(0, 0)).expect("the token is the same");
                assert_eq!(signed_in.halls.as_deref().map(|halls| halls[0].name()), Some(halls));
                assert!(!keys.named("lobby").unwrap().still_is(&was), "who was signed in before sees no more than before");
                assert!(keys.named("lobby").unwrap().still_is(&signed_in));
            }
        }
    }

    #[test]
    fn a_session_has_the_name_that_was_given_and_the_rights_of_its_key() {
        let keys = keys();
        for (typed, name) in [("Anna", "Anna"), ("  Zoë   O'Brien-Łuk ", "Zoë O'Brien-Łuk"), ("王 小明", "王 小明")] {
            let person = Person::new(typed).unwrap();
            let cookie = sealed(keys.named("lobby").unwrap(), "run", &person, at(0, 0));
            assert!(cookie.bytes().all(|byte| byte.is_ascii_alphanumeric() || b".-_".contains(&byte)), "{cookie}");
            let signed_in = opened(&keys, "run", &cookie, at(0, 0)).unwrap();
            assert_eq!((&*signed_in.name, signed_in.role, signed_in.person.as_deref()), ("lobby", Role::Viewer, Some(name)));
            assert!(keys.named("lobby").unwrap().still_is(&signed_in));
        }
        assert_eq!(opened(&keys, "run", &cookie(&keys), at(0, 0)).unwrap().person, None);
    }

    #[test]
    fn a_name_is_short_and_has_nothing_that_is_not_seen_or_is_markup_or_closes_a_bracket() {
        for none in ["", " ", "\t\r\n"] {
            assert_eq!(Person::new(none), Some(Person::default()));
        }
        let longest = "ж".repeat(Person::MOST);
        assert_eq!(Person::new(&longest), Some(Person(longest.clone())));
        let longer = format!("{longest}ж");
        for wrong in [
            &*longer,
            "a\0b",
            "a\u{202e}b",
            "a\u{200b}b",
            "<b>Anna",
            "Anna) (console",
            "a\u{3164}",
            "a,b",
            "a\"b",
            "a&b",
            "=1",
            "a;b",
        ] {
            assert_eq!(Person::new(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_session_that_was_changed_anywhere_is_nobodys() {
        let keys = keys();
        let (now, before) = (cookie(&keys), cookie_before(&keys, NOW + SESSION_S));
        let named = sealed(keys.named("lobby").unwrap(), "run", &Person::new("Anna").unwrap(), at(0, 0));
        assert_eq!(opened(&keys, "run", &named.replace(".416e6e61.", "."), at(0, 0)), None);
        for cookie in [&now, &before, &named] {
            for place in 0..cookie.len() {
                let mut bytes = cookie.clone().into_bytes();
                bytes[place] = if bytes[place] == b'1' { b'2' } else { b'1' };
                let changed = String::from_utf8(bytes).unwrap();
                assert_eq!(opened(&keys, "run", &changed, at(0, 0)), None, "{changed}");
            }
            let promoted = cookie.replace("lobby", "operator");
            for wrong in ["", ".", "..", "....", "lobby", "lobby..", &promoted, &format!("{cookie}.x"), &format!("{cookie}0")] {
                assert_eq!(opened(&keys, "run", wrong, at(0, 0)), None, "{wrong}");
            }
        }
        // The MAC does not fit a cookie that names another run, or no run.
        let mac = now.rsplit('.').next().unwrap();
        for claim in [format!("lobby.{}", NOW + SESSION_S), format!("lobby.{}.later.1000", NOW + SESSION_S)] {
            assert_eq!(opened(&keys, "later", &format!("{claim}.{mac}"), at(0, 0)), None, "{claim}");
        }
    }
}
