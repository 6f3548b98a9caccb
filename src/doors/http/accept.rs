//! Chooses the format of a response by the header `Accept` (RFC 9110, section 12.5.1). Also reads the header
//! `Accept-Encoding`.

use axum::http::{HeaderMap, header};

/// Returns the offer that the client prefers, or `None` when the client accepts no offer. Of two offers with equal
/// quality, the one that `Accept` names more exactly wins. If both are equally exact, the first one wins. Without the
/// header, the first offer is returned.
pub(super) fn preferred<'a>(headers: &HeaderMap, offers: &[&'a str]) -> Option<&'a str> {
    let values = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    let ranges: Vec<(&str, f32)> = values.flat_map(|value| value.split(',')).filter_map(range).collect();
    if ranges.is_empty() {
        return offers.first().copied();
    }
    let mut best: Option<(&str, (f32, u8))> = None;
    for offer in offers {
        let rank = rank(offer, &ranges);
        if rank.0 > 0.0 && best.is_none_or(|(_, so_far)| rank > so_far) {
            best = Some((offer, rank));
        }
    }
    best.map(|(offer, _)| offer)
}

pub(super) fn codings(headers: &HeaderMap) -> impl Iterator<Item = (&str, f32)> {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).filter_map(range)
}

/// Parses `text/plain;q=0.5` into (`text/plain`, 0.5). Language ranges are parsed in the same way. Other parameters
/// are ignored. An invalid quality counts as 0.
pub(super) fn range(text: &str) -> Option<(&str, f32)> {
    let mut parts = text.split(';').map(str::trim);
    let media = parts.next().filter(|media| !media.is_empty())?;
    let quality = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
    Some((media, quality.map_or(1.0, |q| q.parse::<f32>().unwrap_or(0.0).clamp(0.0, 1.0))))
}

/// Returns the quality that the header gives to an offer, and how exactly the matching range names the offer. If
/// several ranges match, the most exact range counts.
fn rank(offer: &str, ranges: &[(&str, f32)]) -> (f32, u8) {
    let family = offer.split('/').next().unwrap_or_default();
    let exactness = |media: &str| match media.strip_suffix("/*") {
        Some("*") => Some(1),
        Some(named) => named.eq_ignore_ascii_case(family).then_some(2),
        None => media.eq_ignore_ascii_case(offer).then_some(3),
    };
    let fitting = ranges.iter().filter_map(|(media, quality)| exactness(media).map(|exact| (*quality, exact)));
    fitting.max_by_key(|(_, exact)| *exact).unwrap_or((0.0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OFFERS: [&str; 2] = ["application/json", "text/plain"];

    fn check(accept: &str, expect: Option<&str>) {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, accept.parse().unwrap());
        assert_eq!(preferred(&headers, &OFFERS), expect, "Accept: {accept}");
    }

    #[test]
    fn without_a_wish_the_first_offer_is_taken() {
        assert_eq!(preferred(&HeaderMap::new(), &OFFERS), Some("application/json"));
        check("", Some("application/json"));
        check("*/*", Some("application/json"));
    }

    #[test]
    fn the_wish_decides() {
        check("text/plain", Some("text/plain"));
        check("TEXT/PLAIN; charset=utf-8", Some("text/plain"));
        check("text/*", Some("text/plain"));
        check("text/plain, */*", Some("text/plain"));
        check("text/html,application/xhtml+xml,*/*;q=0.8", Some("application/json"));
    }

    #[test]
    fn quality_is_weighed_and_zero_means_never() {
        check("text/plain;q=0.4, application/json;q=0.5", Some("application/json"));
        check("text/plain;q=0.6, application/json;q=0.5", Some("text/plain"));
        check("application/json;q=0, */*", Some("text/plain"));
        check("text/plain;q=nonsense", None);
    }

    #[test]
    fn what_is_not_there_is_not_served() {
        check("application/xml", None);
        check("image/*", None);
    }
}
