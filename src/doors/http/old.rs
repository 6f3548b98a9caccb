//! The old console's routes (mission §8): bare POSTs whose path is the whole command; what their body holds is not read.
//! A browser that posted a form is sent back to the page, a program gets the answer of the interface.

use axum::http::{HeaderMap, Uri};
use axum::response::{IntoResponse, Redirect, Response};

use super::accept::preferred;
use super::command_sender::CommandSender;
use super::problem::Problem;
use super::{command, console};
use crate::api::command::move_word;
use hallsweep_core::command::{Command, LuggageRef, TemperatureReport, Verdict};

/// `POST w`, `POST startappl` and the others: the path is the command.
pub(super) async fn give(sender: CommandSender, uri: Uri, headers: HeaderMap) -> Response {
    let command = command(uri.path().trim_start_matches('/'));
    let given = match command {
        Ok(command) => command::give(&sender, command, None).await,
        Err(problem) => Err(problem),
    };
    let wants_page = preferred(&headers, &["application/json", "text/html"]) == Some("text/html");
    match given {
        Ok(_) if wants_page => Redirect::to("/").into_response(),
        Err(problem) if wants_page => console::refused_page(&sender.door, &sender.caller, "old", &problem).await,
        Ok(answer) => answer,
        Err(problem) => problem.into_response(),
    }
}

fn command(word: &str) -> Result<Command, Problem> {
    let verdict = |verdict| Command::Verdict { luggage: LuggageRef::Pending, verdict };
    Ok(match word {
        "safe" => verdict(Verdict::Safe),
        "danger" => verdict(Verdict::Danger),
        "startappl" => Command::Start,
        "stopappl" => Command::Stop,
        "backhomeappl" => Command::BackHome,
        "temperatureOk" => Command::Temperature(TemperatureReport::Ok),
        "temperatureTooHigh" => Command::Temperature(TemperatureReport::TooHigh),
        letter => move_word(letter)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_old_path_is_a_command() {
        let rows = super::super::routes::table();
        let old: Vec<&str> =
            rows.iter().map(|row| &*row.path).filter(|path| command(path.trim_start_matches('/')).is_ok()).collect();
        assert_eq!(old.len(), 16, "{old:?}");
        assert_eq!(command("h").unwrap(), Command::Stop);
    }
}
