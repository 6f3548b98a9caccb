//! The core: what hallsweep knows and decides. It uses no clock, no I/O, no thread and no channel. `now` is an
//! argument.
//!
//! Every layer has the same methods. `handle_command`, `handle_event` and `handle_timeout` take inputs.
//! `poll_effect` and `poll_timeout` return the results.

/// Declares an enum with one fixed word for each variant. With `ALL` in front, the macro also declares the list of
/// all variants in their order.
macro_rules! named {
    (ALL by $by:ident; $(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)* }) => {
        named! { by $by; $(#[$meta])* $vis enum $name { $($(#[$doc])* $variant = $word,)* } }

        impl $name {
            $vis const ALL: [$name; [$($word),*].len()] = [$($name::$variant),*];
        }
    };
    (by $by:ident; $(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)* }) => {
        $(#[$meta])*
        $vis enum $name {
            $($(#[$doc])* $variant,)*
        }

        impl $name {
            #[must_use]
            $vis const fn $by(self) -> &'static str {
                match self {
                    $($name::$variant => $word,)*
                }
            }
        }
    };
}

pub mod effect;
pub mod engine;
pub mod mission;
pub mod retrieval;
pub mod rng;
pub mod search;
pub mod settings;
pub mod snapshot;
pub mod state;
mod vocabulary;
pub mod world;

pub use vocabulary::{
    arm, asked, bomb_size, closing, command, event, hall, hand_over, hold, not_fetched, pair, phase, place, refused, robot,
    simulated, speed, units, words,
};
