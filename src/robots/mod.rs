//! Robots, one folder a vendor. The simulated robot is a vendor like any other: it has a body, sensors and a camera, and it
//! knows nothing of missions.

pub mod sim;
