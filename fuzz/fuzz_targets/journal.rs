//! The parser of the journal: any bytes parse as an entry, or are refused with a sentence. An entry that was parsed,
//! printed and parsed again is the same. No entry, however odd, prevents the program from computing the state or from
//! resuming.
#![no_main]

use hallsweep_core::state::PersistentState;
use hallsweep_fuzz::api::journal::{Line, Unparsed, body, line, read_answers, read_body, read_line, read_record, record, written_answers};
use hallsweep_fuzz::core::command::Strategy;
use hallsweep_fuzz::core::engine::{Engine, Recalled};
use hallsweep_fuzz::core::settings::Settings;
use hallsweep_fuzz::core::units::{Now, Seq};
use libfuzzer_sys::fuzz_target;

/// Largest integer of SQLite, with which the store numbers entries.
const LAST: Seq = Seq(i64::MAX as u64);

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    same(text, read_record, record);
    same(text, read_answers, |answers| written_answers(answers));
    same(text, read_body, |(fact, picture)| body(fact, picture.as_ref()));
    if let Ok(read) = read_line(text.as_bytes()) {
        // Sentences lose some precision, so the printed lines are compared instead of the entries.
        let printed = line(&read);
        assert_eq!(read_line(printed.as_bytes()).map(|again| line(&again)), Ok(printed.clone()), "{printed}");
        let Line { entry, seq, .. } = read;
        let mut state = PersistentState::first(Strategy::default());
        state.apply(&entry);
        let recalled = Recalled { state, written: seq.min(LAST), commands: vec![entry], kept_back: Vec::new(), latest: Vec::new() };
        Engine::recall(Settings::default(), "fuzzed".into(), recalled, Now::default()).snapshot();
    }
});

/// Parses a text; if that succeeds, prints and parses it again and compares the results.
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
