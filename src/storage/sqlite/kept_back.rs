//! The file of answers that are kept back: what the first of two judges has answered. It is apart from the journal,
//! because everybody may read the journal. The core decides when an answer becomes an entry.

use super::fault::Fault;
use super::folder::Folder;
use crate::api::journal::{read_answers, written_answers};
use crate::storage::files;
use crate::storage::names::KEPT_BACK;
use hallsweep_core::world::luggage::Judgement;

/// Maximum size of the file, in bytes. It is enough for answers about a thousand pieces.
const MOST: usize = 1 << 20;

pub(super) fn write(folder: &Folder, answers: &[Judgement]) -> Result<(), Fault> {
    let mut file = folder.kept_back();
    if file.path().is_dir() {
        return Err(Fault::Unusable(KEPT_BACK, "it is a folder".to_owned()));
    }
    file.make(written_answers(answers).as_bytes())?;
    Ok(files::sync_folder(folder.path())?)
}

/// Reads the answers. If the file cannot be read, nobody has answered, so both judges are asked again.
pub(super) fn read(folder: &Folder) -> Vec<Judgement> {
    let file = folder.kept_back();
    let unusable = |why: String| {
        tracing::warn!(file = %file.path().display(), why, "answers that were kept back cannot be read: the judges must answer again");
        Vec::new()
    };
    match file.read(MOST) {
        Ok(None) => Vec::new(),
        Ok(Some(bytes)) if bytes.len() > MOST => unusable("the file is too large".to_owned()),
        Ok(Some(bytes)) => {
            let read = String::from_utf8(bytes).map_err(|error| error.to_string());
            read.and_then(|text| read_answers(&text).map_err(|why| why.to_string())).unwrap_or_else(unusable)
        }
        Err(error) => unusable(error.to_string()),
    }
}
