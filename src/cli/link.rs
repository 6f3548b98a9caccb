//! Links for signing in. The network decides whether the address of a link can be reached from elsewhere.

use std::net::SocketAddr;

use crate::access::Token;
use crate::config::{HttpSettings, from_here};

pub(super) const fn scheme(http: &HttpSettings) -> &'static str {
    if http.tls.is_some() { "https" } else { "http" }
}

pub(super) fn sign_in(http: &HttpSettings, address: SocketAddr, token: &Token) -> String {
    format!("{}://{}/sign-in?token={}", scheme(http), host(http, address), token.reveal())
}

fn host(http: &HttpSettings, address: SocketAddr) -> String {
    match http.hosts.first() {
        Some(name) => format!("{name}:{}", address.port()),
        None => from_here(address).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Sources, load};

    #[test]
    fn a_link_names_a_host_that_a_browser_finds() {
        let mut http = load(&Sources::default()).unwrap().http;
        let token = Token::draw().unwrap();
        let begins = |http: &HttpSettings, address: &str, expect: &str| {
            let link = sign_in(http, address.parse().unwrap(), &token);
            assert_eq!(link, format!("{expect}/sign-in?token={}", token.reveal()));
        };
        begins(&http, "0.0.0.0:8080", "http://127.0.0.1:8080");
        begins(&http, "[::]:8080", "http://[::1]:8080");
        begins(&http, "192.0.2.7:80", "http://192.0.2.7:80");
        begins(&http, "[2001:db8::1]:80", "http://[2001:db8::1]:80");
        http.hosts = vec!["hall.example".to_owned(), "engine".to_owned()];
        begins(&http, "0.0.0.0:8080", "http://hall.example:8080");
    }
}
