//! The order in which a hall is searched: one file a strategy, behind one enum, and the planner under them.
//! A strategy looks at a view and returns a decision; it performs nothing.

/// The ways to search a hall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// The seeds' *chiocciola*: growing squares, home after each.
    #[default]
    Snail,
}

impl Strategy {
    /// All of them.
    pub const ALL: [Strategy; 1] = [Strategy::Snail];

    /// The word of the doors.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Strategy::Snail => "snail",
        }
    }

    /// The strategy of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Strategy> {
        Strategy::ALL.into_iter().find(|strategy| strategy.name() == name)
    }
}
