//! The routes of the old console (mission §8). Each is a POST whose path is the whole command; a body is not read. A
//! browser that sent a form is redirected to the page. A program gets the same answer as at `/api/v1`.

use axum::http::{HeaderMap, Uri};
use axum::response::{IntoResponse, Redirect, Response};

use super::accept::preferred;
use super::command::CommandSender;
use super::language::PageReader;
use super::{command, console};
use crate::api::old_clients::posted;

/// `POST w`, `POST startappl` and others: carries out the command in the path.
pub(super) async fn give(sender: CommandSender, uri: Uri, headers: HeaderMap) -> Response {
    let given = match posted(uri.path().trim_start_matches('/')) {
        Ok(command) => command::give(&sender, command, None).await,
        Err(unusable) => Err(unusable.into()),
    };
    let wants_page = preferred(&headers, &["application/json", "text/html"]) == Some("text/html");
    match given {
        Ok(_) if wants_page => Redirect::to("/").into_response(),
        Err(problem) if wants_page => {
            let to = PageReader::new(sender.caller.clone(), &headers);
            console::refused_page(&sender.door, &to, "old", &problem).await
        }
        Ok(answer) => answer,
        Err(problem) => problem.into_response(),
    }
}
