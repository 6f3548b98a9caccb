//! `hallsweep hall convert` writes a hall file or a built-in hall in another format. `hallsweep hall import` makes a
//! hall from a scene of the virtual robot's page. The formats are in `hallsweep_sim`; `map_file` writes the file.

use std::path::Path;

use clap::{Args, Subcommand};

use super::Failure;
use super::map_file::MapFile;
use hallsweep_sim::{Export, Hall, Scene};

/// The subcommands of `hallsweep hall`.
#[derive(Args, Clone, Debug)]
pub struct Halls {
    #[command(subcommand)]
    what: What,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Convert a hall to the format of the output file's name, and print what this format cannot store.
    Convert(Convert),
    /// Make a hall from a scene file of the virtual robot's page, and print what the conversion loses.
    Import(Import),
}

#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Formats: .toml (our own), .map (MovingAI), .yaml with a .pgm beside it (ROS map_server), .txt (the map of old \
                  clients).\n\
    docs/halls.md says what each format can store."
)]
struct Convert {
    /// A built-in hall, or a file: .toml, .map, .yaml, .txt, or the .pgm or .png image beside a .yaml of the same name.
    #[arg(value_name = "FROM")]
    from: String,
    /// The file to write, which ends in .toml, .map, .yaml or .txt.
    #[arg(value_name = "TO")]
    to: String,
    /// Side of a cell in metres, if FROM is a map of pixels; 0.5 by default.
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    cell: Option<f64>,
    /// Overwrite existing files.
    #[arg(long)]
    force: bool,
}

#[derive(Args, Clone, Debug)]
struct Import {
    /// The scene file: a JavaScript module with one object.
    #[arg(value_name = "FILE")]
    file: String,
    /// The file to write, in a format of `hall convert`; by default the name of FILE with .toml, in the current folder.
    #[arg(value_name = "TO")]
    to: Option<String>,
    /// Overwrite existing files.
    #[arg(long)]
    force: bool,
}

pub fn run(asked: &Halls) -> Result<(), Failure> {
    let line = match &asked.what {
        What::Convert(Convert { from, to, cell, force }) => {
            let hall = Hall::open(from, *cell).map_err(|error| Failure::Usage(error.to_string()))?;
            MapFile::at(to, *force)?.write(&Export::from(hall))?
        }
        What::Import(Import { file, to, force }) => {
            let stem = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
            let scene = Scene::open(file).map_err(|error| Failure::Usage(error.to_string()))?;
            let hall = scene.hall(&stem).map_err(|fault| Failure::Usage(fault.of(file).to_string()))?;
            let to = to.clone().unwrap_or_else(|| format!("{stem}.toml"));
            let [scene_file, target] = [file, &to].map(|path| std::fs::canonicalize(path).ok());
            if scene_file.is_some() && scene_file == target {
                return Err(Failure::Usage(format!("{to} is the scene file itself: choose another name")));
            }
            MapFile::at(&to, *force)?.write(&Export::from(hall))?
        }
    };
    super::print(&line)
}
