//! Faults that a user can request for an emulated robot. Faults of the line do not depend on the robot's protocol; the
//! others are faults of the robot's body.

use std::fmt;
use std::mem::discriminant;
use std::str::FromStr;
use std::time::Duration;

use mdle_host::Quantity;

/// The latest time at which a fault can begin.
const LATEST: Duration = Duration::from_secs(1_000_000);
/// Maximum value of a fault's number, which is a number of noise bytes or of milliseconds.
const MOST: u32 = 60_000;

/// A fault of the line or of the robot's body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// This number of random bytes precedes each frame.
    Noise(u32),
    /// Frames arrive byte by byte.
    Dribble,
    /// One bit of each frame is inverted.
    Check,
    /// Two of three frames are lost.
    Lose,
    /// Each frame is sent twice.
    Double,
    /// Each frame arrives late by this number of milliseconds.
    Late(u32),
    /// No frame arrives, because the line from the robot is cut.
    Silence,
    /// The line is closed.
    Close,
    /// The robot's body has this fault.
    Body(Ailment),
}

/// A fault of the robot's body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ailment {
    /// The robot receives nothing, because the line to it is cut.
    Deaf,
    /// The robot keeps its speed: it ignores all commands, and its watchdog does not stop it.
    Runaway,
    /// The right wheels do not move.
    StuckWheel,
    /// The sonar at the front receives no echo.
    DeadSonar,
    /// The first bumper is in contact.
    Bumper,
    /// The emergency stop is pressed.
    Emergency,
    /// The battery is low.
    LowBattery,
    /// The charger is plugged in.
    PluggedIn,
    /// Each frame contains filler bytes, which a reader must skip.
    Filler,
    /// The robot repeats the same report again and again.
    Hang,
    /// The sonars no longer ping.
    NoPings,
    /// The robot no longer reports its bumpers.
    NoBumpers,
    /// The robot no longer reports the distance that it has driven.
    NoTranslation,
    /// The robot no longer reports the angle by which it has turned.
    NoRotation,
    /// The robot no longer answers requests about its brake and battery.
    NoStatus,
    /// Each reported position is metres away from the previous position.
    Leap,
}

/// Name of each fault in the option `--fault`. A fault with a number has its default number here.
const KINDS: [(&str, Fault); 24] = [
    ("noise", Fault::Noise(3)),
    ("dribble", Fault::Dribble),
    ("check", Fault::Check),
    ("lose", Fault::Lose),
    ("double", Fault::Double),
    ("late", Fault::Late(250)),
    ("silence", Fault::Silence),
    ("close", Fault::Close),
    ("deaf", Fault::Body(Ailment::Deaf)),
    ("runaway", Fault::Body(Ailment::Runaway)),
    ("stuck-wheel", Fault::Body(Ailment::StuckWheel)),
    ("dead-sonar", Fault::Body(Ailment::DeadSonar)),
    ("bumper", Fault::Body(Ailment::Bumper)),
    ("emergency", Fault::Body(Ailment::Emergency)),
    ("low-battery", Fault::Body(Ailment::LowBattery)),
    ("plugged-in", Fault::Body(Ailment::PluggedIn)),
    ("filler", Fault::Body(Ailment::Filler)),
    ("hang", Fault::Body(Ailment::Hang)),
    ("no-pings", Fault::Body(Ailment::NoPings)),
    ("no-bumpers", Fault::Body(Ailment::NoBumpers)),
    ("no-translation", Fault::Body(Ailment::NoTranslation)),
    ("no-rotation", Fault::Body(Ailment::NoRotation)),
    ("no-status", Fault::Body(Ailment::NoStatus)),
    ("leap", Fault::Body(Ailment::Leap)),
];

/// A fault, with the time at which it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScheduledFault {
    /// Fault that begins at `time`.
    pub fault: Fault,
    /// World time at which the fault begins, counted from the time when the robot was switched on.
    pub time: Duration,
}

impl Fault {
    /// Returns one fault of each kind, for all robots, with the default number of noise bytes or milliseconds of delay.
    #[cfg(feature = "trial")]
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        KINDS.into_iter().map(|(_, fault)| fault)
    }

    /// Returns the fault with the number in `text`, which replaces the default number; `None` if faults of this kind
    /// have no number, or if `text` is not a valid number.
    fn numbered(self, text: &str) -> Option<Self> {
        match self {
            Self::Noise(_) => text.parse().ok().filter(|number| *number <= MOST).map(Self::Noise),
            Self::Late(_) => milliseconds(text).map(Self::Late),
            Self::Dribble | Self::Check | Self::Lose | Self::Double | Self::Silence | Self::Close | Self::Body(_) => {
                None
            }
        }
    }
}

/// Parses a whole number of milliseconds up to [`MOST`]; the unit may be missing. Returns `None` if `text` is invalid.
fn milliseconds(text: &str) -> Option<u32> {
    let most = Duration::from_millis(u64::from(MOST));
    let time = Quantity::duration(text, "ms", Duration::ZERO, most).ok()?;
    u32::try_from(time.as_millis()).ok().filter(|_| time.subsec_nanos().is_multiple_of(1_000_000))
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_same = |fault: &Self| match (fault, self) {
            (Self::Body(known), Self::Body(ailment)) => known == ailment,
            (known, fault) => discriminant(known) == discriminant(fault),
        };
        let name = KINDS.iter().find(|(_, fault)| is_same(fault)).map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

impl FromStr for ScheduledFault {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (what, time) = text.split_once('@').unwrap_or((text, "0"));
        let (name, number) = what.split_once('=').map_or((what, None), |(name, number)| (name, Some(number)));
        let fault = KINDS.iter().find(|(known, _)| *known == name).map(|(_, fault)| *fault);
        let fault = fault.ok_or_else(|| format!("the faults are {}", KINDS.map(|(name, _)| name).join(", ")))?;
        let fault = match number {
            Some(number) => fault.numbered(number).ok_or_else(|| {
                format!(
                    "`{what}`: noise and late take a whole number up to {MOST}, as in `late=250@2`, and no other fault"
                )
            })?,
            None => fault,
        };
        let time = Quantity::duration(time, "s", Duration::ZERO, LATEST);
        let time = time.map_err(|sentence| format!("after the @: {sentence}"))?;
        Ok(Self { fault, time })
    }
}
