//! The faults that can be requested for a run of the pallet scenario. Command line and addresses use the same names.

use std::fmt;
use std::str::FromStr;

use super::run::{Asked, PalletRun};
use super::yard::MOST_PARCELS;
use hallsweep_sim::pair::Slip;

/// Number of steps before a parcel slips, if its loss was requested. On most ways, the slip is then far from both
/// ends of the way.
const LOST_AFTER: u32 = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// The parcel slips out of the grippers while it is carried.
    Lost,
    LostLifting,
    /// The first look does not recognise the parcel.
    Unrecognised,
    /// After the parcel has been lifted, the way into the target area is closed permanently.
    Blocked,
    Jammed,
    /// The operator never comes, during the whole run.
    Absent,
}

impl Mishap {
    /// All faults, in the order in which users see them.
    pub const ALL: [Mishap; 6] =
        [Mishap::Lost, Mishap::LostLifting, Mishap::Unrecognised, Mishap::Blocked, Mishap::Jammed, Mishap::Absent];

    pub const fn name(self) -> &'static str {
        match self {
            Mishap::Lost => "lost",
            Mishap::LostLifting => "lostLifting",
            Mishap::Unrecognised => "unrecognised",
            Mishap::Blocked => "blocked",
            Mishap::Jammed => "jammed",
            Mishap::Absent => "absent",
        }
    }

    pub const fn at(self, parcel: u32) -> AskedFault {
        AskedFault { mishap: self, parcel }
    }
}

/// A requested fault and the number of its parcel. It is written `NAME` or `NAME@PARCEL`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AskedFault {
    pub mishap: Mishap,
    /// Number of the parcel, counted from 1. A fault of the whole run has 1.
    pub parcel: u32,
}

/// Why a requested fault cannot be read. The message does not contain the faulty text, so the caller must write that
/// text before the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    #[error("this mishap is unknown: use lost, lostLifting, unrecognised, blocked, jammed or absent")]
    Unknown,
    #[error("absent concerns the whole run and has no parcel number")]
    OfTheWholeRun,
    #[error("the number of a parcel is 1 to {MOST_PARCELS}")]
    NoParcel,
}

/// A fault was requested for a parcel that this run does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BeyondError {
    pub parcel: u32,
}

impl FromStr for Mishap {
    type Err = FaultError;

    fn from_str(name: &str) -> Result<Mishap, FaultError> {
        Mishap::ALL.into_iter().find(|mishap| mishap.name() == name).ok_or(FaultError::Unknown)
    }
}

impl FromStr for AskedFault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<AskedFault, FaultError> {
        let (name, parcel) = text.split_once('@').unwrap_or((text, "1"));
        let mishap: Mishap = name.parse()?;
        if mishap == Mishap::Absent && text.contains('@') {
            return Err(FaultError::OfTheWholeRun);
        }
        Ok(mishap.at(parcel_number(parcel)?))
    }
}

impl fmt::Display for AskedFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.mishap {
            Mishap::Absent => f.write_str(self.mishap.name()),
            Mishap::Lost | Mishap::LostLifting | Mishap::Unrecognised | Mishap::Blocked | Mishap::Jammed => {
                write!(f, "{}@{}", self.mishap.name(), self.parcel)
            }
        }
    }
}

/// Reads the number of a parcel, or a count of parcels. Both must be from 1 to `MOST_PARCELS`.
pub fn parcel_number(text: &str) -> Result<u32, FaultError> {
    text.parse().ok().filter(|number| (1..=MOST_PARCELS).contains(number)).ok_or(FaultError::NoParcel)
}

/// Turns the requested faults into the settings of a run.
///
/// # Errors
/// When a fault is requested for a parcel after the last one.
pub fn asked(parcels: u32, faults: &[AskedFault]) -> Result<Asked, BeyondError> {
    let mut asked = Asked::default();
    for AskedFault { mishap, parcel } in faults.iter().copied() {
        if parcel > parcels {
            return Err(BeyondError { parcel });
        }
        match mishap {
            Mishap::Lost => asked.mishaps.slips.push(Slip { parcel, after_steps: LOST_AFTER }),
            Mishap::LostLifting => asked.mishaps.slips.push(Slip { parcel, after_steps: 0 }),
            Mishap::Unrecognised => asked.mishaps.unrecognised.push(parcel),
            Mishap::Jammed => asked.mishaps.jams.push(parcel),
            Mishap::Blocked => asked.blocked.push(parcel),
            Mishap::Absent => asked.absent = true,
        }
    }
    Ok(asked)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missed {
    /// The operator was never called, so nobody noticed that the operator was absent.
    NobodyCalled,
    RunEnded,
}

impl Missed {
    pub const ALL: [Missed; 2] = [Missed::NobodyCalled, Missed::RunEnded];

    pub const fn name(self) -> &'static str {
        match self {
            Missed::NobodyCalled => "nobodyCalled",
            Missed::RunEnded => "runEnded",
        }
    }

    pub const fn in_words(self) -> &'static str {
        match self {
            Missed::NobodyCalled => "the operator was never called",
            Missed::RunEnded => "the run ended earlier",
        }
    }
}

/// The requested faults that did not happen during a finished run, each with the reason.
pub fn missed(faults: &[AskedFault], run: &PalletRun) -> Vec<(AskedFault, Missed)> {
    let mut left = run.not_happened();
    let mut is_left = |AskedFault { mishap, parcel }: &AskedFault| match mishap {
        Mishap::Lost => take(&mut left.mishaps.slips, Slip { parcel: *parcel, after_steps: LOST_AFTER }),
        Mishap::LostLifting => take(&mut left.mishaps.slips, Slip { parcel: *parcel, after_steps: 0 }),
        Mishap::Unrecognised => take(&mut left.mishaps.unrecognised, *parcel),
        Mishap::Jammed => take(&mut left.mishaps.jams, *parcel),
        Mishap::Blocked => take(&mut left.blocked, *parcel),
        Mishap::Absent => left.absent,
    };
    let why = |mishap| if mishap == Mishap::Absent { Missed::NobodyCalled } else { Missed::RunEnded };
    faults.iter().filter(|fault| is_left(fault)).map(|fault| (*fault, why(fault.mishap))).collect()
}

fn take<T: PartialEq>(list: &mut Vec<T>, wanted: T) -> bool {
    list.iter().position(|item| *item == wanted).map(|index| list.remove(index)).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_go_wrong_is_read_by_name_and_parcel_and_written_the_same() {
        assert_eq!("lost@2".parse(), Ok(Mishap::Lost.at(2)));
        assert_eq!("unrecognised".parse(), Ok(Mishap::Unrecognised.at(1)));
        for mishap in Mishap::ALL {
            let fault: AskedFault = mishap.name().parse().unwrap();
            assert_eq!(fault.to_string().parse(), Ok(fault));
            assert!(FaultError::Unknown.to_string().contains(mishap.name()), "{mishap:?} is named to those who mistype");
        }
        for wrong in ["", "gone", "Lost", "lost@", "lost@0", "lost@25", "lost@x", "lost@1@2", "absent@1"] {
            assert!(wrong.parse::<AskedFault>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn nothing_can_go_wrong_at_a_parcel_that_is_not_there() {
        assert_eq!(asked(1, &[Mishap::Lost.at(2)]), Err(BeyondError { parcel: 2 }));
        let told =
            asked(2, &[Mishap::Lost.at(2), Mishap::LostLifting.at(1), Mishap::Blocked.at(2), Mishap::Absent.at(1)]).unwrap();
        assert_eq!(told.mishaps.slips, [Slip { parcel: 2, after_steps: LOST_AFTER }, Slip { parcel: 1, after_steps: 0 }]);
        assert_eq!((told.blocked, told.absent), (vec![2], true));
    }
}
