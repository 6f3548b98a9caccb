//! The named keys. This file finds the owner of a token, and adds, replaces and removes keys. `file` stores the keys.

use std::sync::Arc;

use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

use super::error::AccessError;
use super::moment::End;
use super::role::Role;
use super::token::Token;
use hallsweep_core::hall::HallId;

/// Name of the key that is created at the first start.
pub const OPERATOR: &str = "operator";

/// Maximum number of keys: enough for all persons and programs of a site. The number is limited because the token of
/// each request is compared with all keys.
const MOST: usize = 64;

/// Maximum number of halls to which a key is limited: the maximum number of halls of one process.
const HALLS: usize = 128;

/// Maximum length of a key's name. Names appear in records, in cookies and on pages.
const NAME: usize = 32;

#[derive(Clone, Debug)]
pub struct Key {
    pub name: Arc<str>,
    pub role: Role,
    /// The only halls that this key sees; `None` for all halls, also future ones.
    pub halls: Option<Arc<[HallId]>>,
    pub token: Token,
    print: [u8; 32],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignedIn {
    pub name: Arc<str>,
    pub role: Role,
    /// The name that a person gave when signing in with this key. It gives no rights.
    pub person: Option<Arc<str>>,
    pub(super) halls: Option<Arc<[HallId]>>,
    /// Digest of the key's token. Each new token has a different digest.
    pub(super) print: [u8; 32],
    /// When the session ends; `None` for a token that is sent with each request.
    pub(super) end: Option<End>,
}

/// All keys. At least one is an operator's key for all halls, except when the key file cannot be used: then there are no keys.
#[derive(Clone, Debug)]
pub struct Keys(Vec<Key>);

impl Key {
    pub fn new(name: &str, role: Role, token: Token) -> Result<Key, AccessError> {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !(1..=NAME).contains(&name.len()) || !name.bytes().all(is_plain) {
            return Err(AccessError::Name(name.chars().take(2 * NAME).collect()));
        }
        let print = print(token.reveal());
        Ok(Key { name: Arc::from(name), role, halls: None, token, print })
    }

    pub fn sees(&self, hall: &HallId) -> bool {
        sees(self.halls.as_deref(), hall)
    }

    pub(super) fn still_is(&self, signed_in: &SignedIn) -> bool {
        SignedIn { person: signed_in.person.clone(), ..self.holder(signed_in.end) } == *signed_in
    }

    pub(super) fn holder(&self, end: Option<End>) -> SignedIn {
        SignedIn {
            name: Arc::clone(&self.name),
            role: self.role,
            person: None,
            halls: self.halls.clone(),
            print: self.print,
            end,
        }
    }
}

/// The halls of a limited key. Refuses an empty list, because an empty list and no list are easily mistaken for each
/// other.
pub fn halls<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Arc<[HallId]>, AccessError> {
    let mut halls = Vec::new();
    for name in names {
        if halls.len() >= HALLS {
            return Err(AccessError::HallCount(HALLS));
        }
        let hall = HallId::new(name).ok_or_else(|| AccessError::Hall(name.chars().take(2 * HallId::MOST).collect()))?;
        if halls.contains(&hall) {
            return Err(AccessError::HallTwice(hall));
        }
        halls.push(hall);
    }
    if halls.is_empty() { Err(AccessError::HallCount(HALLS)) } else { Ok(halls.into()) }
}

pub(super) fn sees(halls: Option<&[HallId]>, hall: &HallId) -> bool {
    halls.is_none_or(|halls| halls.contains(hall))
}

impl Keys {
    pub fn first() -> Result<Keys, AccessError> {
        Ok(Keys(vec![Key::new(OPERATOR, Role::Operator, Token::draw()?)?]))
    }

    pub(super) const fn none() -> Keys {
        Keys(Vec::new())
    }

    /// Refuses duplicate names, too many keys, and a list without an operator's key for all halls.
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

    pub fn add(&mut self, name: &str, role: Role, halls: Option<Arc<[HallId]>>) -> Result<&Key, AccessError> {
        self.insert(Key { halls, ..Key::new(name, role, Token::draw()?)? })?;
        self.named(name)
    }

    /// Gives a key a new token; the old token, and the sessions signed with it, become invalid.
    pub fn rotate(&mut self, name: &str) -> Result<&Key, AccessError> {
        let place = self.place(name)?;
        let Key { role, ref halls, .. } = self.0[place];
        self.0[place] = Key { halls: halls.clone(), ..Key::new(name, role, Token::draw()?)? };
        Ok(&self.0[place])
    }

    /// Removes a key. Refuses to remove the last operator's key for all halls.
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
        let mut operators = self.0.iter().filter(|key| key.role == Role::Operator).peekable();
        if operators.peek().is_none() {
            return Err(AccessError::LastOperator(name.to_owned()));
        }
        let is_kept = operators.any(|key| key.halls.is_none());
        if is_kept { Ok(()) } else { Err(AccessError::LastOfAllHalls(name.to_owned())) }
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
        keys.add("lobby", Role::Viewer, None).unwrap();
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
        keys.add("night-shift", Role::Operator, None).unwrap();
        keys.remove(OPERATOR).unwrap();
        assert!(keys.remove("night-shift").is_err());
        keys.remove("lobby").unwrap();
    }

    fn of(names: &[&str]) -> Option<Arc<[HallId]>> {
        Some(halls(names.iter().copied()).unwrap())
    }

    /// Safety A1.
    #[test]
    fn the_last_operator_of_all_halls_stays_though_others_have_some_halls() {
        let mut keys = keys();
        keys.add("south-desk", Role::Operator, of(&["south"])).unwrap();
        keys.add("watcher", Role::Viewer, None).unwrap();
        let said = keys.remove(OPERATOR).unwrap_err().to_string();
        assert!(
            said.contains("`operator` is the last operator's key for all halls") && said.contains("without --halls"),
            "{said}"
        );
        assert!(keys.named(OPERATOR).is_ok(), "it is still there");
        keys.add("night-shift", Role::Operator, None).unwrap();
        keys.remove(OPERATOR).unwrap();
        keys.remove("south-desk").unwrap();
        let said = keys.remove("night-shift").unwrap_err().to_string();
        assert_eq!(
            said,
            "`night-shift` is the last operator's key: add another with `hallsweep token add NAME --role operator` first"
        );
    }

    #[test]
    fn a_rotated_key_keeps_its_halls_and_a_key_that_is_added_again_has_the_new_ones() {
        let mut keys = keys();
        let old = keys.add("south-desk", Role::Operator, of(&["south", "east"])).unwrap().clone();
        let new = keys.rotate("south-desk").unwrap().clone();
        assert_eq!((new.role, &new.halls), (Role::Operator, &of(&["south", "east"])));
        assert_eq!(keys.rotate("lobby").unwrap().halls, None);
        let signed_in = [old, new].map(|key| key.holder(None));
        assert!(!keys.named("south-desk").unwrap().still_is(&signed_in[0]));
        assert!(keys.named("south-desk").unwrap().still_is(&signed_in[1]));
        keys.remove("south-desk").unwrap();
        let again = keys.add("south-desk", Role::Operator, of(&["east"])).unwrap();
        assert!(again.halls == of(&["east"]) && !again.still_is(&signed_in[1]));
    }

    #[test]
    fn whoever_is_signed_in_is_another_when_the_halls_of_the_key_change_at_all() {
        let mut key = Key::new("lobby", Role::Viewer, Token::draw().unwrap()).unwrap();
        let lists = [None, of(&["south"]), of(&["south", "east"]), of(&["east", "south"]), of(&["west"])];
        for before in &lists {
            key.halls.clone_from(before);
            let signed_in = SignedIn { person: Some(Arc::from("Anna")), ..key.holder(None) };
            for after in &lists {
                key.halls.clone_from(after);
                assert_eq!(key.still_is(&signed_in), before == after, "{before:?} {after:?}");
            }
        }
    }

    #[test]
    fn halls_are_named_plainly_once_and_not_too_often() {
        for wrong in ["", " south", "South", "s_1", "1st", "a.b", "a/b", "all ", "*", "ä", &"a".repeat(33), &"ab".repeat(32)] {
            assert!(matches!(halls(["east", wrong]), Err(AccessError::Hall(_))), "{wrong}");
        }
        assert!(matches!(halls(["east", "south", "east"]), Err(AccessError::HallTwice(_))));
        assert!(matches!(halls([]), Err(AccessError::HallCount(HALLS))));
        let many: Vec<String> = (0..=HALLS).map(|number| format!("h{number}")).collect();
        assert!(matches!(halls(many.iter().map(String::as_str)), Err(AccessError::HallCount(HALLS))));
        assert_eq!(halls(many[1..].iter().map(String::as_str)).unwrap().len(), HALLS);
    }

    #[test]
    fn names_are_plain_unlike_and_bounded() {
        let mut keys = keys();
        for wrong in ["", "a b", "a.b", "ä", "a/b", &"a".repeat(33)] {
            assert!(matches!(keys.add(wrong, Role::Viewer, None), Err(AccessError::Name(_))), "{wrong}");
        }
        assert!(matches!(keys.add("lobby", Role::Operator, None), Err(AccessError::Taken(_))));
        let said = keys.rotate("loby").unwrap_err().to_string();
        assert!(said.contains("operator, lobby"), "{said}");
        let added = (0..MOST).filter(|number| keys.add(&format!("k{number}"), Role::Viewer, None).is_ok()).count();
        assert_eq!(added, MOST - 2);
    }
}
