//! The two roles, and the rights that routes and commands need. The tables of the doors (HTTP, CoAP, MQTT) say which
//! right each route or command needs.

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// May see everything and stop the robot.
    Viewer,
    /// May see everything, stop the robot and give commands.
    Operator,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Need {
    /// No right is needed: everybody who can connect has access.
    Nothing,
    /// The right to look: anyone signed in has it.
    See,
    /// The right to halt the robot: anyone signed in has it. Separate from `See`, because halting must never become harder than
    /// looking.
    Stop,
    /// The right to do anything else: only an operator has it.
    Act,
}

impl Role {
    pub const ALL: [Role; 2] = [Role::Viewer, Role::Operator];

    /// The word for files, pages and the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Role::Viewer => "viewer",
            Role::Operator => "operator",
        }
    }

    pub const fn may(self, need: Need) -> bool {
        match need {
            Need::Nothing | Need::See | Need::Stop => true,
            Need::Act => matches!(self, Role::Operator),
        }
    }
}

impl Need {
    pub const fn in_words(self) -> &'static str {
        match self {
            Need::Nothing => "anybody",
            Need::See | Need::Stop => "anyone signed in",
            Need::Act => "operator",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A1.
    #[test]
    fn anyone_signed_in_may_look_and_stop_and_only_an_operator_may_act() {
        for role in Role::ALL {
            assert!(role.may(Need::Nothing) && role.may(Need::See) && role.may(Need::Stop), "{role:?}");
        }
        assert!(Role::Operator.may(Need::Act) && !Role::Viewer.may(Need::Act));
    }
}
