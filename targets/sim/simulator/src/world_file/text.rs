//! The contents of a world file as written, before they are checked.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

/// A list of numbers: a position, a size, or a time with a position.
pub(super) type Numbers = Spanned<Vec<Spanned<f64>>>;

/// Contents of a world file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WorldText {
    pub(super) units: Option<Spanned<String>>,
    pub(super) rough: Option<Spanned<f64>>,
    pub(super) start: Option<Spanned<TomlTable<StartText>>>,
    pub(super) goal: Option<Spanned<TomlTable<GoalText>>>,
    pub(super) charger: Option<Spanned<TomlTable<ChargerText>>>,
    pub(super) t60: Option<Spanned<f64>>,
    #[serde(default, rename = "sound")]
    pub(super) sounds: Vec<Spanned<TomlTable<SoundText>>>,
    #[serde(default, rename = "wall")]
    pub(super) walls: Vec<TomlTable<WallText>>,
    #[serde(default, rename = "box")]
    pub(super) boxes: Vec<Spanned<TomlTable<BoxText>>>,
    #[serde(default, rename = "disc")]
    pub(super) discs: Vec<Spanned<TomlTable<DiscText>>>,
    #[serde(default, rename = "door")]
    pub(super) doors: Vec<TomlTable<DoorText>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StartText {
    pub(super) x: Option<Spanned<f64>>,
    pub(super) y: Option<Spanned<f64>>,
    pub(super) heading: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GoalText {
    pub(super) min: Numbers,
    pub(super) max: Numbers,
    pub(super) heading: Option<Spanned<f64>>,
    pub(super) tolerance: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ChargerText {
    pub(super) at: Numbers,
    pub(super) heading: Spanned<f64>,
    pub(super) reach: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SoundText {
    pub(super) at: Numbers,
    pub(super) kind: Option<Spanned<String>>,
    pub(super) level: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WallText {
    pub(super) name: Option<String>,
    pub(super) points: Spanned<Vec<Numbers>>,
    pub(super) rough: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxText {
    pub(super) name: Option<String>,
    pub(super) min: Option<Numbers>,
    pub(super) max: Option<Numbers>,
    pub(super) centre: Option<Numbers>,
    pub(super) size: Option<Numbers>,
    pub(super) rough: Option<Spanned<f64>>,
    pub(super) schedule: Option<Spanned<Vec<Numbers>>>,
    #[serde(default)]
    pub(super) repeat: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiscText {
    pub(super) name: Option<String>,
    pub(super) centre: Option<Numbers>,
    pub(super) radius: Spanned<f64>,
    pub(super) rough: Option<Spanned<f64>>,
    pub(super) schedule: Option<Spanned<Vec<Numbers>>>,
    #[serde(default)]
    pub(super) repeat: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DoorText {
    pub(super) name: Option<String>,
    pub(super) points: Spanned<Vec<Numbers>>,
    pub(super) open: Spanned<Vec<Numbers>>,
    pub(super) rough: Option<Spanned<f64>>,
    pub(super) every: Option<Spanned<f64>>,
}

/// A value that must be a table. Without this type, serde would also accept an array and ignore its surplus values.
pub(super) struct TomlTable<T>(pub(super) T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for TomlTable<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Keys(PhantomData))
    }
}

struct Keys<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Keys<T> {
    type Value = TomlTable<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<TomlTable<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(TomlTable)
    }
}
