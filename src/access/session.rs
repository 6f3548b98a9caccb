//! Sessions that need no table: the cookie says who and until when, and a MAC made with the key's own token says that it is
//! true. So a restart signs nobody out, and a rotated key ends its sessions. How a cookie travels is a door's business.
//!
//! ```text
//!   night-shift.1795262400.5f0c…  =  name . expiry in seconds since 1970 . HMAC-SHA256(token, name and expiry)
//! ```

use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;
use subtle::ConstantTimeEq;

use super::keys::{Key, Keys, SignedIn};
use super::token::hexadecimal;

/// How long a session lasts, in seconds: a shift.
pub const SESSION_S: i64 = 12 * 60 * 60;

/// How far the clock may be set back without signing everybody out, in seconds.
const SLACK_S: i64 = 5 * 60;

/// What the MAC is about, so that no other MAC made with a token could ever be taken for it.
const PURPOSE: &str = "hallsweep session 1";

/// A new session of whoever has this key, from `now_s` on, in seconds since 1970.
pub(super) fn sealed(key: &Key, now_s: i64) -> String {
    let until_s = now_s.saturating_add(SESSION_S);
    format!("{}.{until_s}.{}", key.name, seal(key, until_s))
}

/// Whose session this is; `None` when it has ended, or was never given out.
pub(super) fn opened(keys: &Keys, cookie: &str, now_s: i64) -> Option<SignedIn> {
    let mut parts = cookie.splitn(3, '.');
    let (name, until, mac) = (parts.next()?, parts.next()?, parts.next()?);
    let until_s: i64 = until.parse().ok()?;
    let key = keys.named(name).ok()?;
    let is_true = bool::from(seal(key, until_s).as_bytes().ct_eq(mac.as_bytes()));
    // One that ends later than any given out now was sealed by a clock that was wrong, and could last for ever.
    let is_current = until_s > now_s && until_s <= now_s.saturating_add(SESSION_S + SLACK_S);
    (is_true && is_current).then(|| key.holder(Some(until_s)))
}

fn seal(key: &Key, until_s: i64) -> String {
    let mut mac = Hmac::<Sha256>::new_from_slice(key.token.reveal().as_bytes()).expect("HMAC takes keys of any length");
    mac.update(format!("{PURPOSE}\n{}\n{until_s}", key.name).as_bytes());
    hexadecimal(&mac.finalize().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::role::Role;

    const NOW: i64 = 1_795_262_400;

    fn keys() -> Keys {
        let mut keys = Keys::first().unwrap();
        keys.add("lobby", Role::Viewer).unwrap();
        keys
    }

    /// Safety A2.
    #[test]
    fn a_session_is_its_owners_for_twelve_hours() {
        let keys = keys();
        let cookie = sealed(keys.named("lobby").unwrap(), NOW);
        for later in [0, 1, SESSION_S - 1] {
            let signed_in = opened(&keys, &cookie, NOW + later).expect("it lasts");
            assert_eq!((&*signed_in.name, signed_in.role), ("lobby", Role::Viewer));
        }
        assert_eq!(opened(&keys, &cookie, NOW + SESSION_S), None);
        assert!(opened(&keys, &cookie, NOW - 60).is_some(), "the clock was put right");
        assert_eq!(opened(&keys, &cookie, NOW - 3600), None, "the clock was wrong when it was made, or is wrong now");
    }

    #[test]
    fn a_session_outlives_the_program_and_ends_with_the_token() {
        let mut keys = keys();
        let cookie = sealed(keys.named("lobby").unwrap(), NOW);
        assert!(opened(&keys.clone(), &cookie, NOW).is_some(), "nothing is remembered of it");
        keys.rotate("lobby").unwrap();
        assert_eq!(opened(&keys, &cookie, NOW), None);
        keys.remove("lobby").unwrap();
        assert_eq!(opened(&keys, &cookie, NOW), None);
    }

    #[test]
    fn a_session_that_was_changed_anywhere_is_nobodys() {
        let keys = keys();
        let cookie = sealed(keys.named("lobby").unwrap(), NOW);
        for place in 0..cookie.len() {
            let mut bytes = cookie.clone().into_bytes();
            bytes[place] = if bytes[place] == b'1' { b'2' } else { b'1' };
            let changed = String::from_utf8(bytes).unwrap();
            assert_eq!(opened(&keys, &changed, NOW), None, "{changed}");
        }
        let promoted = cookie.replace("lobby", "operator");
        for wrong in ["", ".", "..", "lobby", "lobby..", &promoted, &format!("{cookie}.x"), &format!("{cookie}0")] {
            assert_eq!(opened(&keys, wrong, NOW), None, "{wrong}");
        }
    }
}
