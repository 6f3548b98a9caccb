//! `hallsweep token`: shows, adds, replaces and removes keys in the data folder. A running hallsweep applies the changes.

use clap::{Args, Subcommand, ValueEnum};

use super::{Failure, Folder, link};
use crate::access::{Key, KeyFile, Keys, Role};
use crate::config::{Flag, HttpSettings, Settings, Sources};

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
    /// Show every key with its role, its token and a link to sign in (the default).
    Show,
    /// Give a key a new token: the old token, and all sign-ins with it, become invalid.
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
    },
    /// Remove a key; the last key of an operator cannot be removed.
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
        What::Add { name, role } => {
            let key = keys.add(name, role.role())?.clone();
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
        format!("{name} ({role})\n  token  {token}\n  link   {}\n", link::sign_in(http, http.bind.at.first(), &key.token))
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
