//! THE TABLE of words of the original system's clients (mission §8). Three doors use it: HTTP for the routes of the
//! old console, CoAP for the words of `/resourcemodel`, MQTT for the messages that it accepts. This file also says
//! what old clients may not do at any door.

use super::command::move_word;
use super::fields::Unusable;
use hallsweep_core::command::{Command, Hot, LuggageRef, TemperatureReport, Verdict};
use hallsweep_core::refused::Refused;

#[derive(Debug)]
pub enum Asks {
    For(Command),
    /// A command that halts, whatever is sent along with the word.
    Halt(Command),
    /// A move. The letter is the word itself, or the content of a message `MSGID(w)`. `h` is STOP.
    Move,
    /// Driving to a cell, with the message `MSGID(X,Y)`.
    Goto,
    /// Takes a failed photo again. If no photo has failed, begins or resumes the mission like START.
    GoOn,
    /// A move, `MSGID(robot,w)`, or a verdict, `MSGID(luggage,safe)`.
    Change,
}

#[derive(Debug)]
pub struct OldCommandRow {
    pub asks: Asks,
    /// Paths to which the old console sends POST requests.
    pub posts: &'static [&'static str],
    /// Whether `/resourcemodel` accepts these words, too.
    pub is_word: bool,
    pub messages: &'static [&'static str],
}

pub const SAFE: Command = Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Hot::NONE };
pub const DANGER: Command =
    Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Danger, note: None, hot: Hot::NONE };

const MOVES: &[&str] = &["w", "s", "a", "l", "d", "r", "h", "z", "x"];

#[rustfmt::skip]
pub static ROWS: [OldCommandRow; 12] = [
    word(Asks::Move, MOVES, &["userCmd", "robotCmd"]),
    word(Asks::For(SAFE), &["safe"], &["luggageSafe", "continueExploreAfterPhoto"]),
    word(Asks::For(DANGER), &["danger"], &["luggageDanger", "backHomeSinceBomb"]),
    row(Asks::For(Command::Start), &["startappl"], &["startCmd", "explore", "startAppl"]),
    row(Asks::Halt(Command::Stop), &["stopappl"], &["stopCmd", "stopExplore", "stopAppl"]),
    row(Asks::For(Command::BackHome), &["backhomeappl"], &["backHomeCmd", "backHome"]),
    row(Asks::For(Command::Temperature(TemperatureReport::Ok)), &["temperatureOk"], &["temperatureOk"]),
    row(Asks::Halt(Command::Temperature(TemperatureReport::TooHigh)), &["temperatureTooHigh"], &["temperatureTooHigh"]),
    row(Asks::For(Command::Retrieve(None)), &[], &["reachBag"]),
    row(Asks::Goto, &[], &["startTest"]),
    row(Asks::GoOn, &[], &["continueExplore"]),
    row(Asks::Change, &[], &["modelChange"]),
];

const fn row(asks: Asks, posts: &'static [&'static str], messages: &'static [&'static str]) -> OldCommandRow {
    OldCommandRow { asks, posts, is_word: false, messages }
}

const fn word(asks: Asks, posts: &'static [&'static str], messages: &'static [&'static str]) -> OldCommandRow {
    OldCommandRow { asks, posts, is_word: true, messages }
}

/// Returns the command for a POST request of the old console to this path.
pub fn posted(word: &str) -> Result<Command, Unusable> {
    command(word, |_| true)
}

/// Returns the command for a bare word at `/resourcemodel`.
pub fn bare_word(word: &str) -> Result<Command, Unusable> {
    command(word, |row| row.is_word)
}

fn command(word: &str, is_among: fn(&OldCommandRow) -> bool) -> Result<Command, Unusable> {
    let row = ROWS.iter().find(|row| is_among(row) && row.posts.contains(&word));
    match row.map(|row| &row.asks) {
        Some(Asks::For(command) | Asks::Halt(command)) => Ok(command.clone()),
        Some(Asks::Move | Asks::Goto | Asks::GoOn | Asks::Change) | None => move_word(word),
    }
}

/// Checks whether an old client may send this command. Moving by hand and driving to a cell need the setting
/// `old_clients.manual_driving`. An old console sends a stray `w` when it starts, and this `w` must not move an idle
/// robot.
///
/// # Errors
/// `NotAllowed` when the robot would be driven and `manual_driving` does not allow it.
pub fn may_drive(command: &Command, manual_driving: bool) -> Result<(), Refused> {
    if manual_driving || !matches!(command, Command::Move(_) | Command::Goto(_)) {
        return Ok(());
    }
    let words = "old clients may not drive the robot here: set old_clients.manual_driving to allow it; h always halts the robot";
    Err(Refused::NotAllowed(words.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::command::Move;
    use hallsweep_core::units::Cell;

    #[test]
    fn only_driving_needs_leave() {
        for command in [Command::Move(Move::Forward), Command::Goto(Cell::HOME)] {
            assert!(may_drive(&command, true).is_ok());
            assert_eq!(may_drive(&command, false).unwrap_err().code(), "notAllowed");
        }
        assert!(may_drive(&Command::Start, false).is_ok() && may_drive(&Command::Stop, false).is_ok());
    }

    #[test]
    fn every_old_path_is_a_command_and_none_is_there_twice() {
        let mut posts: Vec<&str> = ROWS.iter().flat_map(|row| row.posts).copied().collect();
        assert!(posts.iter().all(|word| posted(word).is_ok()));
        assert_eq!(posted("h").unwrap(), Command::Stop);
        assert_eq!(posts.len(), 16, "{posts:?}");
        let mut messages: Vec<&str> = ROWS.iter().flat_map(|row| row.messages).copied().collect();
        assert_eq!(messages.len(), 20, "{messages:?}");
        for all in [&mut posts, &mut messages] {
            let number = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), number);
        }
    }

    #[test]
    fn at_the_resource_model_only_moves_and_verdicts_are_words() {
        assert_eq!(bare_word("safe").unwrap(), SAFE);
        assert_eq!(bare_word("l").unwrap(), Command::Move(Move::TurnLeft));
        assert!(["startappl", "temperatureOk", "backhomeappl", "luggageSafe"].iter().all(|word| bare_word(word).is_err()));
    }
}
