//! The list of all parts of the state that have their own revision. Each interface decides the form and the path of
//! each part.

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Resource {
        /// Phase, holds, goal, strategy, epoch and progress.
        Mission = "mission",
        /// State, heading, position, sonar and LED of the robot.
        Robot = "robot",
        Map = "map",
        /// How far the hall and its areas have been searched.
        Coverage = "coverage",
        Luggage = "luggage",
        Temperature = "temperature",
        Alarms = "alarms",
        /// The piece being fetched, and the behaviour trees at work.
        Retrieval = "retrieval",
        Log = "log",
    }
}

impl Resource {
    pub const COUNT: usize = Resource::ALL.len();
}
