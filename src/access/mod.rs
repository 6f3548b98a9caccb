//! Who may do what: named keys with roles, stored in a file that only its owner reads, and sessions signed with these
//! keys. A door (HTTP, CoAP, MQTT) passes on what a client sent, and learns here who the client is.

mod attempts;
mod caller;
mod error;
mod file;
mod keyring;
mod keys;
mod moment;
mod network;
mod role;
mod session;
mod token;

pub use attempts::Attempts;
pub use caller::{Access, Caller};
pub use error::AccessError;
pub use file::KeyFile;
pub use keyring::{Keyring, Opened};
pub use keys::{Key, Keys, OPERATOR, SignedIn, halls};
pub use moment::{Moment, SESSION_S};
pub use network::{Network, is_this_machine};
pub use role::{Need, Role};
pub use session::Person;
pub use token::{Token, chance};
