//! A photo of more than 64 KiB that a client fetches in blocks equals the photo over HTTP, byte for byte.

use super::ask::Ask;
use super::client::Client;
use super::{ETAG, OCTETS, door, serve, with_each};
use crate::program::Program;

/// Photo size above which a photo has more than 1,024 blocks of 64 bytes and more than 4,096 of 16 bytes. The Block
/// option then needs two bytes for the former and three for the latter (RFC 7959).
const LARGE: usize = 64 * 1024;

/// Searches the airport until a piece has a large photo. Returns the path and the photo.
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

/// Request for a photo. coap-cli does not know the image formats and cannot read an answer in one, so it asks for
/// octets.
fn get(client: Client, path: &str) -> Ask<'_> {
    if client == Client::CoapCli { Ask::get(path).accept(OCTETS) } else { Ask::get(path) }
}

/// Compares two photos without printing them.
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

/// A client that has the current photo receives 2.03 without a payload. A photo taken again has another tag, so a
/// client with the old tag receives the new photo.
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
