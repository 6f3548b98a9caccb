//! Stored missions under `/api/v1/missions`, the present mission included: the list, one mission, its map, and its
//! events. `console::missions` has the pages for people.

use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::Response;

use super::HttpDoor;
use super::accept::preferred;
use super::etag::by_content;
use super::problem::Problem;
use super::query::{MOST, Query};
use super::reading::Number;
use crate::api::address::address;
use crate::api::map::{MapJson, Plan};
use crate::api::map_text;
use crate::api::mission_record::{
    Links, MissionListJson, MissionRecordJson, MissionWholeJson, MomentJson, events as events_json,
};
use crate::api::receipt::ReceiptListJson;
use crate::api::retrieval_record::RetrievalRecordJson;
use crate::api::time::rfc3339;
use crate::report::receipt::Receipt;
use crate::runtime::archive::{Archive, At, Happened, MissionRecord, PastMoment, Sound, Span, Unreadable};
use hallsweep_core::hall::HallId;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq};

/// Default number of missions in one answer.
pub(super) const MISSIONS: u64 = 20;

pub(super) const MOST_MISSIONS: u64 = 100;

/// Default and maximum number of events in one answer. This makes some 100 KiB of JSON.
pub(super) const EVENTS: u64 = 1000;

/// Default and maximum number of receipts in one answer.
pub(super) const RECEIPTS: u64 = 100;

/// Maximum number of entries read for a retrieval. A real retrieval has far fewer.
const RETRIEVAL: usize = 1000;

/// Maximum number of reads for one page of commands. It limits the cost of a request. The page shows what was found
/// until then.
const LOOKS: usize = 10;

const JSON: &str = "application/json";

/// `GET missions`: the missions, newest first.
pub(super) async fn list(door: HttpDoor, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    query.only(&["before", "limit"])?;
    let limit = query.count("limit", 1..=MOST_MISSIONS)?.unwrap_or(MISSIONS);
    let (records, next) = newest(&door, before(&query)?, limit).await?;
    let next = next.map(|before| address(door.hall.id(), &format!("/api/v1/missions?before={before}&limit={limit}")));
    let missions = records.iter().map(|record| summary(record, door.hall.id())).collect();
    Ok(by_content(&headers, JSON, json(&MissionListJson { missions, next })))
}

/// `GET missions/{id}`: one mission, with its luggage and its map.
pub(super) async fn mission(door: HttpDoor, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    let RecordedMission { record, state, damage } = recorded(&door, id).await?;
    Ok(by_content(
        &headers,
        JSON,
        json(&MissionWholeJson::new(summary(&record, door.hall.id()), state.as_ref(), damage, door.hall.id())),
    ))
}

/// `GET missions/{id}/moment`: the state after the last entry up to `at`. Without `at`, the state after the last
/// entry of the mission.
pub(super) async fn moment(door: HttpDoor, Number(id): Number, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    query.only(&["at"])?;
    let at = At::Entry(at(&query)?.unwrap_or(Seq(MOST)));
    let [PastMoment { past: Sound { of: past, damage }, wall, .. }] = stood(&door, id, [at]).await?;
    Ok(by_content(&headers, JSON, json(&MomentJson::new(MissionId(id), &past, wall, damage, door.hall.id()))))
}

pub(super) fn at(query: &Query) -> Result<Option<Seq>, Problem> {
    Ok(query.count("at", 1..=MOST)?.map(Seq))
}

pub(super) async fn stood<const N: usize>(door: &HttpDoor, id: u64, at: [At; N]) -> Result<[PastMoment; N], Problem> {
    let mission = MissionId(id);
    let found = door.hall.archive.look_up(move |archive| match archive.mission(mission)? {
        Some(_) => archive.moments(mission, &at).map(Some),
        None => Ok(None),
    });
    let moments = found.await?.ok_or_else(|| unknown(id))?;
    let unkept = |_| format!("mission {id} has no stored entry at or before that time");
    moments.try_into().map_err(|moments| Problem::not_found(unkept(moments)))
}

/// `GET missions/{id}/timeline`: the events that the timeline shows, oldest first.
pub(super) async fn timeline(door: HttpDoor, Number(id): Number, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    listed(&door, id, &query, &headers, "timeline", |archive, mission, after, most| {
        archive.timeline(mission, Span::after(after), most)
    })
    .await
}

/// `GET missions/{id}/events`: the events of a mission, oldest first.
pub(super) async fn events(door: HttpDoor, Number(id): Number, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    listed(&door, id, &query, &headers, "events", entries).await
}

/// Reads things of a mission after an entry, each with its entry.
pub(super) type Which<T> = fn(&dyn Archive, MissionId, Seq, usize) -> Result<Vec<(Seq, T)>, Unreadable>;

fn entries(archive: &dyn Archive, mission: MissionId, after: Seq, most: usize) -> Result<Vec<Happened>, Unreadable> {
    archive.entries(mission, Span::after(after), most)
}

async fn listed(
    door: &HttpDoor,
    id: u64,
    query: &Query,
    headers: &HeaderMap,
    name: &str,
    which: Which<Result<Entry, Unreadable>>,
) -> Result<Response, Problem> {
    query.only(&["after", "limit"])?;
    let limit = query.count("limit", 1..=EVENTS)?.unwrap_or(EVENTS);
    let (entries, next) = of_these(door, id, after(query)?, limit, which).await?;
    let next =
        next.map(|after| format!("{}/{name}?after={after}&limit={limit}", Links::of(MissionId(id), door.hall.id()).itself));
    let entries = entries.into_iter().map(|(seq, entry)| (seq, entry.map_err(|unreadable| unreadable.0))).collect();
    Ok(by_content(headers, JSON, events_json(MissionId(id), entries, next)))
}

/// `GET missions/{id}/map`: the map of a mission, as JSON or in the text format of the old clients.
pub(super) async fn map(door: HttpDoor, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    const FORMATS: [&str; 2] = [JSON, "text/plain; charset=utf-8"];
    let Some(format) = preferred(&headers, &[JSON, "text/plain"]) else {
        return Err(Problem::not_acceptable("the map is available as application/json and as text/plain".to_owned()));
    };
    let state = recorded(&door, id).await?.state;
    let state = state.ok_or_else(|| Problem::not_found(format!("the map of mission {id} is not stored")))?;
    let mut response = match format == JSON {
        true => by_content(&headers, FORMATS[0], json(&MapJson::from(Plan::from(&state)))),
        false => by_content(&headers, FORMATS[1], map_text::lines(&state)),
    };
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

/// `GET missions/{id}/retrieval`: the events of the last retrieval, and each tick of its behaviour trees.
pub(super) async fn retrieval(door: HttpDoor, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    Ok(by_content(&headers, JSON, json(&retrieved(&door, id).await?)))
}

/// Returns the last retrieval of a mission from its record. It is assembled on the thread that reads the archive.
/// Only a few such jobs run at once.
pub(super) async fn retrieved(door: &HttpDoor, id: u64) -> Result<RetrievalRecordJson, Problem> {
    let mission = MissionId(id);
    let found = door.hall.archive.look_up(move |archive| match archive.mission(mission)? {
        Some(_) => archive.retrieval(mission, RETRIEVAL + 1).map(|entries| Some(retrieval_of(entries))),
        None => Ok(None),
    });
    let record = found.await?.ok_or_else(|| unknown(id))?;
    record.ok_or_else(|| Problem::not_found(format!("mission {id} had no luggage to fetch")))
}

fn retrieval_of(mut entries: Vec<Happened>) -> Option<RetrievalRecordJson> {
    let complete = entries.len() <= RETRIEVAL && entries.iter().all(|(_, entry)| entry.is_ok());
    entries.truncate(RETRIEVAL);
    let entries: Vec<Entry> = entries.into_iter().filter_map(|(_, entry)| entry.ok()).collect();
    RetrievalRecordJson::new(&entries, complete)
}

/// `GET missions/{id}/receipts`: the receipts for hand-overs of a mission, oldest first.
pub(super) async fn receipts(door: HttpDoor, Number(id): Number, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    query.only(&["after", "limit"])?;
    let limit = query.count("limit", 1..=RECEIPTS)?.unwrap_or(RECEIPTS);
    let (found, next) = of_these(&door, id, after(&query)?, limit, Receipt::all).await?;
    let next =
        next.map(|after| format!("{}/receipts?after={after}&limit={limit}", Links::of(MissionId(id), door.hall.id()).itself));
    let (mut receipts, mut damage) = (Vec::new(), Vec::new());
    for (seq, receipt) in found {
        match receipt {
            Ok(receipt) => receipts.push((seq, receipt).into()),
            Err(Unreadable(words)) => damage.push(words),
        }
    }
    Ok(by_content(&headers, JSON, json(&ReceiptListJson { mission: id, receipts, damage, next })))
}

pub(super) fn before(query: &Query) -> Result<Option<MissionId>, Problem> {
    Ok(query.count("before", 1..=MOST)?.map(MissionId))
}

pub(super) fn after(query: &Query) -> Result<Seq, Problem> {
    Ok(Seq(query.count("after", 0..=MOST)?.unwrap_or(0)))
}

/// Returns the newest missions with smaller numbers than `before`. Also returns the value of `before` for the next
/// page.
pub(super) async fn newest(
    door: &HttpDoor,
    before: Option<MissionId>,
    limit: u64,
) -> Result<(Vec<MissionRecord>, Option<MissionId>), Problem> {
    let limit = count(limit);
    let mut records = door.hall.archive.look_up(move |archive| archive.missions(before, limit + 1)).await?;
    let more = records.len() > limit;
    records.truncate(limit);
    let next = records.last().map(|record| record.id).filter(|_| more);
    Ok((records, next))
}

pub(super) struct RecordedMission {
    pub(super) record: MissionRecord,
    /// The state of the mission when it was archived. For the present mission, the present state.
    pub(super) state: Option<PersistentState>,
    pub(super) damage: Vec<String>,
}

pub(super) async fn recorded(door: &HttpDoor, id: u64) -> Result<RecordedMission, Problem> {
    let mission = MissionId(id);
    let found = door.hall.archive.look_up(move |archive| Ok((archive.mission(mission)?, archive.state(mission)?))).await?;
    let (record, sound) = found;
    let (state, damage) = sound.map_or((None, Vec::new()), |Sound { of, damage }| (Some(of), damage));
    Ok(RecordedMission { record: record.ok_or_else(|| unknown(id))?, state, damage })
}

/// Returns the events of a mission after the entry `after`, oldest first. Also returns the value of `after` for the
/// next page.
pub(super) async fn happened(door: &HttpDoor, id: u64, after: Seq, limit: u64) -> Result<(Vec<Happened>, Option<Seq>), Problem> {
    of_these(door, id, after, limit, entries).await
}

/// Returns at most `limit` things of a mission, and the value of `after` for the next page.
pub(super) async fn of_these<T: Send + 'static>(
    door: &HttpDoor,
    id: u64,
    after: Seq,
    limit: u64,
    which: Which<T>,
) -> Result<(Vec<(Seq, T)>, Option<Seq>), Problem> {
    let (mission, limit) = (MissionId(id), count(limit));
    let found = door.hall.archive.look_up(move |archive| match archive.mission(mission)? {
        Some(_) => which(archive, mission, after, limit + 1).map(Some),
        None => Ok(None),
    });
    let mut entries = found.await?.ok_or_else(|| unknown(id))?;
    let more = entries.len() > limit;
    entries.truncate(limit);
    let next = entries.last().map(|(seq, _)| *seq).filter(|_| more);
    Ok((entries, next))
}

/// Reads pages of entries. Stops when at least `least` wanted or unreadable entries are found, or when `LOOKS` pages
/// are read. Returns these entries, and the entry after which the next search begins.
pub(super) async fn wanted(
    door: &HttpDoor,
    id: u64,
    after: Seq,
    least: u64,
    is_wanted: fn(&Fact) -> bool,
) -> Result<(Vec<Happened>, Option<Seq>), Problem> {
    let (mut found, mut from) = (Vec::new(), Some(after));
    for _ in 0..LOOKS {
        let Some(after) = from.filter(|_| found.len() < count(least)) else { break };
        let (entries, next) = happened(door, id, after, EVENTS).await?;
        found.extend(entries.into_iter().filter(|(_, entry)| entry.as_ref().map_or(true, |entry| is_wanted(&entry.fact))));
        from = next;
    }
    Ok((found, from))
}

pub(super) fn unknown(id: u64) -> Problem {
    Problem::not_found(format!("there is no mission {id}: /api/v1/missions lists the missions"))
}

fn count(limit: u64) -> usize {
    usize::try_from(limit).expect("a limit is at most a thousand")
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("a record is strings and numbers, which JSON can hold")
}

/// The summary of a mission of this hall.
pub(super) fn summary(record: &MissionRecord, hall: Option<&HallId>) -> MissionRecordJson {
    MissionRecordJson {
        id: record.id.0,
        strategy: record.strategy.to_string(),
        began: rfc3339(record.began),
        archived: record.archived.map(rfc3339),
        phase: record.phase.to_string(),
        pieces: record.luggage,
        dangerous: record.dangerous,
        left: record.left.iter().map(|luggage| luggage.0).collect(),
        exercise: record.is_exercise,
        links: Links::of(record.id, hall),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{TestApp, app, read, text};
    use crate::api::tests::fixture::searching;

    async fn json(app: &TestApp, path: &str) -> serde_json::Value {
        let (status, json) = read(app.get(path).await).await;
        assert_eq!(status, 200, "{path}: {json}");
        json
    }

    async fn check(app: &TestApp, path: &str, status: u16, words: &str) {
        let (got, problem) = read(app.get(&format!("/api/v1{path}")).await).await;
        assert_eq!(got.as_u16(), status, "{path}: {problem}");
        assert!(problem["detail"].as_str().unwrap().contains(words), "{path}: {problem}");
    }

    fn ids(list: &serde_json::Value) -> Vec<u64> {
        list["missions"].as_array().unwrap().iter().filter_map(|mission| mission["id"].as_u64()).collect()
    }

    #[tokio::test]
    async fn missions_are_listed_newest_first_page_by_page() {
        let app = app(searching());
        let whole = json(&app, "/api/v1/missions").await;
        assert_eq!((ids(&whole), &whole["next"]), (vec![2, 1], &serde_json::Value::Null));
        let first = json(&app, "/api/v1/missions?limit=1").await;
        assert_eq!(ids(&first), [2]);
        let second = json(&app, first["next"].as_str().unwrap()).await;
        assert_eq!((ids(&second), &second["next"]), (vec![1], &serde_json::Value::Null));
        assert_eq!(second["missions"][0]["left"], serde_json::json!([2]));
        assert_eq!((&whole["missions"][0]["archived"], &whole["missions"][0]["pieces"]), (&serde_json::Value::Null, &0.into()));
    }

    #[tokio::test]
    async fn a_mission_that_is_over_keeps_its_luggage_and_its_map() {
        let app = app(searching());
        let mission = json(&app, "/api/v1/missions/1").await;
        assert_eq!((&mission["phase"], &mission["dangerous"]), (&"bombLocated".into(), &1.into()));
        assert_eq!(mission["luggage"][1]["decided"]["by"], "operator");
        assert_eq!(mission["map"]["rows"][0], "r11X1X");
        let link = |name: &str| mission["links"][name].as_str().unwrap().to_owned();
        assert_eq!(json(&app, &link("map")).await, mission["map"]);
        assert_eq!(json(&app, &link("self")).await, mission);
        let plain = app.send("GET", &link("map"), &[("accept", "text/plain")], "").await;
        assert!(plain.headers()["content-type"].to_str().unwrap().starts_with("text/plain"));
        assert!(text(plain).await.starts_with("|r, 1, 1, X, 1, X, \n"));
        assert_eq!(app.send("GET", &link("map"), &[("accept", "image/png")], "").await.status(), 406);
    }

    #[tokio::test]
    async fn a_mission_is_told_as_it_stood_after_any_of_its_entries() {
        let app = app(searching());
        let moment = json(&app, "/api/v1/missions/1/moment?at=4").await;
        assert_eq!(
            (&moment["seq"], &moment["phase"], &moment["holds"]),
            (&4.into(), &"idle".into(), &serde_json::json!(["operator"]))
        );
        assert_eq!((&moment["celsius"], &moment["luggage"]), (&23.5.into(), &serde_json::json!([])));
        assert_eq!(moment["robot"], serde_json::json!({"position": {"x": 0, "y": 0}, "heading": "south"}));
        let after = json(&app, moment["links"]["events"].as_str().unwrap()).await;
        assert_eq!(after["events"][0]["seq"], 5, "what happened from then on");
        assert_eq!(json(&app, "/api/v1/missions/1/moment?at=3").await["holds"], serde_json::json!([]));
        assert_eq!(json(&app, "/api/v1/missions/1/moment").await["seq"], 5, "the last that can be understood");
        for (path, status, words) in [
            ("/missions/2/moment?at=3", 404, "has no stored entry"),
            ("/missions/9/moment", 404, "there is no mission 9"),
            ("/missions/1/moment?at=x", 422, "`at` is \"x\""),
            ("/missions/1/moment?on=1", 422, "there is no parameter `on`"),
        ] {
            check(&app, path, status, words).await;
        }
    }

    #[tokio::test]
    async fn events_come_oldest_first_and_each_once() {
        let app = app(searching());
        let mut seen = Vec::new();
        let mut next = Some("/api/v1/missions/1/events?limit=2".to_owned());
        while let Some(path) = next {
            let page = json(&app, &path).await;
            let events = page["events"].as_array().unwrap();
            assert!(!events.is_empty() && events.len() <= 2);
            seen.extend(events.iter().filter_map(|event| event["seq"].as_u64()));
            next = page["next"].as_str().map(str::to_owned);
        }
        assert_eq!(seen, [1, 2, 3, 4, 5, 6]);
        let all = json(&app, "/api/v1/missions/1/events").await;
        assert_eq!((&all["events"][1]["who"], &all["events"][1]["from"]), (&"anna".into(), &"192.0.2.7".into()));
        assert_eq!(all["events"][2]["refused"]["code"], "moving");
    }

    #[tokio::test]
    async fn what_is_damaged_is_said_beside_what_is_sound() {
        let app = app(searching());
        let mission = json(&app, "/api/v1/missions/1").await;
        assert_eq!(mission["damage"], serde_json::json!(["entry 6 of the journal cannot be understood (a mouse was at it)"]));
        assert!(mission["map"].is_object() && mission["luggage"][1]["id"].is_u64());
        let all = json(&app, "/api/v1/missions/1/events").await;
        assert_eq!((&all["events"][4]["kind"], &all["events"][5]["kind"]), (&"pose".into(), &"unreadable".into()));
        assert!(all["events"][5]["why"].as_str().unwrap().contains("a mouse"), "{all}");
        assert_eq!(json(&app, "/api/v1/missions/2").await["damage"], serde_json::json!([]));
    }

    #[tokio::test]
    async fn what_a_client_already_has_is_not_sent_again() {
        let app = app(searching());
        for path in ["/missions", "/missions/1", "/missions/1/map", "/missions/1/events"].map(|path| format!("/api/v1{path}")) {
            let tag = app.get(&path).await.headers()["etag"].clone();
            let again = app.send("GET", &path, &[("if-none-match", tag.to_str().unwrap())], "").await;
            assert_eq!((again.status().as_u16(), &again.headers()["etag"]), (304, &tag), "{path}");
            assert_eq!(app.send("GET", &path, &[("if-none-match", "W/\"other\"")], "").await.status(), 200, "{path}");
        }
    }

    #[tokio::test]
    async fn what_is_unknown_wrong_or_unreadable_is_a_problem_in_words() {
        let app = app(searching());
        for (path, status, words) in [
            ("/missions/9", 404, "there is no mission 9"),
            ("/missions/9/events", 404, "there is no mission 9"),
            ("/missions/9/map", 404, "there is no mission 9"),
            ("/missions/9/receipts", 404, "there is no mission 9"),
            ("/missions/1/receipts?limit=101", 422, "from 1 to 100"),
            ("/missions/x", 404, "the path needs a number"),
            ("/missions/99", 503, "the disk is on strike"),
            ("/missions?before=0", 422, "`before` is \"0\": send a whole number from 1"),
            ("/missions?limit=101", 422, "`limit` is \"101\": send a whole number from 1 to 100"),
            ("/missions?bfore=1", 422, "there is no parameter `bfore`"),
            ("/missions/1/events?limit=1001", 422, "from 1 to 1000"),
            ("/missions/1/events?after=-1", 422, "`after` is \"-1\""),
        ] {
            check(&app, path, status, words).await;
        }
    }
}
