//! The reader of the journal: any bytes give an entry or a sentence; what was read is printed so that it is read again as the
//! same; and no entry, however odd, stops the program from finding out what stands or from going on from there.
#![no_main]

use hallsweep_core::state::PersistentState;
use hallsweep_fuzz::api::journal::{Line, Unparsed, body, line, read_body, read_line, read_record, record};
use hallsweep_fuzz::core::command::Strategy;
use hallsweep_fuzz::core::engine::{Engine, Recalled};
use hallsweep_fuzz::core::settings::Settings;
use hallsweep_fuzz::core::units::{Now, Seq};
use libfuzzer_sys::fuzz_target;

/// The store numbers entries by SQLite's integers, which end here.
const LAST: Seq = Seq(i64::MAX as u64);

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    same(text, read_record, record);
    same(text, read_body, |(fact, picture)| body(fact, picture.as_ref()));
    if let Ok(read) = read_line(text.as_bytes()) {
        // Sentences are not as exact as what they are made of.
        let printed = line(&read);
        assert_eq!(read_line(printed.as_bytes()).map(|again| line(&again)), Ok(printed.clone()), "{printed}");
        let Line { entry, seq, .. } = read;
        let mut state = PersistentState::first(Strategy::default());
        state.apply(&entry);
        let recalled = Recalled { state, written: seq.min(LAST), commands: vec![entry], latest: Vec::new() };
        Engine::recall(Settings::default(), "fuzzed".into(), recalled, Now::default()).snapshot();
    }
});

/// Reads; if it can be read, prints and reads again.
fn same<T: PartialEq + std::fmt::Debug>(
    text: &str,
    read: impl Fn(&str) -> Result<T, Unparsed>,
    print: impl Fn(&T) -> String,
) -> Option<T> {
    match read(text) {
        Ok(first) => {
            let printed = print(&first);
            assert_eq!(read(&printed).as_ref(), Ok(&first), "{printed}");
            Some(first)
        }
        Err(unparsed) => {
            assert!(unparsed.to_string().contains(' '), "{unparsed}");
            None
        }
    }
}
