//! Property of the body of every command: it parses as a command, or is refused with a sentence that quotes little of
//! it. The fuzz targets choose the notation.

use hallsweep_core::command::LuggageRef;
use hallsweep_fuzz::api::command::{
    AreaBody, CloseAreaBody, CloseBody, EpochBody, GotoBody, HandOverBody, MoveBody, OrderAreasBody, RetrieveBody, StrategyBody,
    TemperatureBody, Unusable, VerdictBody,
};
use hallsweep_fuzz::api::fields::{Body, Unread};

/// Longest refusal in bytes, for a body of any length.
const SENTENCE: usize = 400;

/// Notation in which bodies are written.
pub(crate) trait Notation {
    fn body<T: Body>(bytes: &[u8]) -> Result<T, Unread>;
}

/// Parses these bytes as the body of each command.
pub(crate) fn check<N: Notation>(bytes: &[u8]) {
    read::<N, EpochBody>(bytes).map(EpochBody::epoch);
    read::<N, RetrieveBody>(bytes).map(RetrieveBody::command);
    said(read::<N, CloseBody>(bytes).map(|body| body.command()));
    said(read::<N, HandOverBody>(bytes).map(|body| body.command()));
    said(read::<N, AreaBody>(bytes).map(AreaBody::command));
    said(read::<N, OrderAreasBody>(bytes).map(|body| body.command()));
    said(read::<N, CloseAreaBody>(bytes).map(|body| body.command()));
    said(read::<N, MoveBody>(bytes).map(|body| body.command()));
    said(read::<N, GotoBody>(bytes).map(GotoBody::command));
    said(read::<N, VerdictBody>(bytes).map(|body| body.command(LuggageRef::Pending)));
    said(read::<N, TemperatureBody>(bytes).map(|body| body.report()));
    said(read::<N, StrategyBody>(bytes).map(|body| body.strategy()));
}

fn read<N: Notation, T: Body>(bytes: &[u8]) -> Option<T> {
    match N::body(bytes) {
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
