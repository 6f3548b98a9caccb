//! A mission for other people, such as the police, as one ZIP file: the report, the entries, the photos, the digests of
//! these files, and how to check them without hallsweep. The same record gives the same bytes.

use std::io::{self, Write};

use sha2::{Digest, Sha256};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::page::TAKES;
use super::{Claim, Failure, Report, list, still_there};
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
    match bundle.fill(archive, &report, language) {
        Ok(digest) => {
            bundle.zip.finish().map_err(io::Error::from)?.into_inner().flush()?;
            Ok(digest)
        }
        Err(failure) => {
            // Dropping the writer would complete the file, as if everything were in it.
            std::mem::forget(bundle.zip);
            Err(failure)
        }
    }
}

impl BundleWriter<'_> {
    fn fill(&mut self, archive: &dyn Archive, report: &Report<'_>, language: Language) -> Result<String, Failure> {
        let Claim { mission, until, .. } = report.claim;
        self.file("report.html", |file| report.write(file))?;
        self.file("entries.jsonl", |file| list::write_lines_until(archive, mission, until, file))?;
        let state = archive.state(mission)?;
        let mut missing = state.iter().flat_map(|state| state.damage.clone()).collect::<Vec<_>>();
        for piece in state.iter().flat_map(|state| state.of.luggage.iter()) {
            let newest = piece.take().unwrap_or_default();
            for take in newest.saturating_sub(TAKES - 1).max(1)..=newest {
                match archive.take(piece.id, take) {
                    Ok(Some(photo)) => {
                        let ending = photo.media_type.rsplit('/').next().unwrap_or("bin");
                        let name = format!("photos/luggage-{}-photo-{take}.{ending}", piece.id);
                        self.file(&name, |file| Ok(file.write_all(&photo.bytes)?))?;
                    }
                    Ok(None) | Err(NoTake::Spoilt(_)) => {
                        missing.push(language.say("bundle-photo-lost").with("id", piece.id).with("take", take).to_string());
                    }
                    Err(NoTake::Unreadable(unreadable)) => return Err(unreadable.into()),
                }
            }
        }
        still_there(archive, mission, report.began)?;
        let readme = language.say("bundle-readme").with("mission", mission).to_string();
        self.file("README.txt", |file| Ok(writeln!(file, "{readme}\n{}", missing.join("\n"))?))?;
        let sums = std::mem::take(&mut self.sums);
        self.file(SUMS, |file| Ok(file.write_all(sums.as_bytes())?))?;
        Ok(hex(&Sha256::digest(sums.as_bytes())))
    }

    /// Adds a file, and its digest to the list.
    fn file(&mut self, name: &str, write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>) -> Result<(), Failure> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
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
