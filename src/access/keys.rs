//! The named keys. This file finds the owner of a token, and adds, replaces and removes keys. `file` stores the keys.

use std::sync::Arc;

use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

use super::error::AccessError;
use super::moment::End;
use super::role::Role;
use super::token::Token;

/// Name of the key that is created at the first start.
pub const OPERATOR: &str = "operator";

/// Maximum number of keys: enough for all persons and programs of a site. The number is limited because the token of
/// each request is compared with all keys.
const MOST: usize = 64;

/// Maximum length of a key's name. Names appear in records, in cookies and on pages.
const NAME: usize = 32;

#[derive(Clone, Debug)]
pub struct Key {
    pub name: Arc<str>,
    pub role: Role,
    pub token: Token,
    print: [u8; 32],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignedIn {
    pub name: Arc<str>,
    pub role: Role,
    /// The name that a person gave when signing in with this key. It gives no rights.
    pub person: Option<Arc<str>>,
    /// Digest of the key's token. Each new token has a different digest.
    pub(super) print: [u8; 32],
    /// When the session ends; `None` for a token that is sent with each request.
    pub(super) end: Option<End>,
}

/// All keys. At least one is an operator's key, except when the key file cannot be used: then there are no keys.
#[derive(Clone, Debug)]
pub struct Keys(Vec<Key>);

impl Key {
    pub fn new(name: &str, role: Role, token: Token) -> Result<Key, AccessError> {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !(1..=NAME).contains(&name.len()) || !name.bytes().all(is_plain) {
            return Err(AccessError::Name(name.chars().take(2 * NAME).collect()));
        }
        let print = print(token.reveal());
        Ok(Key { name: Arc::from(name), role, token, print })
    }

    pub(super) fn still_is(&self, signed_in: &SignedIn) -> bool {
        SignedIn { person: signed_in.person.clone(), ..self.holder(signed_in.end) } == *signed_in
    }

    pub(super) fn holder(&self, end: Option<End>) -> SignedIn {
        SignedIn { name: Arc::clone(&self.name), role: self.role, person: None, print: self.print, end }
    }
}

impl Keys {
    pub fn first() -> Result<Keys, AccessError> {
        Ok(Keys(vec![Key::new(OPERATOR, Role::Operator, Token::draw()?)?]))
    }

    pub(super) const fn none() -> Keys {
        Keys(Vec::new())
    }

    /// Refuses duplicate names, too many keys, and a list without an operator's key.
    pub fn new(keys: Vec<Key>) -> Result<Keys, AccessError> {
        let mut all = Keys(Vec::new());
        keys.into_iter().try_for_each(|key| all.insert(key))?;
        all.keep_an_operator(OPERATOR)?;
        Ok(all)
    }

    pub fn iter(&self) -> impl Iterator<Item = &Key> {
        self.0.iter()
    }

    pub fn named(&self, name: &str) -> Result<&Key, AccessError> {
        self.place(name).map(|place| &self.0[place])
    }

    /// Returns the owner of a token. Takes the same time for every text: the whole SHA-256 of the text is compared
    /// with the SHA-256 of every token.
    pub fn check(&self, token: &str) -> Option<SignedIn> {
        let given = print(token);
        let hits = self.0.iter().map(|key| bool::from(key.print.ct_eq(&given)));
        let found = hits.enumerate().fold(None, |found, (place, hit)| if hit { Some(place) } else { found });
        found.map(|place| self.0[place].holder(None))
    }

    pub fn add(&mut self, name: &str, role: Role) -> Result<&Key, AccessError> {
        self.insert(Key::new(name, role, Token::draw()?)?)?;
        self.named(name)
    }

    /// Gives a key a new token; the old token, and the sessions signed with it, become invalid.
    pub fn rotate(&mut self, name: &str) -> Result<&Key, AccessError> {
        let place = self.place(name)?;
        self.0[place] = Key::new(name, self.0[place].role, Token::draw()?)?;
        Ok(&self.0[place])
    }

    /// Removes a key. Refuses to remove the last operator's key.
    pub fn remove(&mut self, name: &str) -> Result<(), AccessError> {
        let removed = self.0.remove(self.place(name)?);
        let kept = self.keep_an_operator(name);
        if kept.is_err() {
            self.0.push(removed);
        }
        kept
    }

    fn insert(&mut self, key: Key) -> Result<(), AccessError> {
        if self.0.iter().any(|other| other.name == key.name) {
            return Err(AccessError::Taken(key.name.to_string()));
        }
        if self.0.len() >= MOST {
            return Err(AccessError::TooMany(MOST));
        }
        self.0.push(key);
        Ok(())
    }

    fn keep_an_operator(&self, name: &str) -> Result<(), AccessError> {
        let is_kept = self.0.iter().any(|key| key.role == Role::Operator);
        if is_kept { Ok(()) } else { Err(AccessError::LastOperator(name.to_owned())) }
    }

    fn place(&self, name: &str) -> Result<usize, AccessError> {
        let there = || self.0.iter().map(|key| key.name.to_string()).collect();
        let place = self.0.iter().position(|key| &*key.name == name);
        place.ok_or_else(|| AccessError::Unknown { name: name.chars().take(2 * NAME).collect(), there: there() })
    }
}

/// Digest that is compared instead of the token. It always has the same length, and the token cannot be computed from
/// it.
fn print(token: &str) -> [u8; 32] {
    Sha256::digest(token.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys() -> Keys {
        let mut keys = Keys::first().unwrap();
        keys.add("lobby", Role::Viewer).unwrap();
        keys
    }

    /// Safety A3.
    #[test]
    fn a_token_is_its_owners_and_anything_else_is_nobodys() {
        let keys = keys();
        for key in keys.iter() {
            let signed_in = keys.check(key.token.reveal()).unwrap();
            assert_eq!((&signed_in.name, signed_in.role), (&key.name, key.role));
        }
        let token = keys.named("lobby").unwrap().token.reveal().to_owned();
        for wrong in ["", "operator", &token[1..], &format!("{token}0"), &token.to_uppercase(), &"0".repeat(64)] {
            assert_eq!(keys.check(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_rotated_key_has_a_new_token_and_the_old_one_is_worth_nothing() {
        let mut keys = keys();
        let old = keys.named("lobby").unwrap().token.clone();
        let new = keys.rotate("lobby").unwrap().clone();
        assert_eq!((keys.check(old.reveal()), new.role), (None, Role::Viewer));
        assert!(keys.check(new.token.reveal()).is_some());
    }

    /// Safety A1.
    #[test]
    fn the_last_operator_stays() {
        let mut keys = keys();
        assert!(matches!(keys.remove(OPERATOR), Err(AccessError::LastOperator(_))));
        assert!(keys.named(OPERATOR).is_ok(), "it is still there");
        keys.add("night-shift", Role::Operator).unwrap();
        keys.remove(OPERATOR).unwrap();
        assert!(keys.remove("night-shift").is_err());
        keys.remove("lobby").unwrap();
    }

    #[test]
    fn names_are_plain_unlike_and_bounded() {
        let mut keys = keys();
        for wrong in ["", "a b", "a.b", "ä", "a/b", &"a".repeat(33)] {
            assert!(matches!(keys.add(wrong, Role::Viewer), Err(AccessError::Name(_))), "{wrong}");
        }
        assert!(matches!(keys.add("lobby", Role::Operator), Err(AccessError::Taken(_))));
        let said = keys.rotate("loby").unwrap_err().to_string();
        assert!(said.contains("operator, lobby"), "{said}");
        let added = (0..MOST).filter(|number| keys.add(&format!("k{number}"), Role::Viewer).is_ok()).count();
        assert_eq!(added, MOST - 2);
    }
}
