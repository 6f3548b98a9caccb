//! `hallsweep token`: shows, adds, replaces and removes keys in the data folder. A running hallsweep applies the changes.

use clap::{Args, Subcommand, ValueEnum};

use super::{Failure, Folder, link};
use crate::access::{self, AccessError, Key, KeyFile, Keys, Role};
use crate::config::{Flag, HttpSettings, Settings, Sources};
use hallsweep_core::hall::HallId;

/// The subcommands of `hallsweep token`, and their common flags.
#[derive(Args, Clone, Debug)]
pub struct Keyrings {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    folder: Folder,
    /// Address of hallsweep in the links.
    #[arg(long, value_name = "ADDRESS:PORT", global = true)]
    http: Option<String>,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Show every key with its role, its halls if it is limited to some, its token and a link to sign in (the default).
    Show,
    /// Give a key a new token for the same role and halls: the old token, and all sign-ins with it, become invalid.
    Rotate {
        /// The name of the key.
        name: String,
    },
    /// Make a key.
    Add {
        /// Name of the key: 1 to 32 letters, digits, - and _.
        name: String,
        /// Role of the key.
        #[arg(long, value_enum)]
        role: RoleArgument,
        /// The only halls that the key sees; without this flag, the key sees all halls. To change the halls of a key,
        /// remove the key and add it again.
        #[arg(long, value_name = "HALL,HALL", value_delimiter = ',')]
        halls: Option<Vec<String>>,
    },
    /// Remove a key; the last key of an operator for all halls cannot be removed.
    Remove {
        /// The name of the key.
        name: String,
    },
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RoleArgument {
    /// May see everything and stop the robot.
    Viewer,
    /// May see everything, stop the robot and give commands.
    Operator,
}

pub fn run(asked: &Keyrings) -> Result<(), Failure> {
    let settings = super::settings(&asked.sources())?;
    let file = file(&settings)?;
    // With the lock, the second of two simultaneous changes sees the result of the first.
    let _alone = file.alone();
    let kept = file.read()?;
    let is_new = kept.is_none();
    let what = asked.what.as_ref().unwrap_or(&What::Show);
    let mut keys = match (kept, what) {
        (Some(keys), _) => keys,
        // The first key file always has an operator's key, so that somebody can command the robot.
        (None, What::Add { .. }) => Keys::first()?,
        (None, What::Show | What::Rotate { .. } | What::Remove { .. }) => return Err(none_yet(&file)),
    };
    let said = match what {
        What::Show => shown(&settings.http, &file, keys.iter()),
        What::Add { name, role, halls } => {
            let key = add(&mut keys, name, *role, halls.as_deref())?.clone();
            file.write(&keys)?;
            let others = keys.iter().filter(|other| is_new && other.name != key.name);
            shown(&settings.http, &file, others.chain([&key]))
        }
        What::Rotate { name } => {
            let key = keys.rotate(name)?.clone();
            file.write(&keys)?;
            shown(&settings.http, &file, [&key].into_iter())
        }
        What::Remove { name } => {
            keys.remove(name)?;
            file.write(&keys)?;
            format!("The key `{name}` was removed; a running hallsweep does not accept it any more.")
        }
    };
    super::print(&said)
}

fn add<'a>(keys: &'a mut Keys, name: &str, role: RoleArgument, halls: Option<&[String]>) -> Result<&'a Key, AccessError> {
    let halls = halls.map(|halls| access::halls(halls.iter().map(String::as_str))).transpose()?;
    keys.add(name, role.role(), halls)
}

fn file(settings: &Settings) -> Result<KeyFile, Failure> {
    let folder = settings.store.as_deref().ok_or_else(|| {
        let said = "nothing is stored (store.folder = \"none\"), so keys exist only while hallsweep runs: name a folder with \
                    --data DIR";
        Failure::Run(said.to_owned())
    })?;
    Ok(KeyFile::within(folder))
}

/// The error when there is no key file. Of the subcommands of `hallsweep token`, only `add` creates the file.
fn none_yet(file: &KeyFile) -> Failure {
    let there = file.path().display();
    Failure::Run(format!(
        "there are no keys yet, because the file {there} does not exist: make a key with `hallsweep token add NAME --role \
         operator`, or start hallsweep with a setting that requires keys; if the file should exist, check --data and --config"
    ))
}

fn shown<'a>(http: &HttpSettings, file: &KeyFile, keys: impl Iterator<Item = &'a Key>) -> String {
    let key = |key: &Key| {
        let (name, role, token) = (&key.name, key.role.name(), key.token.reveal());
        let halls = key.halls.as_deref().map(|halls| halls.iter().map(HallId::name).collect::<Vec<_>>().join(", "));
        let halls = halls.map(|halls| format!(" of {halls}")).unwrap_or_default();
        format!("{name} ({role}{halls})\n  token  {token}\n  link   {}\n", link::sign_in(http, http.bind.at.first(), &key.token))
    };
    let keys: String = keys.map(key).collect();
    let asked = if http.asks_for_keys {
        ""
    } else {
        ", and required only beyond loopback, or with http.require_token = true or mqtt.require_password = true"
    };
    let whose =
        format!("The links use {}, the address in these settings: choose another address with --http or --config", http.bind.at);
    format!("{keys}The keys are stored in {}{asked}.\n{whose}.", file.path().display())
}

impl Keyrings {
    fn sources(&self) -> Sources {
        self.folder.sources(self.http.clone().map(|value| Flag::given("--http", value)))
    }
}

impl RoleArgument {
    const fn role(self) -> Role {
        match self {
            RoleArgument::Viewer => Role::Viewer,
            RoleArgument::Operator => Role::Operator,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::config::load;

    #[derive(Debug, Parser)]
    struct Typed {
        #[command(flatten)]
        asked: Keyrings,
    }

    /// The key that `hallsweep token add` makes from these words.
    fn added(words: &[&str]) -> Result<Key, String> {
        let words = ["token", "add", "lobby", "--role", "viewer"].iter().chain(words);
        let typed = Typed::try_parse_from(words).map_err(|error| error.to_string())?;
        let Some(What::Add { name, role, halls }) = typed.asked.what else { unreachable!("this is what is typed") };
        let mut keys = Keys::first().unwrap();
        let key = add(&mut keys, &name, role, halls.as_deref()).map_err(|error| error.to_string())?;
        Ok(key.clone())
    }

    #[test]
    fn the_halls_that_are_typed_are_shown_and_no_halls_are_all_halls() {
        let http = load(&Sources::default()).unwrap().http;
        let file = KeyFile::within(std::path::Path::new("data"));
        for (words, begins) in [
            (&[][..], "lobby (viewer)\n"),
            (&["--halls", "south"], "lobby (viewer of south)\n"),
            (&["--halls", "south,east"], "lobby (viewer of south, east)\n"),
            (&["--halls=south", "--halls", "east"], "lobby (viewer of south, east)\n"),
        ] {
            let key = added(words).unwrap();
            let said = shown(&http, &file, [&key].into_iter());
            assert!(said.starts_with(begins), "{words:?}: {said}");
        }
    }

    /// Safety A1: a mistake in the halls never makes a key for all halls.
    #[test]
    fn halls_that_are_none_make_no_key() {
        for (words, expect) in [
            (&["--halls", ""][..], "\"\" cannot be the name of a hall: use 1 to 32 small letters"),
            (&["--halls="], "\"\" cannot be the name of a hall"),
            (&["--halls", ","], "\"\" cannot be the name of a hall"),
            (&["--halls", "south,"], "\"\" cannot be the name of a hall"),
            (&["--halls", "south, east"], "\" east\" cannot be the name of a hall"),
            (&["--halls", "South"], "\"South\" cannot be"),
            (&["--halls", "south,south"], "the hall `south` is named twice"),
            (&["--halls"], "a value is required"),
            (&["--halls", "south", "east"], "unexpected argument"),
        ] {
            let said = added(words).unwrap_err();
            assert!(said.contains(expect), "{words:?}: {said}");
        }
    }
}
