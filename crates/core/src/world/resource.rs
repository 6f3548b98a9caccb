//! The one list of what has a revision of its own. How each is written, and where it is found, is the doors' business.

named! {
    ALL by name;
    /// Something with a revision of its own.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Resource {
        /// Phase, holds, goal, strategy, epoch, progress.
        Mission = "mission",
        /// State, heading, position, sonar, LED of the robot.
        Robot = "robot",
        /// The hall map.
        Map = "map",
        /// The luggage records.
        Luggage = "luggage",
        /// Temperature and threshold.
        Temperature = "temperature",
        /// The alarms.
        Alarms = "alarms",
        /// What is fetched, and the trees at work.
        Retrieval = "retrieval",
        /// The latest log lines.
        Log = "log",
    }
}

impl Resource {
    /// How many there are.
    pub const COUNT: usize = Resource::ALL.len();
}
