//! `hallsweep hall convert`: a hall from any file or built-in one into a file of another format.
//! The formats are `hallsweep_sim`'s; how a file is written stands in `map_file`.

use clap::{Args, Subcommand};

use super::Failure;
use super::map_file::MapFile;
use hallsweep_sim::{Export, Hall};

/// What to do with halls.
#[derive(Args, Clone, Debug)]
pub struct Halls {
    #[command(subcommand)]
    what: What,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Write a hall in the format that the name of the file says, and print what is lost on the way.
    Convert(Convert),
}

/// The flags of `hall convert`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Formats: .toml (our own), .map (MovingAI), .yaml with a .pgm beside it (ROS map_server), .txt (as old clients show a map).\n\
    docs/halls.md says what each can hold."
)]
struct Convert {
    /// A built-in hall, or a file: .toml, .map, .yaml, .txt, or the .pgm or .png image beside a .yaml of the same name.
    #[arg(value_name = "FROM")]
    from: String,
    /// The file to write, which ends in .toml, .map, .yaml or .txt.
    #[arg(value_name = "TO")]
    to: String,
    /// The side of a cell, where FROM is a map of pixels; half a metre when left out.
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    cell: Option<f64>,
    /// Replace files that are there.
    #[arg(long)]
    force: bool,
}

/// Does it, and prints what was written.
pub fn run(asked: &Halls) -> Result<(), Failure> {
    let What::Convert(Convert { from, to, cell, force }) = &asked.what;
    let hall = Hall::open(from, *cell).map_err(|error| Failure::Usage(error.to_string()))?;
    let line = MapFile::at(to, *force)?.write(&Export::from(hall))?;
    super::print(&line)
}
