//! A photo of more than 64 KiB, fetched in blocks by every client, is the one that the HTTP door serves, byte for byte.

use super::ask::Ask;
use super::client::Client;
use super::{ETAG, OCTETS, door, serve, with_each};
use crate::program::Program;

/// With 64-byte blocks and more than 1,024 of them a block's number no longer fits into one byte, and in 16-byte blocks not into two.
const LARGE: usize = 64 * 1024;

/// Searches the airport until a piece has a large photo; its path, and the photo.
fn a_large_photo(program: &Program) -> (String, Vec<u8>) {
    program.command("start").accepted();
    loop {
        let piece = program.until_asked();
        let photo = program.read(&format!("/api/v1/luggage/{piece}/photo"), &[]);
        assert_eq!(photo.status, 200, "{photo:?}");
        if photo.body.len() > LARGE {
            return (format!("/luggage/{piece}/photo"), photo.body);
        }
        program.verdict(piece, "safe").accepted();
    }
}

/// How a client asks for a photo. coap-cli cannot take an answer in a format that it does not know, and knows no pictures.
fn get(client: Client, path: &str) -> Ask<'_> {
    if client == Client::CoapCli { Ask::get(path).accept(OCTETS) } else { Ask::get(path) }
}

/// Compares without printing either.
fn same(client: Client, what: &str, seen: &[u8], photo: &[u8]) {
    let differs = seen.iter().zip(photo).position(|(one, other)| one != other);
    assert!(seen == photo, "{client:?}, {what}: {} bytes of {}, the first difference at {differs:?}", seen.len(), photo.len());
}

#[test]
fn a_large_photo_arrives_byte_for_byte_in_blocks_of_64_and_of_1024_bytes() {
    let program = serve("airport", "max");
    let door = door(&program);
    let (path, photo) = a_large_photo(&program);
    with_each(|client| {
        for size in [64, 1024] {
            let reply = client.ask(&door, &get(client, &path).in_blocks_of(size));
            same(client, &format!("blocks of {size}"), reply.content(), &photo);
        }
        let reply = client.ask(&door, &get(client, &path));
        same(client, "blocks of the door's choice", reply.content(), &photo);
    });
}

#[test]
fn a_large_photo_arrives_in_blocks_whose_numbers_take_three_bytes() {
    if !Client::Libcoap.is_here() {
        return;
    }
    let program = serve("airport", "max");
    let (path, photo) = a_large_photo(&program);
    let reply = Client::Libcoap.ask(&door(&program), &Ask::get(&path).in_blocks_of(16));
    same(Client::Libcoap, "blocks of 16", reply.content(), &photo);
}

/// A photo that was taken again is another one, and whoever has the old one is told so.
#[test]
fn whoever_has_the_photo_is_told_so_in_four_bytes() {
    let program = serve("seed", "max");
    let door = door(&program);
    program.command("start").accepted();
    let piece = program.until_asked();
    let path = format!("/luggage/{piece}/photo");
    with_each(|client| {
        let tag = super::reading::tag(&door, &path);
        let reply = client.ask(&door, &get(client, &path).with(ETAG, &tag));
        assert!(reply.body.is_empty() && !reply.code.starts_with('4'), "2.03 carries nothing: {reply:?}");
        let taken = program.json("state")["luggage"][0]["photo"]["take"].clone();
        program.press(&format!("/api/v1/luggage/{piece}/photo")).accepted();
        program.until("another photo is there", |state| {
            let photo = &state["luggage"][0]["photo"];
            photo["take"] != taken && photo["state"] == "taken"
        });
        let reply = client.ask(&door, &get(client, &path).with(ETAG, &tag));
        let photo = program.read(&format!("/api/v1/luggage/{piece}/photo"), &[]).body;
        same(client, "with the old tag", reply.content(), &photo);
    });
}
