//! The parts of the page, with their contents and words. Each part is made in memory before it is written. The
//! largest parts are the drawing of the hall, and pieces with their photos.

use std::cell::RefCell;
use std::io::Write;

use askama::Template;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::chart::Chart;
use super::scaled::scaled;
use super::{Failure, Report, chart, each, hall};
use crate::api::time::{Zone, rfc3339};
use crate::phrases::{Language, Phrase};
use crate::runtime::archive::{NoTake, Unreadable, hex};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::searched::SearchedHall;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::state::{PersistentState, Reach};
use hallsweep_core::units::{Seq, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};

/// Maximum size of all photos of a report together, in bytes. If they are larger, the large photos are scaled down.
const PHOTOS: usize = 5 << 20;

/// Maximum number of photos of one piece in a report. If there are more, the latest photos are shown. Without this
/// limit, a damaged record with a count of billions would cause billions of queries.
pub(super) const TAKES: u32 = 1000;

pub(super) fn write(report: &Report<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let state = report.moment.as_ref().map(|moment| &moment.past.of.state);
    let top = Top { report, language: report.claim.language, state, zone: report.zone() };
    let is_exercise = state.and_then(|state| state.conditions.as_ref()).is_some_and(|conditions| conditions.venue.is_exercise);
    match state.filter(|_| is_exercise) {
        Some(state) => exercise(out, top, state)?,
        None if report.claim.edition > 2 => part(out, &Document { top })?,
        None => part(out, &top)?,
    }
    if let Some(state) = state.filter(|_| report.claim.edition > 4) {
        part(out, &Coverage { language: report.claim.language, state, zone: report.zone() })?;
    }
    pieces(report, state, out)?;
    let threshold = state.and_then(|state| state.conditions.as_ref()).map(|conditions| conditions.threshold);
    let chart = Chart::of(report, threshold)?;
    part(out, &Temperature { report, language: report.claim.language, chart })?;
    tables(report, out)?;
    if report.claim.edition > 2 {
        part(out, &Signatures { language: report.claim.language })?;
    }
    let file_name = Report::file_name(report.claim.mission);
    part(out, &Evidence { report, language: report.claim.language, file_name })
}

/// Writes the top of the report of an exercise, and its results. The template of an edition never changes, so the title
/// is changed where it is written.
fn exercise(out: &mut dyn Write, top: Top<'_>, state: &PersistentState) -> Result<(), Failure> {
    let language = top.language;
    let title = language.say("report-title").with("id", top.report.claim.mission).to_string();
    let top = rendered(&Document { top }).replace(&title, &format!("{} · {title}", language.say("exercise")));
    writeln!(out, "{top}")?;
    part(out, &Exercise { language, state })
}

fn rendered(part: &impl Template) -> String {
    part.render().expect("the templates accept every record, and writing to a string does not fail")
}

fn part(out: &mut dyn Write, part: &impl Template) -> Result<(), Failure> {
    let text = rendered(part);
    out.write_all(text.as_bytes())?;
    out.write_all(b"\n")?;
    Ok(())
}

impl Report<'_> {
    fn zone(&self) -> Zone {
        Zone::of(self.tally.first.map_or_else(WallTime::default, |(_, wall)| wall))
    }

    fn time(&self, wall: WallTime) -> String {
        self.claim.language.date(&self.zone().date_and_time(wall))
    }

    fn time_of(&self, entry: Option<(Seq, WallTime)>) -> String {
        entry.map_or_else(String::new, |(_, wall)| self.time(wall))
    }
}

fn reach(state: &PersistentState) -> Option<Reach> {
    state.conditions.as_ref()?.venue.reach
}

#[derive(Template)]
#[template(path = "report/top.html")]
struct Top<'r> {
    report: &'r Report<'r>,
    language: Language,
    state: Option<&'r PersistentState>,
    zone: Zone,
}

/// The top of the page since edition 3.
#[derive(Template)]
#[template(path = "report/document.html")]
struct Document<'r> {
    top: Top<'r>,
}

/// The results of an exercise.
#[derive(Template)]
#[template(path = "report/exercise.html")]
struct Exercise<'r> {
    language: Language,
    state: &'r PersistentState,
}

/// How far the hall was searched, since edition 5.
#[derive(Template)]
#[template(path = "report/coverage.html")]
struct Coverage<'r> {
    language: Language,
    state: &'r PersistentState,
    zone: Zone,
}

/// Lines for the signatures of the operator and the receiver.
#[derive(Template)]
#[template(path = "report/signatures.html")]
struct Signatures {
    language: Language,
}

impl Top<'_> {
    /// Returns the rows of the letterhead.
    fn reference(&self) -> [(Phrase<'static>, String); 4] {
        let (say, report) = (|id| self.language.say(id), self.report);
        let venue = self.state.and_then(|state| state.conditions.as_ref()).map(|conditions| conditions.venue.name.to_string());
        let until = say("report-until").with("mission", report.claim.mission).with("entry", report.claim.until);
        [
            (say("hall"), venue.unwrap_or_else(|| "–".to_owned())),
            (say("report-reference"), until.to_string()),
            (say("report-began"), report.time_of(report.tally.first)),
            self.end(),
        ]
    }

    fn end(&self) -> (Phrase<'static>, String) {
        let tally = &self.report.tally;
        let end = if tally.archived.is_some() { "report-put-away" } else { "report-as-of" };
        (self.language.say(end), self.report.time_of(tally.archived.or(tally.last)))
    }

    fn outcome(&self) -> String {
        let Some(state) = self.state else { return self.language.say("report-not-kept").to_string() };
        let came_to = match reach(state) {
            // Without a recorded number of reachable cells, the words of the other branch say that the whole hall was
            // searched. Since edition 2, the parts that were not searched follow.
            Some(Reach { reachable, free }) if state.phase.name() == PhaseName::Explored => {
                self.language.say("missions-searched-of").with("reachable", reachable).with("free", free).to_string()
            }
            _ => self.language.came_to(state.phase.name(), self.report.tally.archived.is_some()).to_string(),
        };
        if self.report.claim.edition > 1 { self.language.headline(&came_to, state) } else { came_to }
    }

    fn figures(&self) -> Vec<(Phrase<'static>, String)> {
        let say = |id| self.language.say(id);
        let (tally, report) = (&self.report.tally, self.report);
        let mut figures = Vec::new();
        // Since edition 3, the letterhead names the hall, and says when the mission began and ended.
        let has_letterhead = report.claim.edition > 2;
        if let Some(conditions) = self.state.and_then(|state| state.conditions.as_ref()) {
            if !has_letterhead {
                figures.push((say("hall"), conditions.venue.name.to_string()));
            }
            if let Some(side) = conditions.venue.cell_m {
                figures.push((say("report-cell"), format!("{} m", self.language.number(&side.to_string()))));
            }
            if conditions.venue.is_reckoned {
                figures.push((say("report-reckoned"), say("report-reckoned-so").to_string()));
            }
            figures.push((say("report-threshold"), self.language.celsius(conditions.threshold)));
            let rules = self.language.rules(conditions.rules);
            if !rules.is_empty() {
                figures.push((say("report-rules"), rules.join("; ")));
            }
        }
        if report.claim.edition > 1 {
            let conditions = self.state.and_then(|state| state.conditions.as_ref());
            figures.push((say("robots"), self.language.team(conditions)));
        }
        if !has_letterhead {
            figures.extend([(say("report-began"), report.time_of(tally.first)), self.end()]);
        }
        figures.push((say("report-took"), lasted(tally.took_ms())));
        if tally.clock_sets > 0 {
            figures.push((say("report-clock-set"), say("report-clock-sets").with("count", tally.clock_sets).to_string()));
        }
        figures.push((say("report-zone"), self.zone.name()));
        if let Some(strategy) = tally.strategy {
            figures.push((say("report-strategy"), self.language.say_of("strategy", strategy.name()).to_string()));
        }
        self.state.into_iter().for_each(|state| self.found(state, &mut figures));
        figures.push((say("report-stops"), tally.stops.to_string()));
        figures.push((say("report-accepted"), tally.accepted.to_string()));
        figures.push((say("report-refused"), tally.refused.to_string()));
        let seen = say("report-alarms-seen").with("count", tally.alarms).with("seen", tally.acknowledged);
        figures.push((say("report-alarms"), seen.to_string()));
        if let (Some((coldest, _)), Some((hottest, wall))) = (tally.coldest, tally.hottest) {
            let stays = coldest == hottest && report.claim.edition > 1;
            let say_range =
                say(if stays { "report-constant" } else { "report-range" }).with("least", self.language.celsius(coldest));
            let range = say_range.with("most", self.language.celsius(hottest)).with("time", report.time(wall));
            figures.push((say("temperature"), range.to_string()));
        }
        figures.push((say("report-starts"), tally.restarts.to_string()));
        figures
    }

    fn found(&self, state: &PersistentState, figures: &mut Vec<(Phrase<'static>, String)>) {
        let say = |id| self.language.say(id);
        let visited = state.map.visited();
        let side = state.conditions.as_ref().and_then(|conditions| conditions.venue.cell_m);
        let searched = side.map_or_else(
            || say("report-cells").with("cells", visited),
            |side| {
                let square = format!("{:.0}", visited as f64 * side * side);
                say("report-cells-square").with("cells", visited).with("square", square)
            },
        );
        figures.push((say("report-searched"), searched.to_string()));
        if let Some(Reach { reachable, free }) = reach(state) {
            let cells = say("report-reach-cells").with("reachable", reachable).with("free", free);
            figures.push((say("report-reach"), cells.to_string()));
        }
        let open = if self.report.claim.edition > 1 { state.map.unsearched() } else { state.map.frontier_size() };
        figures.push((say("report-open"), open.to_string()));
        let of = |verdict: &str| state.luggage.iter().filter(|luggage| luggage.verdict_name() == verdict).count();
        let pieces = say("report-pieces").with("count", state.luggage.len()).with("safe", of("safe"));
        let pieces = pieces.with("danger", of("danger")).with("pending", of("pending"));
        figures.push((say("missions-luggage"), pieces.to_string()));
        let secured = state.luggage.iter().filter(|luggage| luggage.secured.is_some()).count();
        figures.push((say("report-secured-count"), secured.to_string()));
        if self.report.claim.edition > 3 {
            figures.push((say("report-finding"), self.language.finding(&state.luggage)));
            let closed = state.closed.as_ref().map(|closed| (closed, self.report.time(closed.wall)));
            let closed = closed.map(|(closed, time)| format!("{time}: {}", self.language.closed(closed)));
            figures.push((say("report-closed"), closed.unwrap_or_else(|| say("report-not-closed").to_string())));
        }
    }

    fn view_box(&self, state: &PersistentState) -> String {
        hall::view_box(state)
    }

    fn hall(&self, state: &PersistentState) -> String {
        hall::picture(state)
    }
}

#[derive(Template)]
#[template(path = "report/piece.html")]
struct Piece<'r> {
    report: &'r Report<'r>,
    language: Language,
    luggage: &'r Luggage,
    /// The photos of the piece. If a photo cannot be shown, the reason stands in its place.
    photos: Vec<Result<Picture, String>>,
    side: Option<f64>,
}

/// What the judges of a piece have answered, beside the verdict.
#[derive(Template)]
#[template(path = "report/judges.html")]
struct Judges {
    said: Vec<String>,
}

struct Picture {
    take: u32,
    media_type: &'static str,
    base64: String,
    digest: String,
}

fn pieces(report: &Report<'_>, state: Option<&PersistentState>, out: &mut dyn Write) -> Result<(), Failure> {
    let language = report.claim.language;
    let title = |text: &dyn std::fmt::Display| format!("<section>\n<h2>{text}</h2>\n</section>\n");
    out.write_all(title(&language.say("missions-luggage").markup()).as_bytes())?;
    let Some(state) = state else { return Ok(()) };
    if state.luggage.is_empty() {
        out.write_all(format!("<p>{}</p>\n", language.say("missions-no-luggage").markup()).as_bytes())?;
    }
    let side = state.conditions.as_ref().and_then(|conditions| conditions.venue.cell_m);
    let share = share(state).filter(|_| report.claim.edition > 1);
    if share.is_some() {
        out.write_all(format!("<p class=\"note\">{}</p>\n", language.say("report-scaled").markup()).as_bytes())?;
    }
    for luggage in state.luggage.iter() {
        let photos = match &luggage.photo {
            PhotoState::Taken { take, .. } => (take.saturating_sub(TAKES - 1).max(1)..=*take)
                .filter_map(|take| picture(report, luggage, take, share).transpose())
                .collect::<Result<_, _>>()?,
            PhotoState::Failed(why) => vec![Err(language.say("report-photo-failed").with("why", why).to_string())],
        };
        part(out, &Piece { report, language, luggage, photos, side })?;
        let said: Vec<String> = language.judges(luggage).into_iter().map(|said| format!("#{}: {said}", luggage.id)).collect();
        if !said.is_empty() {
            part(out, &Judges { said })?;
        }
    }
    Ok(())
}

/// Maximum size of each photo in bytes, if all photos together are too large; otherwise `None`. Computed from the
/// record before any photo is read.
fn share(state: &PersistentState) -> Option<usize> {
    let (mut total, mut count) = (0_usize, 0_usize);
    for luggage in state.luggage.iter() {
        if let PhotoState::Taken { bytes, take } = luggage.photo {
            let takes = take.min(TAKES) as usize;
            total = total.saturating_add(bytes.saturating_mul(takes));
            count += takes;
        }
    }
    (total > PHOTOS).then(|| PHOTOS / count)
}

/// Reads a photo of a piece, and scales it down if it exceeds its share. `None` for a failed attempt, which left no
/// photo.
fn picture(
    report: &Report<'_>,
    luggage: &Luggage,
    take: u32,
    share: Option<usize>,
) -> Result<Option<Result<Picture, String>>, Unreadable> {
    let language = report.claim.language;
    match report.archive.take(luggage.id, take) {
        Ok(photo) => Ok(photo.map(|photo| {
            let digest = hex(&Sha256::digest(&photo.bytes));
            let Some(most) = share.filter(|most| photo.bytes.len() > *most) else {
                return Ok(Picture { take, media_type: photo.media_type, base64: STANDARD.encode(&photo.bytes), digest });
            };
            match scaled(&photo.bytes, photo.media_type, most) {
                Some(jpeg) => Ok(Picture { take, media_type: "image/jpeg", base64: STANDARD.encode(jpeg), digest }),
                None => Err(language.say("report-photo-unscaled").with("take", take).with("digest", digest).to_string()),
            }
        })),
        Err(NoTake::Spoilt(_)) => Ok(Some(Err(language.say("report-photo-spoilt").with("take", take).to_string()))),
        // This fault may pass and is not part of the record, so no report is made.
        Err(NoTake::Unreadable(unreadable)) => Err(unreadable),
    }
}

impl Piece<'_> {
    fn time(&self, wall: &WallTime) -> String {
        self.report.time(*wall)
    }

    /// The cell of the piece. If the size of cells is known, its distances from home to the east and to the south
    /// follow, in metres.
    fn place(&self) -> String {
        let cell = self.luggage.cell;
        let place = self.language.place(cell);
        let Some(side) = self.side else { return place };
        let metres = |cells: i32| self.language.number(&format!("{:.1}", f64::from(cells) * side));
        let say = self.language.say("report-place").with("place", place);
        say.with("east", metres(cell.x)).with("south", metres(cell.y)).to_string()
    }

    fn found(&self) -> String {
        self.time(&if self.report.claim.edition > 1 { self.luggage.waits_since() } else { self.luggage.taken })
    }

    fn waited(&self, decided: &WallTime) -> String {
        lasted(decided.unix_ms.saturating_sub(self.luggage.waits_since().unix_ms))
    }
}

#[derive(Template)]
#[template(path = "report/temperature.html")]
struct Temperature<'r> {
    report: &'r Report<'r>,
    language: Language,
    chart: Option<Chart>,
}

impl Temperature<'_> {
    fn degrees(&self, degrees: &f64) -> String {
        format!("{degrees:.0} °C")
    }

    fn began(&self) -> String {
        self.report.time_of(self.report.tally.first)
    }

    fn ended(&self) -> String {
        self.report.time_of(self.report.tally.last)
    }
}

/// The cells of a row, and the CSS class of the row.
type Cells = (Vec<String>, &'static str);

/// A table of facts: its title, its columns beside entry and time, and the function that makes a row. The function
/// returns `None` for a fact that is not in this table.
struct Table<'t> {
    title: &'static str,
    columns: &'static [&'static str],
    row: &'t dyn Fn(&Fact) -> Option<Cells>,
}

fn tables(report: &Report<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let language = report.claim.language;
    let asked = |fact: &Fact| {
        let Fact::Command { issuer, asked, luggage, refused, .. } = fact else { return None };
        Some((language.asked(asked, *luggage), language.issuer(issuer), refused.clone()))
    };
    let alarm = |fact: &Fact| {
        let is_one = matches!(fact, Fact::AlarmRaised(..) | Fact::AlarmAcknowledged(..));
        is_one.then(|| (vec![language.fact(fact)], ""))
    };
    let refusal = |fact: &Fact| {
        let (asked, issuer, refused) = asked(fact)?;
        Some((vec![asked, issuer, language.refused(&refused?)], ""))
    };
    let told = RefCell::new(String::new());
    let happened = |fact: &Fact| {
        if let Fact::Temperature(..) = fact {
            return None;
        }
        // Every recorded change of the trees repeats the stage. Only a new stage becomes a row.
        if let Fact::Retrieval(_) = fact {
            let words = language.fact(fact);
            if told.replace(words.clone()) == words {
                return None;
            }
        }
        let class = if matches!(fact, Fact::AlarmRaised(..)) { "alarm" } else { "" };
        match asked(fact) {
            Some((_, _, Some(_))) => None,
            Some((asked, issuer, None)) => Some((vec![asked, issuer], class)),
            None => Some((vec![language.fact(fact), String::new()], class)),
        }
    };
    let tables = [
        Table { title: "report-alarms", columns: &["report-what"], row: &alarm },
        Table { title: "report-refusals", columns: &["report-what", "report-by", "report-why"], row: &refusal },
        Table { title: "report-happened", columns: &["report-what", "report-by"], row: &happened },
    ];
    tables.iter().try_for_each(|table| write_table(report, table, out))
}

#[derive(Template)]
#[template(path = "report/table.html")]
struct TableHead {
    language: Language,
    title: Phrase<'static>,
    columns: Vec<Phrase<'static>>,
}

#[derive(Template)]
#[template(path = "report/row.html")]
struct EntryRow {
    seq: Seq,
    moment: String,
    time: String,
    cells: Vec<String>,
    class: &'static str,
}

fn write_table(report: &Report<'_>, table: &Table<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let language = report.claim.language;
    let columns = table.columns.iter().map(|column| language.say(column)).collect();
    part(out, &TableHead { language, title: language.say(table.title), columns })?;
    let mut rows = 0_u64;
    each(report.archive, report.claim.mission, report.claim.until, |seq, entry| {
        let Ok(entry) = entry else { return Ok(()) };
        let Some((cells, class)) = (table.row)(&entry.fact) else { return Ok(()) };
        rows += 1;
        part(out, &EntryRow { seq, moment: rfc3339(entry.wall), time: report.time(entry.wall), cells, class })
    })?;
    let none = if rows == 0 {
        format!("<tr><td colspan=\"9\">{}</td></tr>\n", language.say("report-none").markup())
    } else {
        String::new()
    };
    out.write_all(format!("{none}</tbody>\n</table>\n</section>\n").as_bytes())?;
    Ok(())
}

#[derive(Template)]
#[template(path = "report/evidence.html")]
struct Evidence<'r> {
    report: &'r Report<'r>,
    language: Language,
    file_name: String,
}

/// A duration in hours, minutes and seconds, such as `1:02:05`.
fn lasted(ms: i64) -> String {
    let seconds = ms.max(0) / 1000;
    format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}
