//! Kinds of values and their units (docs/src/reference/language.md, 2.4 and 6.2).

/// Kind of a parameter's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ParameterKind {
    /// A length in metres.
    Length,
    /// A speed in metres per second.
    Speed,
    /// An angle in degrees or radians; a conversion between the two is never exact.
    Angle,
    /// A turn rate in radians or degrees per second.
    AngularRate,
    /// A time in seconds.
    Time,
    /// A voltage in volts.
    Voltage,
    /// A frequency in hertz. It has a unit, but no parameter has this kind yet.
    Frequency,
    /// A number without a unit.
    Number,
    /// A whole number without a unit.
    Integer,
    /// A number of passes: a positive whole number, or `inf`.
    Count,
    /// A word with this number of bits.
    Bits(u32),
    /// The number of a sonar, from 0 to 15.
    Sonar,
    /// A robot's name.
    Robot,
    /// A module's name.
    Module,
    /// The path of a file or the name of a stored path.
    File,
}

impl ParameterKind {
    /// Names of all kinds in an alphabet, except `bits`, which needs a length.
    pub const NAMES: &[&str] = &[
        "length",
        "speed",
        "angle",
        "angular_rate",
        "time",
        "voltage",
        "number",
        "integer",
        "count",
        "sonar",
        "robot",
        "module",
        "file",
    ];

    /// Returns the kind with this name in an alphabet; `None` if the name is not in [`ParameterKind::NAMES`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "length" => Self::Length,
            "speed" => Self::Speed,
            "angle" => Self::Angle,
            "angular_rate" => Self::AngularRate,
            "time" => Self::Time,
            "voltage" => Self::Voltage,
            "number" => Self::Number,
            "integer" => Self::Integer,
            "count" => Self::Count,
            "sonar" => Self::Sonar,
            "robot" => Self::Robot,
            "module" => Self::Module,
            "file" => Self::File,
            _ => return None,
        })
    }

    /// Returns the name of the kind in words, with an article, such as "an angle".
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Length => "a length".into(),
            Self::Speed => "a speed".into(),
            Self::Angle => "an angle".into(),
            Self::AngularRate => "a turn rate".into(),
            Self::Time => "a time".into(),
            Self::Voltage => "a voltage".into(),
            Self::Frequency => "a frequency".into(),
            Self::Number => "a number".into(),
            Self::Integer => "a whole number".into(),
            Self::Count => "a count".into(),
            Self::Bits(length) => format!("{length} bits"),
            Self::Sonar => "a sonar, 0 to 15".into(),
            Self::Robot => "the name of a robot".into(),
            Self::Module => "the name of a module".into(),
            Self::File => "the name of a file".into(),
        }
    }

    /// Returns `true` if different texts always mean different values of the kind, because values are not rounded and
    /// no value has two names.
    #[must_use]
    pub fn is_discrete(self) -> bool {
        match self {
            Self::Integer | Self::Count | Self::Bits(_) | Self::Sonar | Self::Robot | Self::Module => true,
            Self::Length | Self::Speed | Self::Angle | Self::AngularRate | Self::Time | Self::Voltage => false,
            Self::Frequency | Self::Number | Self::File => false,
        }
    }

    /// Returns the SI unit in which robots compute with values of the kind; `None` if the kind has no unit.
    #[must_use]
    pub fn base_unit(self) -> Option<Unit> {
        Unit::ALL.iter().copied().find(|unit| unit.kind == self && unit.is_base)
    }
}

/// Returns `true` if a law with this name and with arguments of these kinds may depend on the direction of its frame,
/// because it takes an angle, or a file or a module that may contain angles. The exception is `turn`, whose angle is
/// relative to the heading at which the atom began.
pub fn has_direction(law: &str, mut kinds: impl Iterator<Item = ParameterKind>) -> bool {
    // The angle of `turn` is relative to the heading at which its atom began.
    law != "turn"
        && kinds.any(|kind| match kind {
            ParameterKind::Angle | ParameterKind::File | ParameterKind::Module => true,
            ParameterKind::Length
            | ParameterKind::Speed
            | ParameterKind::AngularRate
            | ParameterKind::Time
            | ParameterKind::Voltage
            | ParameterKind::Frequency
            | ParameterKind::Number
            | ParameterKind::Integer
            | ParameterKind::Count
            | ParameterKind::Bits(_)
            | ParameterKind::Sonar
            | ParameterKind::Robot => false,
        })
}

/// A unit that may directly follow a number, as in `20cm`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Unit {
    /// Name of the unit as it is written.
    pub name: &'static str,
    /// Kind of quantity that the unit measures.
    pub kind: ParameterKind,
    /// Factor of the exact conversion to the family's unit: one of this unit equals `factor` · 10^`exponent` of the
    /// family's unit.
    pub factor: u32,
    /// Exponent of ten in the exact conversion to the family's unit.
    pub exponent: i32,
    /// Name of the unit in which exact values of this unit's family are compared. Degrees and radians belong to
    /// different families.
    pub family: &'static str,
    /// `true` if this unit is the SI unit in which robots compute.
    pub is_base: bool,
}

impl Unit {
    /// All units.
    pub const ALL: &[Self] = &[
        Self::new("m", ParameterKind::Length, 1, 0, "m"),
        Self::new("cm", ParameterKind::Length, 1, -2, "m"),
        Self::new("mm", ParameterKind::Length, 1, -3, "m"),
        Self::new("in", ParameterKind::Length, 254, -4, "m"),
        Self::new("ft", ParameterKind::Length, 3048, -4, "m"),
        Self::new("m/s", ParameterKind::Speed, 1, 0, "m/s"),
        Self::new("cm/s", ParameterKind::Speed, 1, -2, "m/s"),
        Self::new("mm/s", ParameterKind::Speed, 1, -3, "m/s"),
        Self::new("in/s", ParameterKind::Speed, 254, -4, "m/s"),
        Self::new("rad", ParameterKind::Angle, 1, 0, "rad"),
        Self::new("deg", ParameterKind::Angle, 1, 0, "deg"),
        Self::new("rad/s", ParameterKind::AngularRate, 1, 0, "rad/s"),
        Self::new("deg/s", ParameterKind::AngularRate, 1, 0, "deg/s"),
        Self::new("s", ParameterKind::Time, 1, 0, "s"),
        Self::new("ms", ParameterKind::Time, 1, -3, "s"),
        Self::new("min", ParameterKind::Time, 60, 0, "s"),
        Self::new("h", ParameterKind::Time, 3600, 0, "s"),
        Self::new("V", ParameterKind::Voltage, 1, 0, "V"),
        Self::new("Hz", ParameterKind::Frequency, 1, 0, "Hz"),
    ];

    /// Returns the unit with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|unit| unit.name == name)
    }

    /// Returns `true` if a unit has this name.
    #[must_use]
    pub fn is_name(name: &str) -> bool {
        Self::ALL.iter().any(|unit| unit.name == name)
    }

    /// Returns the factor from the family's unit to SI: 1, or π/180 if the family's unit is the degree.
    #[must_use]
    pub fn family_to_si(self) -> f64 {
        family_to_si(self.family)
    }

    /// Converts a value in this unit to SI.
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        let tens = (0..self.exponent.unsigned_abs()).fold(1.0, |tens, _| tens * 10.0);
        let value = value * f64::from(self.factor) * self.family_to_si();
        if self.exponent < 0 { value / tens } else { value * tens }
    }

    const fn new(name: &'static str, kind: ParameterKind, factor: u32, exponent: i32, family: &'static str) -> Self {
        let is_base = factor == 1 && exponent == 0 && !matches!(family.as_bytes(), [b'd', ..]);
        Self { name, kind, factor, exponent, family, is_base }
    }
}

/// Returns the factor from the unit `family` to SI: 1, or π/180 if the family's unit is the degree.
#[must_use]
pub fn family_to_si(family: &str) -> f64 {
    if family.starts_with("deg") { std::f64::consts::PI / 180.0 } else { 1.0 }
}
