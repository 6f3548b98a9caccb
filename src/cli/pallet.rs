//! `hallsweep pallet`: two mobile manipulators carry parcels from a pallet to a target area, in simulated time. Three
//! behaviour trees control the robots. The scenario runs in `hallsweep_laboratory::pallet`; this file prints its
//! phases and figures, and a picture.

use std::path::PathBuf;

use clap::Args;

use super::Failure;
use hallsweep_laboratory::pallet::{Asked, AskedFault, BeyondError, Figures, PalletRun, ReportJson, TITLE};
use hallsweep_laboratory::pallet::{asked, drawing, missed, parcel_number, rows, words};

#[derive(Args, Clone, Debug)]
pub struct Pallet {
    /// Number of parcels on the pallet, from 1 to 24.
    #[arg(long, value_name = "NUMBER", default_value_t = 3, value_parser = parcel_number, allow_hyphen_values = true)]
    parcels: u32,
    /// Seed of all random numbers: the same number gives the same yard and the same run.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// Simulate a fault, at the first parcel or at the parcel with this number: lost (on the way), lostLifting,
    /// unrecognised, blocked (the way stays closed), jammed (a gripper does not close), absent (the operator never
    /// comes). May be given several times.
    #[arg(long = "fault", value_name = "NAME[@PARCEL]")]
    faults: Vec<AskedFault>,
    /// Print one JSON object instead of the phases and the figures.
    #[arg(long)]
    json: bool,
    /// Write a drawing of the yard and the driven paths to this file, as SVG; "-" prints only the drawing.
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    svg: Option<PathBuf>,
}

pub fn run(flags: &Pallet) -> Result<(), Failure> {
    let asked = flags.asked()?;
    let mut run = PalletRun::new(flags.parcels, flags.seed, asked).map_err(|error| Failure::Run(error.to_string()))?;
    let figures = run.finish();
    match &flags.svg {
        Some(file) if file.as_os_str() == "-" => super::print(drawing(&run, TITLE).trim_end())?,
        Some(file) => {
            std::fs::write(file, drawing(&run, TITLE))
                .map_err(|error| Failure::Run(format!("the picture {} cannot be written: {error}", file.display())))?;
            super::print(&for_people(&run, &figures))?;
        }
        None if flags.json => super::print(&flags.report(&run, &figures))?,
        None => super::print(&for_people(&run, &figures))?,
    }
    outcome(&flags.faults, &run, &figures)
}

fn for_people(run: &PalletRun, figures: &Figures) -> String {
    let passed = run.entries().iter().map(|entry| {
        let at = entry.at.as_secs_f64();
        format!("{at:>8.1} s  parcel {:>2}  {}", entry.parcel, words(entry))
    });
    let rows = rows(figures).map(|(name, value)| format!("{name:<20}{value}"));
    passed.chain([String::new()]).chain(rows).collect::<Vec<_>>().join("\n")
}

/// Fails if not all parcels reached the target area, or if a requested fault did not happen. The error names the
/// reason, and each requested fault that did not happen.
fn outcome(faults: &[AskedFault], run: &PalletRun, figures: &Figures) -> Result<(), Failure> {
    let mut words: Vec<String> =
        missed(faults, run).iter().map(|(fault, why)| format!("--fault {fault} did not happen: {}", why.in_words())).collect();
    if let Some(fault) = figures.fault {
        let (delivered, parcels) = (figures.delivered, figures.parcels);
        let ended = format!("{}: {} ({delivered} of {parcels} parcels are in the target area)", fault.name(), fault.in_words());
        words.insert(0, ended);
    }
    if words.is_empty() { Ok(()) } else { Err(Failure::Run(words.join("\n"))) }
}

impl Pallet {
    fn asked(&self) -> Result<Asked, Failure> {
        asked(self.parcels, &self.faults).map_err(|BeyondError { parcel }| {
            Failure::Usage(format!("--fault names parcel {parcel}, but --parcels puts only {} on the pallet", self.parcels))
        })
    }

    fn report(&self, run: &PalletRun, figures: &Figures) -> String {
        serde_json::to_string(&ReportJson::new(run, figures, &self.faults)).expect("a report is finite numbers and words")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flags(parcels: u32, faults: &[&str]) -> Pallet {
        let faults = faults.iter().map(|fault| fault.parse().expect("it is well written")).collect();
        Pallet { parcels, seed: 2, faults, json: false, svg: None }
    }

    fn ran(flags: &Pallet) -> (PalletRun, Figures) {
        let mut run = PalletRun::new(flags.parcels, flags.seed, flags.asked().expect("it fits")).expect("a good number");
        let figures = run.finish();
        (run, figures)
    }

    #[test]
    fn what_is_to_go_wrong_at_a_parcel_that_is_not_there_is_a_mistake_of_the_flags() {
        let words = flags(1, &["lost@2"]).asked().map(drop).unwrap_err().to_string();
        assert_eq!(words, "--fault names parcel 2, but --parcels puts only 1 on the pallet");
    }

    #[test]
    fn a_run_that_brings_all_parcels_is_well_and_one_that_does_not_fails_by_name() {
        for (faults, name) in [
            (&["lost", "unrecognised"][..], None),
            (&["lostLifting"], None),
            (&["blocked"], Some("noWayToTarget")),
            (&["jammed"], Some("robotFails")),
            (&["lost", "absent"], Some("operatorAbsent")),
        ] {
            let flags = flags(1, faults);
            let (run, figures) = ran(&flags);
            let words = outcome(&flags.faults, &run, &figures).err().map(|failure| failure.to_string());
            assert_eq!(words.as_deref().map(|words| words.split(':').next().unwrap_or_default()), name, "{faults:?}: {words:?}");
        }
    }

    /// Tests twelve yards. In some of them the path from the pallet to the target area has two steps.
    #[test]
    fn what_is_asked_to_go_wrong_happens_or_the_run_fails_and_says_why_it_did_not() {
        const EARLY: &str = "the run ended earlier";
        /// The requested faults, then the faults that do not happen, each with the reason.
        type Row<'a> = (&'a [&'a str], &'a [(&'a str, &'a str)]);
        let table: [Row<'_>; 9] = [
            (&["lost@1", "lost@2", "lostLifting@2", "unrecognised@1"], &[]),
            (&["lost", "lost", "unrecognised", "unrecognised"], &[]),
            (&["absent"], &[("absent", "the operator was never called")]),
            (&["absent", "lost"], &[]),
            (&["jammed@1", "lost@1", "unrecognised@2"], &[("lost@1", EARLY), ("unrecognised@2", EARLY)]),
            (&["jammed@2", "jammed@1"], &[("jammed@2", EARLY)]),
            (&["blocked@1", "blocked@2", "lost@2"], &[("blocked@2", EARLY), ("lost@2", EARLY)]),
            (&["blocked@2", "unrecognised@2"], &[]),
            (&["jammed@1", "jammed@1"], &[]),
        ];
        for (faults, expect) in table {
            for seed in 1..=12 {
                let flags = Pallet { seed, ..flags(2, faults) };
                let (run, figures) = ran(&flags);
                let failed = outcome(&flags.faults, &run, &figures).err().map(|failure| failure.to_string()).unwrap_or_default();
                let said: Vec<&str> = failed.lines().filter(|line| line.starts_with("--fault")).collect();
                let expect: Vec<String> =
                    expect.iter().map(|(fault, why)| format!("--fault {fault} did not happen: {why}")).collect();
                assert_eq!(said, expect, "seed {seed}, {faults:?}");
                let json: serde_json::Value = serde_json::from_str(&flags.report(&run, &figures)).expect("it is JSON");
                assert_eq!(json["notHappened"].as_array().map(Vec::len), Some(expect.len()));
            }
        }
    }

    #[test]
    fn the_report_tells_the_phases_as_they_pass_and_the_same_as_json() {
        let flags = flags(2, &["unrecognised@2"]);
        let (run, figures) = ran(&flags);
        let text = for_people(&run, &figures);
        let phases: Vec<usize> = (1..=8).filter(|phase| text.contains(&format!("phase {phase}: "))).collect();
        assert_eq!(phases, [1, 2, 3, 4, 5, 6, 7, 8], "{text}");
        assert!(text.contains("the pair recognises no parcel") && text.contains("worst force error"), "{text}");
        let json: serde_json::Value = serde_json::from_str(&flags.report(&run, &figures)).expect("it is JSON");
        assert_eq!((&json["figures"]["delivered"], &json["fault"]), (&serde_json::json!(2), &serde_json::Value::Null));
        let first: Vec<u64> =
            json["events"].as_array().into_iter().flatten().filter_map(|event| event["phase"].as_u64()).collect();
        assert_eq!(first, [1, 2, 3, 4, 5, 6, 7, 8, 3, 4, 5, 6, 7]);
    }
}
