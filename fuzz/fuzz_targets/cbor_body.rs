//! The bodies of all commands in CBOR: any bytes parse as a command, or are refused with a sentence that quotes
//! little of them. Other tests check what the core does with a command.
#![no_main]

mod bodies;

use bodies::Notation;
use hallsweep_fuzz::api::cbor;
use hallsweep_fuzz::api::fields::{Body, Unread};
use libfuzzer_sys::fuzz_target;

struct Cbor;

impl Notation for Cbor {
    fn body<T: Body>(bytes: &[u8]) -> Result<T, Unread> {
        cbor::body(bytes)
    }
}

fuzz_target!(|bytes: &[u8]| bodies::check::<Cbor>(bytes));
