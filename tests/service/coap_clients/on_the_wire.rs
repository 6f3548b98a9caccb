//! Datagrams between three clients and the program: the requested message types, returned tokens, bounded sizes, and
//! lost answers that are sent again without a second effect.

use super::ask::Ask;
use super::client::Client;
use super::tap::Tap;
use super::{JSON, OCTETS, serve, with_each};

/// A block of 1024 bytes with header and options stays below the size that every path carries without fragmentation
/// (RFC 7252, section 4.6).
const LARGEST: usize = 1152;

const NON: u8 = 1;
const ACK: u8 = 2;

/// The client retransmits the message, and the program recognises the repetition.
#[test]
fn an_answer_that_is_lost_is_sent_again_and_nothing_is_done_twice() {
    with_each(|client| {
        let program = serve("seed", "max");
        program.command("start").accepted();
        let piece = program.until_asked();
        let tap = Tap::losing(program.coap(), 1);
        client.ask(&tap.url(), &Ask::post(&format!("/luggage/{piece}/photo"), "{}").labelled(JSON)).accepted();
        let (asked, said): (Vec<_>, Vec<_>) = tap.passed().into_iter().partition(|datagram| !datagram.is_answer);
        assert!(asked.len() >= 2 && said.len() >= 2, "{client:?} asked {asked:?} and was answered {said:?}");
        assert_eq!(asked[0].bytes, asked[1].bytes, "{client:?} repeats itself");
        assert_eq!(said[0].bytes, said[1].bytes, "and so does the door");
        let photographed = |state: &serde_json::Value| state["luggage"][0]["photo"]["take"] == 2;
        let state = program.until("another photo is there", photographed);
        assert_eq!(state["luggage"][0]["photo"]["state"], "taken");
        program.command("stop").accepted();
        let state = program.until("it stands", |state| state["robot"]["state"] == "stopped");
        assert!(photographed(&state), "once, not twice: {state:#}");
    });
}

#[test]
fn what_is_asked_without_confirmation_is_answered_without() {
    with_each(|client| {
        let program = serve("empty-8x8", "max");
        let tap = Tap::losing(program.coap(), 0);
        client.ask(&tap.url(), &Ask::get("/robot").accept(JSON).non()).json();
        client.ask(&tap.url(), &Ask::get("/robot").accept(JSON)).json();
        let kinds: Vec<u8> = tap.passed().iter().filter(|datagram| datagram.is_answer).map(|answer| answer.kind()).collect();
        assert_eq!(kinds, [NON, ACK], "{client:?}");
    });
}

#[test]
fn tokens_of_any_length_come_back() {
    if !Client::Libcoap.is_here() {
        return;
    }
    let program = serve("empty-8x8", "max");
    for token in ["a", "abcd", "abcdefgh"] {
        let tap = Tap::losing(program.coap(), 0);
        let reply = Client::Libcoap.ask(&tap.url(), &Ask { token: Some(token), ..Ask::get("/robot").accept(JSON) });
        assert_eq!(reply.json()["heading"], "south", "with the token `{token}`");
        let passed = tap.passed();
        assert_eq!((passed[0].token().len(), passed[0].token()), (token.len(), passed[1].token()), "{passed:?}");
    }
}

#[test]
fn no_datagram_is_larger_than_every_path_carries() {
    let program = serve("seed", "max");
    program.command("start").accepted();
    let piece = program.until_asked();
    with_each(|client| {
        let tap = Tap::losing(program.coap(), 0);
        let photo = format!("/luggage/{piece}/photo");
        for (path, format) in [("/state", JSON), (&photo, OCTETS), ("/.well-known/core", super::LINKS)] {
            client.ask(&tap.url(), &Ask::get(path).accept(format)).content();
        }
        let largest = tap.passed().iter().map(|datagram| datagram.bytes.len()).max();
        assert!(largest.is_some_and(|largest| (1024..=LARGEST).contains(&largest)), "{client:?}: {largest:?}");
    });
}
