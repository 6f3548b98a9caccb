//! The hall that a user has chosen in the simulator. It is stored in the data folder, so that a restart continues in
//! this hall. The file consists of two additional lines, followed by the text of a hall file. The chosen hall applies
//! while the settings name the same hall as when it was chosen.

use std::io;
use std::path::{Path, PathBuf};

use super::remote::SimulatedHall;
use crate::storage::names;
use crate::storage::small_file::SmallFile;
use hallsweep_sim::{Export, Format, Hall};

/// Maximum size in bytes: room for the largest hall and the lines before it.
const MOST: usize = 4 << 20;

const INSTEAD: &str = "# chosen in the simulator instead of ";
const SEED: &str = "# seed ";

#[derive(Clone, Debug)]
pub(in crate::robots) struct ChosenHall {
    folder: PathBuf,
    usual: String,
}

#[derive(Debug, thiserror::Error)]
#[error(
    "the hall that was chosen in the simulator, {}, cannot be used: {fault}; correct the file, or move it away to use the hall \
     of the setting hall.file, then start hallsweep again",
    .path.display()
)]
pub(in crate::robots) struct UnusableChosenHall {
    path: PathBuf,
    fault: String,
}

impl ChosenHall {
    pub(in crate::robots) fn within(folder: &Path, usual: &str) -> ChosenHall {
        ChosenHall { folder: folder.to_owned(), usual: usual.to_owned() }
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    fn file(&self) -> SmallFile {
        SmallFile::within(&self.folder, names::CHOSEN_HALL)
    }

    /// The chosen hall, if it was chosen while the settings named the same hall as now.
    pub(in crate::robots) fn read(&self) -> Result<Option<SimulatedHall>, UnusableChosenHall> {
        let path = names::CHOSEN_HALL.within(&self.folder);
        let unusable = |fault: String| UnusableChosenHall { path: path.clone(), fault };
        let Some(bytes) = self.file().read(MOST).map_err(|error| unusable(error.to_string()))? else { return Ok(None) };
        let text = String::from_utf8(bytes).map_err(|_| unusable("it is not text".to_owned()))?;
        let line = |begin: &str| text.lines().find_map(|line| line.strip_prefix(begin)).map(str::to_owned);
        let instead = line(INSTEAD).ok_or_else(|| unusable(format!("the line `{INSTEAD}…` is missing")))?;
        if instead != written(&self.usual) {
            tracing::info!(
                instead,
                hall = self.usual,
                "the setting hall.file has changed since this hall was chosen in the simulator: hallsweep uses the setting"
            );
            return Ok(None);
        }
        let seed = line(SEED).and_then(|seed| seed.parse().ok());
        let seed = seed.ok_or_else(|| unusable(format!("the line `{SEED}…` with its number is missing")))?;
        let hall = Hall::parse(names::CHOSEN_HALL.written(), &text).map_err(|error| unusable(error.to_string()))?;
        Ok(Some(SimulatedHall { hall: hall.into(), seed }))
    }

    /// Stores the chosen hall completely, or not at all.
    pub(super) fn keep(&self, ground: &SimulatedHall) -> io::Result<()> {
        let hall = file_of(&ground.hall);
        let text = format!("{INSTEAD}{}\n{SEED}{}\n{hall}", written(&self.usual), ground.seed);
        self.file().make(text.as_bytes())
    }
}

pub(super) fn file_of(hall: &Hall) -> String {
    let file = Export::from(hall.clone()).file(Format::Toml, "hall");
    String::from_utf8_lossy(&file).into_owned()
}

fn written(name: &str) -> String {
    format!("{name:?}")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn ground() -> SimulatedHall {
        SimulatedHall { hall: Arc::new(Hall::named_or_file("airport").expect("it is built in")), seed: 7 }
    }

    #[test]
    fn what_was_chosen_comes_back_until_the_settings_name_another_hall() {
        let folder = Scratch::new();
        let chosen = ChosenHall::within(&folder.0, "halls/a \"b\".toml");
        assert!(chosen.read().expect("nothing is there").is_none());
        chosen.keep(&ground()).expect("the folder can be written");
        let back = chosen.read().expect("it is ours").expect("it is there");
        assert_eq!((&*back.hall, back.seed), (&*ground().hall, 7));
        assert!(ChosenHall::within(&folder.0, "seed").read().expect("it is ours").is_none());
    }

    #[test]
    fn what_cannot_be_used_is_said_with_its_file_and_what_to_do() {
        let folder = Scratch::new();
        let chosen = ChosenHall::within(&folder.0, "seed");
        for (text, words) in [
            ("width = 3\n", "the line `# chosen in the simulator instead of …` is missing"),
            ("# chosen in the simulator instead of \"seed\"\nwidth = 3\nheight = 3\n", "the line `# seed …`"),
            ("# chosen in the simulator instead of \"seed\"\n# seed 1\nwidth = 0\nheight = 3\n", ":3: "),
        ] {
            std::fs::write(names::CHOSEN_HALL.within(&folder.0), text).expect("the folder can be written");
            let said = chosen.read().expect_err("it is damaged").to_string();
            assert!(said.contains("simulated-hall.toml") && said.contains(words) && said.contains("move it away"), "{said}");
        }
    }
}
