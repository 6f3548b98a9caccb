//! `hallsweep serve`: starts the program and says where it is, and how one gets in.

use std::net::SocketAddr;

use super::{Failure, Serve, link};
use crate::app::{self, Doors, Entry};
use crate::config::HttpSettings;

/// Serves until a signal ends it.
///
/// # Errors
/// Wrong settings, a bad hall file, keys that cannot be had, a port that cannot be had, or a loop that ended by itself.
pub fn run(flags: &Serve) -> Result<(), Failure> {
    let settings = super::settings(&flags.sources())?;
    app::serve(&settings, |doors, entry| {
        // Whoever closed standard output does not want to know; the program serves all the same.
        let _ = super::print(&announcement(&settings.http, doors, entry));
    })?;
    Ok(())
}

/// Where it is, and how one gets in.
fn announcement(http: &HttpSettings, doors: Doors, entry: &Entry) -> String {
    let console = console(http, doors.http, entry);
    doors.coap.map_or(console.clone(), |coap| format!("{console}\nIts CoAP resources are at coap://{coap}"))
}

/// Where the console is, and how one gets in. A token is shown when it was just made, and then only here: never in the log.
fn console(http: &HttpSettings, address: SocketAddr, entry: &Entry) -> String {
    let at = format!("hallsweep is at {}://{address}", link::scheme(http));
    match entry {
        Entry::Open => at,
        Entry::Key => format!("{at}\nIt asks for a key: `hallsweep token` shows links to sign in with."),
        Entry::NewKey(token) => {
            format!("{at}\nIts first key was made just now. Sign in as operator: {}", link::sign_in(http, address, token))
        }
        Entry::BriefKey(token) => format!(
            "{at}\nNothing is kept (store.folder = \"none\"), so its key is good until it ends. Sign in as operator: {}",
            link::sign_in(http, address, token)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::Token;
    use crate::config::{Sources, load};

    #[test]
    fn a_token_is_shown_only_when_it_was_just_made() {
        let http = load(&Sources::default()).unwrap().http;
        let doors = Doors { http: "0.0.0.0:8080".parse().unwrap(), coap: None };
        let token = Token::draw().unwrap();
        let said = |entry: &Entry| announcement(&http, doors, entry);
        assert_eq!(said(&Entry::Open), "hallsweep is at http://0.0.0.0:8080");
        assert!(said(&Entry::Key).contains("`hallsweep token`"));
        for entry in [Entry::NewKey(token.clone()), Entry::BriefKey(token.clone())] {
            let link = format!("http://localhost:8080/sign-in?token={}", token.reveal());
            assert!(said(&entry).ends_with(&link), "{}", said(&entry));
        }
    }

    #[test]
    fn the_last_line_says_where_the_coap_resources_are() {
        let http = load(&Sources::default()).unwrap().http;
        let doors = Doors { http: "127.0.0.1:8080".parse().unwrap(), coap: "127.0.0.1:40123".parse().ok() };
        let expect = "hallsweep is at http://127.0.0.1:8080\nIts CoAP resources are at coap://127.0.0.1:40123";
        assert_eq!(announcement(&http, doors, &Entry::Open), expect);
    }
}
