//! What a robot is made of, as far as a mission cares: whoever wants something of a robot asks here whether it has what it takes.

/// One thing that a robot may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// It drives.
    Base,
    /// It takes photos.
    Camera,
    /// It measures how far it is to what is ahead.
    Sonar,
    /// It has a light that can blink.
    Led,
    /// It measures the temperature.
    Thermometer,
    /// It feels what it runs into.
    Bump,
    /// It reaches out.
    Arm,
    /// It takes hold of things.
    Gripper,
}

impl Part {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Part; 8] =
        [Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Thermometer, Part::Bump, Part::Arm, Part::Gripper];

    /// The word of the doors.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Part::Base => "base",
            Part::Camera => "camera",
            Part::Sonar => "sonar",
            Part::Led => "led",
            Part::Thermometer => "thermometer",
            Part::Bump => "bump",
            Part::Arm => "arm",
            Part::Gripper => "gripper",
        }
    }
}

/// A set of parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts(u16);

impl Parts {
    /// A round robot that searches: it drives, sees, measures and blinks.
    pub const ROUND_ROBOT: Parts = Parts::of(&[Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Thermometer, Part::Bump]);

    /// These.
    #[must_use]
    pub const fn of(parts: &[Part]) -> Parts {
        let (mut set, mut n) = (0, 0);
        while n < parts.len() {
            set |= 1 << parts[n] as u16;
            n += 1;
        }
        Parts(set)
    }

    /// Whether this is among them.
    #[must_use]
    pub const fn has(self, part: Part) -> bool {
        self.0 & (1 << part as u16) != 0
    }

    /// All that are in it, in the order of `Part::ALL`.
    pub fn iter(self) -> impl Iterator<Item = Part> {
        Part::ALL.into_iter().filter(move |part| self.has(*part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_what_was_put_into_it_and_nothing_else() {
        for part in Part::ALL {
            assert_eq!(Parts::of(&[part]).iter().collect::<Vec<_>>(), [part]);
        }
        assert!(!Parts::ROUND_ROBOT.has(Part::Gripper) && Parts::ROUND_ROBOT.has(Part::Camera));
    }
}
