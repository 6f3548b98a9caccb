//! `hallsweep roomba`: the Roomba of the original specification (seed 001), in simulated time. It runs as a state
//! machine, as a behaviour tree, or as both. `hallsweep_laboratory::roomba` runs and draws the Roomba; this file
//! prints the figures.

use std::path::{Path, PathBuf};

use clap::Args;

use super::Failure;
use hallsweep_laboratory::roomba::{Controller, Roomba as Runs, RunLength};

#[derive(Args, Clone, Debug)]
#[command(after_help = "Without --fsm and --tree, both controllers run and are compared; the exit code is 1 if their runs \
                        differ.\n\
    Floor: share of the reachable 5 cm squares whose centre the body passed over.")]
pub struct Roomba {
    /// Run only the finite state machine.
    #[arg(long, conflicts_with = "tree")]
    fsm: bool,
    /// Run only the behaviour tree.
    #[arg(long)]
    tree: bool,
    /// Seed of the turn angles: the same number gives the same run.
    #[arg(long, value_name = "NUMBER", default_value = "1", value_parser = seed, allow_hyphen_values = true)]
    seed: u64,
    /// Length of the run in simulated seconds, from 1 to 3600.
    #[arg(long, value_name = "SECONDS", default_value = "60", allow_hyphen_values = true)]
    seconds: RunLength,
    /// Print one JSON object, frames included, instead of the figures.
    #[arg(long)]
    json: bool,
    /// Write a drawing of room, path and floor to this file, as SVG; "-" prints the drawing instead of the figures.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

pub fn run(flags: &Roomba) -> Result<(), Failure> {
    let prints_drawing = flags.svg.as_deref() == Some(Path::new("-"));
    if prints_drawing && flags.json {
        return Err(Failure::Usage("--json and --svg - both print to standard output: give --svg a file".to_owned()));
    }
    let runs = Runs::new(flags.controllers(), flags.seed, flags.seconds);
    match &flags.svg {
        Some(_) if prints_drawing => super::print(runs.drawing().trim_end())?,
        Some(path) => std::fs::write(path, runs.drawing())
            .map_err(|error| Failure::Run(format!("the drawing {} cannot be written: {error}", path.display())))?,
        None => {}
    }
    if flags.json {
        super::print(&runs.json())?;
    } else if !prints_drawing {
        super::print(&for_people(flags.seed, flags.seconds, &runs))?;
    }
    runs.parting().map_or(Ok(()), |parting| Err(Failure::Run(parting.to_string())))
}

impl Roomba {
    const fn controllers(&self) -> &'static [Controller] {
        match (self.fsm, self.tree) {
            (true, _) => &[Controller::Machine],
            (false, true) => &[Controller::Tree],
            (false, false) => &Controller::ALL,
        }
    }
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

fn for_people(seed: u64, length: RunLength, runs: &Runs) -> String {
    let line = |name: &str, values: &[String]| {
        let columns: String = values.iter().map(|value| format!("{value:<16}")).collect();
        format!("{name:<20}{}", columns.trim_end())
    };
    let names: Vec<String> = runs.names().into_iter().map(str::to_owned).collect();
    let mut lines = vec![line("seed", &[seed.to_string()]), line("seconds", &[length.seconds().to_string()]), line("", &names)];
    lines.extend(runs.figures().iter().map(|(name, values)| line(name, values)));
    if runs.is_comparison() {
        lines.push(line("same transitions", &[if runs.parting().is_some() { "no" } else { "yes" }.to_owned()]));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        flags: Roomba,
    }

    fn typed(flags: &str) -> Result<Roomba, String> {
        let words = ["roomba"].into_iter().chain(flags.split_whitespace());
        Typed::try_parse_from(words).map(|typed| typed.flags).map_err(|error| error.to_string())
    }

    #[test]
    fn neither_flag_means_both_and_both_flags_are_refused() {
        assert_eq!(typed("").unwrap().controllers(), [Controller::Machine, Controller::Tree]);
        assert_eq!(typed("--fsm").unwrap().controllers(), [Controller::Machine]);
        assert_eq!(typed("--tree").unwrap().controllers(), [Controller::Tree]);
        assert!(typed("--fsm --tree").is_err());
    }

    #[test]
    fn what_is_no_seed_or_no_length_is_refused_in_words() {
        for (flags, words) in [
            ("--seed -1", "write a whole number from 0 to 18446744073709551615"),
            ("--seed 18446744073709551616", "write a whole number from 0 to"),
            ("--seed many", "write a whole number from 0 to"),
            ("--seconds -5", "\"-5\" is not a length of a run: give 1 to 3600 seconds"),
            ("--seconds 1e9", "\"1e9\" is not a length of a run"),
            ("--seconds NaN", "\"NaN\" is not a length of a run"),
        ] {
            let said = typed(flags).unwrap_err();
            assert!(said.contains(words), "{flags}: {said}");
        }
        assert_eq!(typed("--seed 18446744073709551615").unwrap().seed, u64::MAX);
    }

    #[test]
    fn the_figures_of_both_stand_side_by_side_and_say_that_they_are_the_same() {
        let length = RunLength::from_seconds(3.0).unwrap();
        let said = for_people(7, length, &Runs::new(&Controller::ALL, 7, length));
        let begins = "seed                7\nseconds             3\n                    machine         tree\n\
                      path                1.50 m          1.50 m\n";
        assert!(said.starts_with(begins), "{said}");
        assert!(said.ends_with("same transitions    yes"), "{said}");
        let one = for_people(7, length, &Runs::new(&[Controller::Machine], 7, length));
        assert!(!one.contains("same transitions") && !one.contains("tree"), "{one}");
    }
}
