//! The two roles, and what each route or command asks of whoever comes. Which route asks what stands in the doors' tables.

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Sees everything, and may stop the robot.
    Viewer,
    /// Sees, stops and acts.
    Operator,
}

/// What must be so before a request is listened to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Need {
    /// Nothing: anybody who reaches the door.
    Nothing,
    /// To look: anyone signed in.
    See,
    /// To halt the robot: anyone signed in. A need of its own, because it is never to become harder than to look.
    Stop,
    /// To do anything else: an operator.
    Act,
}

impl Role {
    /// Every role, the lesser first.
    pub const ALL: [Role; 2] = [Role::Viewer, Role::Operator];

    /// The word for files, pages and the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Role::Viewer => "viewer",
            Role::Operator => "operator",
        }
    }

    /// Whether somebody of this role may do what asks for `need`.
    pub const fn may(self, need: Need) -> bool {
        match need {
            Need::Nothing | Need::See | Need::Stop => true,
            Need::Act => matches!(self, Role::Operator),
        }
    }
}

impl Need {
    /// Who meets it, in words for tables.
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
