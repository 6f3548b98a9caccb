//! Topics and filters (section 4.7): which of them are valid, and which topics a filter matches. Who may use them is
//! not decided here.

use super::limits::{LEVELS, TOPIC};

/// The character that follows the slash in the order of bytes.
const AFTER_SLASH: char = '0';

/// Why the broker refuses a topic or a filter. The standard may allow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// Longer than `limits::TOPIC` bytes; the standard allows 65,535.
    #[error("the topic or filter is longer than {TOPIC} bytes")]
    Long,
    /// More than `limits::LEVELS` levels. Every search goes through the levels one by one.
    #[error("the topic or filter has more than {LEVELS} levels")]
    Deep,
    /// It begins with `$`. Such topics belong to the server (section 4.7.2), and this server has none.
    #[error("the topic or filter begins with `$`, but no topic here does")]
    Dollar,
    /// `#` or `+` in a place where section 4.7.1 forbids it.
    #[error("the topic or filter has `#` or `+` in a wrong place")]
    Wildcards,
    /// `$share/…` without a name, or without a filter after the name (MQTT 5, section 4.8.2).
    #[error("a shared subscription must be `$share/NAME/FILTER`, and NAME must not contain `+` or `#`")]
    Share,
}

/// A shared filter: `$share/NAME/FILTER` (MQTT 5, section 4.8.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shared<'a> {
    pub(crate) group: &'a str,
    pub(crate) filter: &'a str,
}

/// Splits a shared filter without checking it; `None`: the filter is not shared.
pub(crate) fn shared(filter: &str) -> Option<Shared<'_>> {
    let (group, filter) = filter.strip_prefix("$share/")?.split_once('/')?;
    Some(Shared { group, filter })
}

/// Checks a shared filter and returns its parts; `None`: the filter is not shared.
pub(crate) fn share(text: &str) -> Result<Option<Shared<'_>>, Unfit> {
    if text != "$share" && !text.starts_with("$share/") {
        return Ok(None);
    }
    let shared = shared(text).ok_or(Unfit::Share)?;
    if shared.group.is_empty() || shared.group.contains(['+', '#']) || shared.filter.is_empty() {
        return Err(Unfit::Share);
    }
    measure(shared.group)?;
    filter(shared.filter).map(|()| Some(shared))
}

/// Whether some topic could match both filters. A leading `$` is treated like any other character, so `+` overlaps
/// it.
#[must_use]
pub fn overlap(one: &str, other: &str) -> bool {
    let (mut one, mut other) = (one.split('/'), other.split('/'));
    loop {
        match (one.next(), other.next()) {
            // `a/#` matches `a` as well.
            (Some("#"), _) | (_, Some("#")) | (None, None) => return true,
            (Some(a), Some(b)) if a == b || a == "+" || b == "+" => {}
            _ => return false,
        }
    }
}

/// Checks the length, the levels and the first character of a topic. The topic must not be empty or have wildcards:
/// this is not checked here.
///
/// # Errors
/// `Unfit::Long`, `Unfit::Deep` or `Unfit::Dollar`.
pub fn topic(topic: &str) -> Result<(), Unfit> {
    measure(topic)?;
    if topic.starts_with('$') { Err(Unfit::Dollar) } else { Ok(()) }
}

/// Checks a filter, which must not be empty. A shared filter is refused because it begins with `$`.
///
/// # Errors
/// `Unfit::Long`, `Unfit::Deep`, `Unfit::Dollar` or `Unfit::Wildcards`.
pub fn filter(filter: &str) -> Result<(), Unfit> {
    measure(filter)?;
    if filter.starts_with('$') {
        return Err(Unfit::Dollar);
    }
    let before_last = filter.rfind('/').map_or("", |slash| &filter[..slash]);
    let is_whole = |level: &str| level == "+" || level == "#" || !level.contains(['+', '#']);
    if before_last.contains('#') || !filter.split('/').all(is_whole) { Err(Unfit::Wildcards) } else { Ok(()) }
}

/// Whether a filter matches a topic. `#` and `+` in the first level match no topic that begins with `$` (section
/// 4.7.2).
#[cfg(test)]
pub(crate) fn matches(filter: &str, topic: &str) -> bool {
    if topic.starts_with('$') && filter.starts_with(['+', '#']) {
        return false;
    }
    let mut levels = topic.split('/');
    for wanted in filter.split('/') {
        if wanted == "#" {
            return true;
        }
        if !levels.next().is_some_and(|level| wanted == "+" || wanted == level) {
            return false;
        }
    }
    levels.next().is_none()
}

/// The levels before the filter's first wildcard. Every topic that the filter matches begins with them.
pub(crate) fn stem(filter: &str) -> &str {
    match filter.find(['+', '#']) {
        Some(wildcard) => filter[..wildcard].strip_suffix('/').unwrap_or(""),
        None => filter,
    }
}

/// Where to look next when topics are searched in the order of their bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// This topic matches.
    Here,
    /// The next topic that matches is this one or a later one.
    From(String),
    /// No later topic matches.
    Nowhere,
}

/// Returns whether a filter matches this topic, or else where the next matching topic can be. A search goes level by
/// level, as in a tree, and skips the topics between.
pub(crate) fn look(filter: &str, topic: &str) -> Next {
    if topic.starts_with('$') && filter.starts_with(['+', '#']) {
        // The first place after all topics that begin with `$`.
        return Next::From("%".to_owned());
    }
    let mut wanted_levels = filter.split('/').peekable();
    let (mut start, mut rest) = (0, Some(topic));
    while let Some(wanted) = wanted_levels.next() {
        if wanted == "#" {
            return Next::Here;
        }
        let Some(here) = rest else { return Next::From(format!("{topic}\0")) };
        let (level, after) = here.split_once('/').map_or((here, None), |(level, after)| (level, Some(after)));
        if wanted != "+" && wanted != level {
            let above = &topic[..start];
            let itself = format!("{above}{wanted}");
            if topic < itself.as_str() {
                return Next::From(itself);
            }
            let below = format!("{itself}/");
            let may_be_below = wanted_levels.peek().is_some() && topic < below.as_str();
            return if may_be_below { Next::From(below) } else { behind(above) };
        }
        start += level.len() + 1;
        rest = after;
    }
    if rest.is_none() { Next::Here } else { behind(&topic[..start]) }
}

/// The first place after all topics below these levels. `levels` ends with a slash.
fn behind(levels: &str) -> Next {
    levels.strip_suffix('/').map_or(Next::Nowhere, |above| Next::From(format!("{above}{AFTER_SLASH}")))
}

fn measure(text: &str) -> Result<(), Unfit> {
    if text.len() > TOPIC {
        return Err(Unfit::Long);
    }
    if text.bytes().filter(|byte| *byte == b'/').count() >= LEVELS { Err(Unfit::Deep) } else { Ok(()) }
}

#[cfg(test)]
pub(crate) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A level of a topic; some of them sort before the slash and some after it.
    pub(crate) fn level() -> impl Strategy<Value = &'static str> {
        prop::sample::select(vec!["", "a", "b", "ab", "a!", "a0", "$a", "é"])
    }

    pub(crate) fn some_filter() -> impl Strategy<Value = String> {
        let levels = prop::collection::vec(prop_oneof![3 => level(), 2 => Just("+")], 0..5);
        (levels, any::<bool>()).prop_filter_map("a filter has a level", |(mut levels, is_open)| {
            levels.extend(is_open.then_some("#"));
            (!levels.is_empty()).then(|| levels.join("/"))
        })
    }

    #[test]
    fn filters_match_as_the_standard_has_it() {
        let cases = [
            ("a/b", "a/b", true),
            ("a/b", "a/b/", false),
            ("a/+", "a/b", true),
            ("a/+", "a/", true),
            ("a/+", "a", false),
            ("+", "/a", false),
            ("+/+", "/a", true),
            ("/+", "/a", true),
            ("a/#", "a", true),
            ("a/#", "a/b/c", true),
            ("a/#", "ab", false),
            ("#", "a", true),
            ("#", "$SYS/a", false),
            ("+/a", "$SYS/a", false),
            ("$SYS/#", "$SYS/a", true),
            ("a/+/c", "a/b/c", true),
            ("a/+/c", "a/b/d", false),
            ("A", "a", false),
        ];
        for (filter, topic, expected) in cases {
            assert_eq!(matches(filter, topic), expected, "{filter} {topic}");
            assert!(!expected || topic.starts_with(stem(filter)), "{filter} {topic}");
        }
    }

    #[test]
    fn a_filter_has_wildcards_only_where_they_can_be() {
        for good in ["a", "/", "+", "#", "a/#", "+/a/+", "a//b", "é/+", "a/+/#"] {
            assert_eq!(filter(good), Ok(()), "{good}");
        }
        for bad in ["a#", "a/#/b", "a+", "+a/b", "a/b+/c", "##", "#/a", "a/++"] {
            assert_eq!(filter(bad), Err(Unfit::Wildcards), "{bad}");
        }
        assert_eq!(filter("$SYS/#"), Err(Unfit::Dollar));
        assert_eq!(filter("$share/group/a"), Err(Unfit::Dollar));
        assert_eq!(filter(&"a".repeat(513)), Err(Unfit::Long));
        assert_eq!(filter(&"/".repeat(32)), Err(Unfit::Deep));
        assert_eq!(filter(&"/".repeat(31)), Ok(()));
    }

    #[test]
    fn a_topic_may_be_anything_that_is_not_too_long_and_does_not_begin_with_a_dollar() {
        assert_eq!(topic("é"), Ok(()));
        assert_eq!(topic("$SYS"), Err(Unfit::Dollar));
        assert_eq!(topic(&"é".repeat(257)), Err(Unfit::Long));
        assert_eq!(topic(" "), Ok(()));
    }
}
