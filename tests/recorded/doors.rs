//! Every name of the program that the recorder uses, in one place: where modules move or are renamed, only this file follows.

pub(crate) use hallsweep::access::{Access, Caller, Key, Keyring, Keys, OPERATOR, Role, Token};
pub(crate) use hallsweep::core::command::{
    CODES, Command, CommandId, LuggageRef, Refusal, RefusalKind, Refused, TemperatureReport, Verdict,
};
pub(crate) use hallsweep::core::effect::{Entry, Fact, Page};
pub(crate) use hallsweep::core::event::{Event, RobotEvent, RobotId};
pub(crate) use hallsweep::core::explore::Strategy;
pub(crate) use hallsweep::core::mission::{Hold, PhaseName};
pub(crate) use hallsweep::core::rng::Stream;
pub(crate) use hallsweep::core::settings::Settings;
pub(crate) use hallsweep::core::units::{AlarmId, Cell, Epoch, LuggageId, MissionId, Revision, Seq};
pub(crate) use hallsweep::core::world::resource::Resource;
pub(crate) use hallsweep::core::world::snapshot::Snapshot;
pub(crate) use hallsweep::headless::Run;
pub(crate) use hallsweep::inbound::coap::endpoint::code::{Code, Method};
pub(crate) use hallsweep::inbound::coap::endpoint::format::Format;
pub(crate) use hallsweep::inbound::coap::endpoint::request::{Conditions, Request as CoapRequest};
pub(crate) use hallsweep::inbound::coap::endpoint::response::Response as CoapResponse;
pub(crate) use hallsweep::inbound::coap::{Application, Resources, Said};
pub(crate) use hallsweep::inbound::http::{Door, Hosts, coming_from, router};
pub(crate) use hallsweep::inbound::mqtt::news::News;
pub(crate) use hallsweep::inbound::mqtt::orders::{ANSWERS, Answer, Heard, Orders, Sender, Taken};
pub(crate) use hallsweep::inbound::mqtt::publication::Publication;
pub(crate) use hallsweep::inbound::mqtt::qak::outgoing as qak;
pub(crate) use hallsweep::inbound::mqtt::topics::Topics;
pub(crate) use hallsweep::outbound::robot::sim::{Camera, Hall, SimSettings, Truth};
pub(crate) use hallsweep::outbound::store::memory::Memory;
pub(crate) use hallsweep::runtime::archive::Archive;
pub(crate) use hallsweep::runtime::archive_reader::Reader;
pub(crate) use hallsweep::runtime::halt::Halter;
pub(crate) use hallsweep::runtime::handle::{COMMANDS, Envelope, Handle};
pub(crate) use hallsweep::runtime::store::Store;
pub(crate) use hallsweep::wire::changes::ChangesJson;
pub(crate) use hallsweep::wire::journal::{self, Picture};
pub(crate) use hallsweep::wire::map::MapJson;
pub(crate) use hallsweep::wire::problem::{ProblemJson, status_of};
pub(crate) use hallsweep::wire::state::{self, StateJson};
pub(crate) use hallsweep::wire::{cbor, concise_problem, journal_words, map_text, old_items, senml, text};
