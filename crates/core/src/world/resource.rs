//! The one list of what has a revision of its own. How each is written, and where it is found, is the doors' business.

/// Something with a revision of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Resource {
    /// Phase, holds, goal, strategy, epoch, progress.
    Mission,
    /// State, heading, position, sonar, LED of the robot.
    Robot,
    /// The hall map.
    Map,
    /// The luggage records.
    Luggage,
    /// Temperature and threshold.
    Temperature,
    /// The alarms.
    Alarms,
    /// The latest log lines.
    Log,
}

impl Resource {
    /// How many there are.
    pub const COUNT: usize = 7;

    /// All of them.
    pub const ALL: [Resource; Resource::COUNT] = [
        Resource::Mission,
        Resource::Robot,
        Resource::Map,
        Resource::Luggage,
        Resource::Temperature,
        Resource::Alarms,
        Resource::Log,
    ];
}
