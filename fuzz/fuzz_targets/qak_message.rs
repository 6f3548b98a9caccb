//! Messages of the original system: any bytes parse as a message that is printed and parsed as the same, or are
//! refused with a short sentence. The request in a message is a command, nothing, or a refusal. Other tests check
//! what the core does with it.
#![no_main]

use hallsweep_fuzz::core::command::Command;
use hallsweep_fuzz::doors::mqtt::qak::incoming::{QakRequest, asked, is_stop};
use hallsweep_fuzz::doors::mqtt::qak::message::Message;
use libfuzzer_sys::fuzz_target;

/// Longest refusal in bytes; it quotes little of the message.
const SENTENCE: usize = 1024;

fuzz_target!(|bytes: &[u8]| {
    match Message::parse(bytes) {
        Ok(message) => {
            let printed = message.to_string();
            assert!(printed.len() <= bytes.len(), "nothing is added: {printed}");
            let again = Message::parse(printed.as_bytes()).expect("what was printed can be read");
            assert_eq!(again, message);
            assert_eq!(again.to_string(), printed);
        }
        Err(error) => assert!(error.to_string().len() <= SENTENCE, "{error}"),
    }
    for manual_driving in [false, true] {
        let asked = asked(bytes, manual_driving);
        assert_eq!(is_stop(bytes), asked == Ok(QakRequest::Command(Command::Stop)), "both see the same stops");
        if let Err(wrong) = &asked {
            assert!(wrong.to_string().len() <= SENTENCE && !wrong.asked().to_string().is_empty(), "{wrong}");
        }
    }
});
