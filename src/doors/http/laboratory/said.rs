//! The laboratory's runs in the language of the page: figures, events, and the words in the drawings. On the command
//! line, `hallsweep_laboratory` prints the same words in English.

use crate::phrases::Language;
use hallsweep_laboratory::pallet::{AskedFault, Entry, Figures as Carried, Missed, News, Pallet, PalletFault, Spread, kind};
use hallsweep_laboratory::roomba::{Controller, Figures, Parting, Phase, Roomba, Run, Transition, Words};

pub(super) type Row = (String, Vec<String>);

pub(super) struct Event {
    /// Seconds since the beginning of the run, with a decimal point, for scripts.
    pub(super) t: String,
    pub(super) parcel: u32,
    pub(super) kind: &'static str,
    pub(super) words: String,
    /// Text beside the drawing. It is shown until the next event with such a text.
    pub(super) while_it_lasts: Option<String>,
}

pub(super) fn figures(language: Language, roomba: &Roomba) -> Vec<Row> {
    let runs = roomba.runs();
    let row = |name: String, value: &dyn Fn(&Run) -> String| (name, runs.iter().map(value).collect());
    let said = |id: &str| language.say(id).to_string();
    let decimal = |number: String, unit: &str| format!("{} {unit}", language.number(&number));
    let squares = |figures: &Figures| language.say("laboratory-of").with("part", figures.passed).with("whole", figures.reachable);
    let mut rows = vec![
        row(said("laboratory-path"), &|run| decimal(format!("{:.2}", run.figures.path_m), "m")),
        row(said("laboratory-floor-passed"), &|run| decimal(format!("{:.1}", run.figures.share() * 100.0), "%")),
        row(said("laboratory-squares"), &|run| squares(&run.figures).to_string()),
        row(said("laboratory-walls-met"), &|run| run.figures.bumps.to_string()),
        row(said("laboratory-transitions"), &|run| run.transitions.len().to_string()),
    ];
    for (index, phase) in Phase::ALL.into_iter().enumerate() {
        rows.push(row(phase.name().to_owned(), &|run| decimal(format!("{:.2}", run.figures.in_phase_s[index]), "s")));
    }
    rows
}

pub(super) fn parting(language: Language, parting: &Parting) -> String {
    let goes = |change: &Transition| {
        let seconds = language.number(&format!("{:.2}", change.seconds()));
        let said = match change.angle {
            Some(angle) => language.say("laboratory-turns").with("angle", language.number(&format!("{angle:.3}"))),
            None => language.say("laboratory-goes"),
        };
        said.with("from", change.from.name()).with("to", change.to.name()).with("seconds", seconds)
    };
    let [machine, tree] =
        parting.next.each_ref().map(|(_, next)| next.as_ref().map_or_else(|| language.say("laboratory-goes-no-further"), goes));
    language.say("laboratory-parting").with("common", parting.common).with("machine", machine).with("tree", tree).to_string()
}

impl Words for Language {
    fn title(&self, run: &Run) -> String {
        let who = match run.controller {
            Controller::Machine => self.say("laboratory-state-machine"),
            Controller::Tree => self.say("laboratory-behaviour-tree"),
        };
        let seconds = self.number(&run.figures.seconds.to_string());
        self.say("laboratory-drawn").with("who", who).with("seed", run.seed).with("seconds", seconds).to_string()
    }

    fn summary(&self, run: &Run) -> String {
        let figures = &run.figures;
        let said = self.say("laboratory-summary").with("floor", self.number(&format!("{:.1}", figures.share() * 100.0)));
        said.with("way", self.number(&format!("{:.2}", figures.path_m))).with("walls", figures.bumps).to_string()
    }

    fn wall_met(&self) -> String {
        self.say("laboratory-wall-met").to_string()
    }

    fn floor_passed(&self) -> String {
        self.say("laboratory-floor-passed").to_string()
    }

    fn start_and_end(&self) -> String {
        self.say("laboratory-start-and-end").to_string()
    }
}

pub(super) fn events(language: Language, pallet: &Pallet) -> Vec<Event> {
    pallet.entries().iter().map(|entry| event(language, entry)).collect()
}

fn event(language: Language, entry: &Entry) -> Event {
    let kind = kind(entry.news);
    let (words, while_it_lasts) = match entry.news {
        News::Began(phase) => {
            let number = phase.number().to_string();
            let what = language.say_of("laboratory-phase", &number).to_string();
            (language.say("laboratory-began").with("phase", &number).with("what", &what).to_string(), Some(what))
        }
        News::Said(saying) => {
            let said = language.say("laboratory-alarm").with("what", language.say_of("saying", saying.name())).to_string();
            (said.clone(), Some(said))
        }
        News::Acknowledged | News::Started | News::Lost | News::Stopped | News::Restarted => {
            (language.say_of("laboratory-event", kind).to_string(), None)
        }
    };
    Event { t: format!("{:.1}", entry.at.as_secs_f64()), parcel: entry.parcel, kind, words, while_it_lasts }
}

pub(super) fn carried(language: Language, figures: &Carried) -> Vec<(String, String)> {
    let decimal = |number: f64, places: usize| language.number(&format!("{number:.places$}"));
    let error = |spread: &Spread, scale: f64, unit: &str| {
        let said = language.say("laboratory-error").with("worst", decimal(spread.worst() * scale, 2));
        said.with("rms", decimal(spread.rms() * scale, 2)).with("unit", unit).to_string()
    };
    let delivered = language.say("laboratory-delivered").with("delivered", figures.delivered).with("parcels", figures.parcels);
    let took =
        language.say("laboratory-took").with("seconds", decimal(figures.took.as_secs_f64(), 1)).with("ticks", figures.ticks);
    let holding = &figures.holding;
    let rows = [
        ("parcels", delivered.to_string()),
        ("time", took.to_string()),
        ("losses", figures.losses.to_string()),
        ("force", error(&holding.force_n, 1.0, "N")),
        ("angle", error(&holding.angle_rad, 1000.0, "mrad")),
        ("gap", error(&holding.gap_m, 1000.0, "mm")),
        ("seed", figures.seed.to_string()),
    ];
    rows.map(|(name, value)| (language.say_of("laboratory-figure", name).to_string(), value)).into()
}

/// Returns the requested mishaps that did not happen, each with the reason.
pub(super) fn missed(language: Language, pallet: &Pallet) -> Vec<String> {
    let said = |(fault, why): (AskedFault, Missed)| {
        let what = language.say_of("laboratory-mishap", fault.mishap.name());
        let why = language.say_of("laboratory-missed", why.name());
        language.say("laboratory-not-happened").with("what", what).with("why", why).to_string()
    };
    pallet.missed().into_iter().map(said).collect()
}

pub(super) fn fault(language: Language, fault: PalletFault) -> String {
    match fault {
        PalletFault::Pair(fault) => language.say_of("not-fetched", fault.name()).to_string(),
        PalletFault::OperatorAbsent | PalletFault::NotAllThere | PalletFault::TakesTooLong => {
            language.say_of("laboratory-fault", fault.name()).to_string()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_laboratory::pallet::{self, Mishap, asked};
    use std::time::Duration;

    fn roomba() -> Roomba {
        Roomba::both(1, 60).unwrap()
    }

    fn lost() -> Pallet {
        let faults = [Mishap::Lost.at(1)];
        Pallet::new(1, 1, faults.to_vec(), asked(1, &faults).unwrap()).unwrap()
    }

    #[test]
    fn in_english_the_page_and_the_command_line_say_the_same() {
        let (roomba, pallet) = (roomba(), lost());
        let told: Vec<Row> = roomba.figures().into_iter().map(|(name, values)| (name.to_owned(), values)).collect();
        assert_eq!(figures(Language::English, &roomba), told);
        assert!(roomba.drawings(&Language::English).iter().all(|drawing| roomba.drawing().contains(drawing_title(drawing))));
        let told: Vec<_> = pallet::rows(pallet.figures()).map(|(name, value)| (name.to_owned(), value)).into();
        assert_eq!(carried(Language::English, pallet.figures()), told);
        for (entry, event) in pallet.entries().iter().zip(events(Language::English, &pallet)) {
            assert_eq!(event.words, pallet::words(entry));
        }
        for wrong in [PalletFault::OperatorAbsent, PalletFault::NotAllThere, PalletFault::TakesTooLong] {
            assert_eq!(fault(Language::English, wrong), wrong.in_words());
        }
    }

    fn drawing_title(drawing: &str) -> &str {
        drawing.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>")).expect("it has a title").0
    }

    #[test]
    fn a_parting_is_said_as_the_command_line_says_it_and_in_italian() {
        let [machine, tree] = [roomba().runs()[0].transitions[0]; 2];
        let turn = Transition { angle: Some(-0.25), ..tree };
        let of = |next: [Option<Transition>; 2]| Parting {
            common: 2,
            next: [(Controller::Machine, next[0]), (Controller::Tree, next[1])],
        };
        let parted = [[Some(machine), Some(turn)], [None, Some(tree)], [Some(machine), None]].map(of);
        for parted in &parted {
            assert_eq!(parting(Language::English, parted), parted.to_string());
        }
        assert_eq!(
            parting(Language::Italian, &parted[2]),
            "macchina e albero differiscono dopo 2 transizioni: la macchina passa da MoveForward a MoveInSpiral a 3,00 s, \
             l'albero non ha altre transizioni"
        );
    }

    #[test]
    fn every_member_of_a_family_is_said_in_both_languages() {
        let at = |news| Entry { at: Duration::from_millis(1500), parcel: 2, news };
        let phases = pallet::Phase::ALL.map(News::Began);
        let others = [News::Acknowledged, News::Started, News::Lost, News::Stopped, News::Restarted];
        for news in phases.into_iter().chain(others) {
            let [english, italian] = Language::ALL.map(|language| event(language, &at(news)).words);
            assert_ne!(english, italian);
        }
        for mishap in Mishap::ALL {
            let [english, italian] =
                Language::ALL.map(|language| language.say_of("laboratory-mishap", mishap.name()).to_string());
            assert_ne!(english, italian);
        }
        for controller in Controller::ALL {
            let [english, italian] =
                Language::ALL.map(|language| language.say_of("laboratory-column", controller.name()).to_string());
            assert_eq!(english, controller.name());
            assert_ne!(english, italian);
        }
        for wrong in [PalletFault::OperatorAbsent, PalletFault::NotAllThere, PalletFault::TakesTooLong] {
            assert_ne!(fault(Language::Italian, wrong), wrong.in_words());
        }
        for why in Missed::ALL {
            let [english, italian] = Language::ALL.map(|language| language.say_of("laboratory-missed", why.name()).to_string());
            assert_eq!(english, why.in_words());
            assert_ne!(english, italian);
        }
        for held in ["force", "angle", "gap"] {
            let [english, italian] = Language::ALL.map(|language| language.say_of("laboratory-held", held).to_string());
            assert_ne!(english, italian);
        }
    }

    #[test]
    fn italian_writes_a_comma_before_the_decimals() {
        let roomba = roomba();
        assert!(
            figures(Language::Italian, &roomba)[0].1[0].ends_with(" m")
                && figures(Language::Italian, &roomba)[0].1[0].contains(',')
        );
        let drawn = roomba.drawings(&Language::Italian).concat();
        assert!(
            drawn.contains(">Macchina a stati, seme 1, 60 s<") && drawn.contains("partenza; il cerchio è l'arrivo"),
            "{drawn}"
        );
    }
}
