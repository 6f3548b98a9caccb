//! The one list of the parts of the state that have a revision of their own. The doors decide the form and the path of
//! each part.

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Resource {
        /// Phase, holds, goal, strategy, epoch, progress.
        Mission = "mission",
        /// State, heading, position, sonar, LED of the robot.
        Robot = "robot",
        Map = "map",
        Luggage = "luggage",
        Temperature = "temperature",
        Alarms = "alarms",
        /// The piece being fetched, and the trees at work.
        Retrieval = "retrieval",
        Log = "log",
    }
}

impl Resource {
    pub const COUNT: usize = Resource::ALL.len();
}
