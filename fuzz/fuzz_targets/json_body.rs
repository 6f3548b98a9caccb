//! The bodies of all commands: any bytes give a command, or a sentence that repeats little of them.
//! What the core makes of a command is tested elsewhere.
#![no_main]

use hallsweep_fuzz::wire::command::{EpochBody, GotoBody, MoveBody, StrategyBody, TemperatureBody, Unusable, VerdictBody};
use hallsweep_fuzz::wire::fields::{Body, Unread, body};
use libfuzzer_sys::fuzz_target;

/// The longest sentence about a body of any length.
const SENTENCE: usize = 400;

fuzz_target!(|bytes: &[u8]| {
    read::<EpochBody>(bytes).map(EpochBody::epoch);
    said(read::<MoveBody>(bytes).map(|body| body.command()));
    said(read::<GotoBody>(bytes).map(GotoBody::command));
    said(read::<VerdictBody>(bytes).map(|body| body.verdict()));
    said(read::<TemperatureBody>(bytes).map(|body| body.report()));
    said(read::<StrategyBody>(bytes).map(|body| body.strategy()));
});

fn read<T: Body>(bytes: &[u8]) -> Option<T> {
    match body(bytes) {
        Ok(read) => Some(read),
        Err(Unread::Malformed(words)) => {
            sentence(&words);
            None
        }
        Err(Unread::Unusable(unusable)) => {
            sentence(&unusable.to_string());
            None
        }
    }
}

fn said<T>(command: Option<Result<T, Unusable>>) {
    if let Some(Err(unusable)) = command {
        sentence(&unusable.to_string());
    }
}

fn sentence(words: &str) {
    assert!(words.contains(' ') && words.len() <= SENTENCE, "{words}");
}
