//! A mission for other people, such as the police, as one ZIP file: the report, the entries, all photos, their digests,
//! and how to check them without hallsweep. The same record gives the same bytes.

use std::io::{self, Write};

use sha2::{Digest, Sha256};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{Failure, Report, list};
use crate::phrases::Language;
use crate::runtime::archive::{Archive, NoTake, Unreadable, hex};
use hallsweep_core::units::MissionId;

const SUMS: &str = "SHA256SUMS";

struct BundleWriter<'a> {
    zip: ZipWriter<StreamWriter<&'a mut dyn Write>>,
    folder: String,
    /// One line for each file, as `sha256sum` writes them.
    sums: String,
}

/// Writes the bundle of a mission. Returns the SHA-256 of the list of digests.
pub fn write(archive: &dyn Archive, mission: MissionId, language: Language, out: &mut dyn Write) -> Result<String, Failure> {
    let no_entries = || Unreadable(format!("the journal has no entries of mission {mission}"));
    let report = Report::new(archive, mission, language)?.ok_or_else(no_entries)?;
    let folder = format!("hallsweep-mission-{mission}");
    let mut bundle = BundleWriter { zip: ZipWriter::new_stream(out), folder, sums: String::new() };
    bundle.file("report.html", |file| report.write(file))?;
    bundle.file("entries.jsonl", |file| list::write_lines(archive, mission, file))?;
    let mut lost = Vec::new();
    let luggage = archive.state(mission)?.map(|state| state.of.luggage).unwrap_or_default();
    for piece in luggage.iter() {
        for take in 1..=piece.take().unwrap_or_default() {
            match archive.take(piece.id, take) {
                Ok(Some(photo)) => {
                    let ending = photo.media_type.rsplit('/').next().unwrap_or("bin");
                    let name = format!("photos/luggage-{}-photo-{take}.{ending}", piece.id);
                    bundle.file(&name, |file| Ok(file.write_all(&photo.bytes)?))?;
                }
                Ok(None) | Err(NoTake::Spoilt(_)) => {
                    lost.push(language.say("bundle-photo-lost").with("id", piece.id).with("take", take).to_string());
                }
                Err(NoTake::Unreadable(unreadable)) => return Err(unreadable.into()),
            }
        }
    }
    let readme = language.say("bundle-readme").with("mission", mission).to_string();
    bundle.file("README.txt", |file| Ok(writeln!(file, "{readme}\n{}", lost.join("\n"))?))?;
    let digest = hex(&Sha256::digest(bundle.sums.as_bytes()));
    let sums = std::mem::take(&mut bundle.sums);
    bundle.file(SUMS, |file| Ok(file.write_all(sums.as_bytes())?))?;
    bundle.zip.finish().map_err(io::Error::from)?.into_inner().flush()?;
    Ok(digest)
}

impl BundleWriter<'_> {
    /// Adds a file, and its digest to the list. The photos are compressed already, and the rest is small.
    fn file(&mut self, name: &str, write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>) -> Result<(), Failure> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        let options = options.last_modified_time(DateTime::default()).large_file(true);
        self.zip.start_file(format!("{}/{name}", self.folder), options).map_err(io::Error::from)?;
        let mut hashing = Hashing { to: &mut self.zip, hasher: Sha256::new() };
        write(&mut hashing)?;
        let digest = hex(&hashing.hasher.finalize());
        self.sums += &format!("{digest}  {name}\n");
        Ok(())
    }
}

/// Passes bytes on, and computes their digest.
struct Hashing<W> {
    to: W,
    hasher: Sha256,
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}
