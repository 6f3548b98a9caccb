//! Every name of the program that the recorder uses, in one place: where modules move or are renamed, only this file follows.

pub(crate) use coap_endpoint::{Code, Conditions, Format, Method, Request as CoapRequest, Response as CoapResponse};
pub(crate) use hallsweep::access::{Access, Caller, Key, Keyring, Keys, OPERATOR, Role, Token};
pub(crate) use hallsweep::api::changes::ChangesJson;
pub(crate) use hallsweep::api::journal::{self, Picture};
pub(crate) use hallsweep::api::map::MapJson;
pub(crate) use hallsweep::api::problem::{ProblemJson, ProblemKind};
pub(crate) use hallsweep::api::resources::ResourceKind;
pub(crate) use hallsweep::api::state::{self, StateJson};
pub(crate) use hallsweep::api::{cbor, concise_problem, journal_words, map_text, old_items, senml, text};
pub(crate) use hallsweep::doors::coap::{Application, Reply, Resources};
pub(crate) use hallsweep::doors::http::{Hosts, HttpDoor, coming_from, router};
pub(crate) use hallsweep::doors::mqtt::change_feed::ChangeFeed;
pub(crate) use hallsweep::doors::mqtt::commands::{ANSWERS, Commands, IncomingMessage, Publisher, ResultMessage, Taken};
pub(crate) use hallsweep::doors::mqtt::publication::Publication;
pub(crate) use hallsweep::doors::mqtt::qak::outgoing as qak;
pub(crate) use hallsweep::doors::mqtt::topics::Topics;
pub(crate) use hallsweep::runtime::archive_reader::ArchiveReader;
pub(crate) use hallsweep::runtime::halt::Halter;
pub(crate) use hallsweep::runtime::handle::{COMMANDS, Envelope, Handle};
pub(crate) use hallsweep::runtime::store::Store;
pub(crate) use hallsweep::storage::sqlite::MemoryStore;
pub(crate) use hallsweep_core::command::Strategy;
pub(crate) use hallsweep_core::command::{
    CODES, Command, CommandId, LuggageRef, Refusal, RefusalKind, Refused, TemperatureReport, Verdict,
};
pub(crate) use hallsweep_core::effect::{Entry, Fact, Page};
pub(crate) use hallsweep_core::event::{Event, RobotEvent, RobotId};
pub(crate) use hallsweep_core::hold::Hold;
pub(crate) use hallsweep_core::phase::PhaseName;
pub(crate) use hallsweep_core::place::Place;
pub(crate) use hallsweep_core::rng::RandomStream;
pub(crate) use hallsweep_core::settings::Settings;
pub(crate) use hallsweep_core::snapshot::Snapshot;
pub(crate) use hallsweep_core::state::Participant;
pub(crate) use hallsweep_core::units::{AlarmId, Cell, Epoch, LuggageId, MissionId, Revision, Seq};
pub(crate) use hallsweep_core::world::resource::Resource;
pub(crate) use hallsweep_sim::headless::Run;
pub(crate) use hallsweep_sim::pair::{PairSettings, Slip};
pub(crate) use hallsweep_sim::{Camera, Hall, SimSettings, Truth};
