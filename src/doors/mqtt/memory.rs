//! How much memory the program has in use, where the system tells (Linux does). What is done about it is not decided here.

/// Where Linux tells a program about itself, and on which line.
const STATUS: &str = "/proc/self/status";
const RESIDENT: &str = "VmRSS:";

/// The memory in use, in bytes; `None`: the system does not tell.
pub(super) fn in_use() -> Option<usize> {
    read(&std::fs::read_to_string(STATUS).ok()?)
}

fn read(status: &str) -> Option<usize> {
    let line = status.lines().find_map(|line| line.strip_prefix(RESIDENT))?;
    let kibibytes: usize = line.trim().strip_suffix(" kB")?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_as_linux_writes_it_and_nothing_else_is() {
        assert_eq!(read("VmPeak:\t  9000 kB\nVmRSS:\t   8123 kB\nThreads:\t1\n"), Some(8123 * 1024));
        for strange in
            ["", "VmRSS:", "VmRSS: many kB", "VmRSS: 8 MB", "VmRSS: 99999999999999999999 kB", "VmRSS: 18446744073709551615 kB"]
        {
            assert_eq!(read(strange), None, "{strange}");
        }
    }
}
