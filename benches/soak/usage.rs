//! Resources of a running program, read from Linux's `/proc`.

use std::path::Path;
use std::time::Duration;

use crate::program::Program;

/// Heading of the table whose rows are made by `line`.
pub(crate) const HEADING: &str = "  time  missions  revision   memory  descriptors  threads   journal    photos";

/// One measurement.
pub(crate) struct Usage {
    /// Resident memory, in kB.
    pub(crate) memory_kb: u64,
    /// Number of open files and sockets.
    pub(crate) descriptors: u64,
    pub(crate) threads: u64,
    /// Size of the journal in bytes, including the write-ahead log.
    journal: u64,
    /// Size of the photos in bytes.
    photos: u64,
}

impl Usage {
    /// Measures a running program.
    pub(crate) fn of(program: &Program) -> Usage {
        let status = std::fs::read_to_string(program.proc("status")).unwrap_or_default();
        let field = |name: &str| {
            let value = status.lines().find_map(|line| line.strip_prefix(name)?.split_whitespace().next()?.parse().ok());
            value.expect("the program is alive, and this system has /proc")
        };
        Usage {
            memory_kb: field("VmRSS:"),
            descriptors: descriptors(program),
            threads: field("Threads:"),
            journal: bytes(&program.folder, "journal"),
            photos: bytes(&program.folder.join("photos"), ""),
        }
    }

    /// Row of the table.
    pub(crate) fn line(&self, since: Duration, missions: u64, revision: u64, note: &str) -> String {
        let Usage { memory_kb, descriptors, threads, journal, photos } = self;
        let (seconds, journal, photos) = (since.as_secs(), journal / 1000, photos / 1000);
        format!(
            "{seconds:>4} s  {missions:>8}  {revision:>8}  {memory_kb:>4} kB  {descriptors:>11}  {threads:>7}  {journal:>5} kB  {photos:>5} kB  {note}"
        )
    }
}

fn descriptors(program: &Program) -> u64 {
    let open = std::fs::read_dir(program.proc("fd")).expect("a child's descriptors can be counted");
    open.count() as u64
}

/// Total size in bytes of the files in a folder whose names begin with `begins`, including the files of matching
/// folders.
fn bytes(folder: &Path, begins: &str) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(data) if data.is_dir() => bytes(&entry.path(), ""),
        Ok(data) => data.len(),
        Err(_) => 0,
    };
    entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(begins)).map(of).sum()
}
