//! The query of an address. Every value is checked, and unknown names are refused, so that a mistyped name is
//! noticed.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;

use super::problem::Problem;
use crate::api::fields::in_short;

/// The largest number that the archive can store.
pub(super) const MOST: u64 = i64::MAX as u64;

/// The values by name. They are numbers and simple words, so escapes are not decoded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Query(BTreeMap<String, Vec<String>>);

impl<S: Send + Sync> FromRequestParts<S> for Query {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Query, Problem> {
        Ok(Query::of(parts.uri.query().unwrap_or_default()))
    }
}

impl Query {
    fn of(text: &str) -> Query {
        let mut values: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for pair in text.split('&').filter(|pair| !pair.is_empty()) {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            values.entry(name.to_owned()).or_default().push(value.to_owned());
        }
        Query(values)
    }

    /// Refuses a query with an unknown name, or with a known name that occurs twice.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), Problem> {
        self.only_with_many(known, &[])
    }

    /// Refuses a query with a name that is in neither list, or with a name that is in `once` and occurs several
    /// times.
    pub(super) fn only_with_many(&self, once: &[&str], many: &[&str]) -> Result<(), Problem> {
        for (name, values) in &self.0 {
            let is_single = once.contains(&name.as_str());
            if !is_single && !many.contains(&name.as_str()) {
                let known = [once, many].concat().join(", ");
                return Err(Problem::unusable(format!("there is no parameter `{}`: the parameters are {known}", in_short(name))));
            }
            if is_single && values.len() > 1 {
                return Err(Problem::unusable(format!("`{}` occurs twice: send it once", in_short(name))));
            }
        }
        Ok(())
    }

    pub(super) fn every(&self, name: &str) -> &[String] {
        self.0.get(name).map_or(&[], Vec::as_slice)
    }

    fn first(&self, name: &str) -> Option<&String> {
        self.every(name).first()
    }

    pub(super) fn count(&self, name: &str, range: RangeInclusive<u64>) -> Result<Option<u64>, Problem> {
        let Some(text) = self.first(name) else { return Ok(None) };
        let sound = text.parse().ok().filter(|number| range.contains(number));
        sound.map(Some).ok_or_else(|| {
            let most = if *range.end() == MOST { String::new() } else { format!(" to {}", range.end()) };
            let wanted = format!("send a whole number from {}{most}", range.start());
            Problem::unusable(format!("`{name}` is {:?}: {wanted}", in_short(text)))
        })
    }

    pub(super) fn word<'w>(&self, name: &str, words: &[&'w str]) -> Result<Option<&'w str>, Problem> {
        let Some(text) = self.first(name) else { return Ok(None) };
        let known = words.iter().find(|word| *word == text);
        known
            .copied()
            .map(Some)
            .ok_or_else(|| Problem::unusable(format!("`{name}` is {:?}: send {}", in_short(text), words.join(" or "))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(text: &str) -> Result<Option<u64>, String> {
        let said = |problem: Problem| problem.detail().to_owned();
        let query = Query::of(text);
        query.only(&["limit"]).and_then(|()| query.count("limit", 1..=100)).map_err(said)
    }

    #[test]
    fn a_number_within_its_range_is_taken_and_absent_ones_are_no_mistake() {
        assert_eq!((limit(""), limit("limit=1"), limit("limit=100&")), (Ok(None), Ok(Some(1)), Ok(Some(100))));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_name_its_value_and_what_belongs_there() {
        for wrong in ["0", "101", "-1", "1.5", "", "ten", "99999999999999999999", "%31"] {
            let said = format!("`limit` is {wrong:?}: send a whole number from 1 to 100");
            assert_eq!(limit(&format!("limit={wrong}")), Err(said));
        }
        assert_eq!(limit("limt=3"), Err("there is no parameter `limt`: the parameters are limit".to_owned()));
        assert_eq!(limit("limit=3&limit=4"), Err("`limit` occurs twice: send it once".to_owned()));
        let open = Query::of("after=x").count("after", 0..=MOST).unwrap_err();
        assert_eq!(open.detail(), "`after` is \"x\": send a whole number from 0");
    }

    #[test]
    fn only_what_may_be_there_more_than_once_is() {
        let query = Query::of("fault=a&limit=1&fault=b");
        assert!(query.only_with_many(&["limit"], &["fault"]).is_ok() && query.only(&["limit", "fault"]).is_err());
        assert_eq!(query.every("fault"), ["a", "b"]);
        assert!(query.every("other").is_empty());
    }
}
