//! Checks the sound sources of a world file, and the reverberation of its room.

use mdle_sound::{SoundKind, SoundRoom, SoundSource};
use toml::Spanned;

use super::Wrong;
use super::outlines::Unit;
use super::text::{SoundText, TomlTable};
use crate::point::Point;

/// Default level of a source, in dB.
const LEVEL: f64 = 10.0;
/// Minimum and maximum level, in dB.
const LEVELS: (f64, f64) = (-40.0, 80.0);
/// Maximum number of sources. It is limited because each source requires a convolution in each turn.
const MOST: usize = 8;
/// Kinds of sound.
const KINDS: [(&str, SoundKind); 2] = [("white", SoundKind::White), ("speech", SoundKind::Speech)];

impl Unit {
    /// Reads the sound sources.
    pub(super) fn sounds(self, written: &[Spanned<TomlTable<SoundText>>]) -> Result<Vec<SoundSource>, Wrong> {
        if let Some(text) = written.get(MOST) {
            return Err(Wrong::at(text, format!("more than {MOST} sources of sound")));
        }
        written.iter().map(|text| self.sound(&text.get_ref().0)).collect()
    }

    fn sound(self, SoundText { at, kind, level }: &SoundText) -> Result<SoundSource, Wrong> {
        let Point { x, y } = self.pair(at, "`at`")?;
        let found = kind.as_ref().map_or(Some(SoundKind::White), |kind| {
            KINDS.iter().find(|(name, _)| name == kind.get_ref()).map(|(_, kind)| *kind)
        });
        let kind = match (found, kind) {
            (Some(found), _) => found,
            (None, None) => SoundKind::White,
            (None, Some(kind)) => {
                let what = format!("{:?} is no kind of sound; expected `white` or `speech`", kind.get_ref());
                return Err(Wrong::at(kind, what));
            }
        };
        let level = match level {
            Some(level) if !(LEVELS.0..=LEVELS.1).contains(level.get_ref()) => {
                let what = format!("a level is from {} to {} dB over the noise of a microphone", LEVELS.0, LEVELS.1);
                return Err(Wrong::at(level, what));
            }
            Some(level) => *level.get_ref(),
            None => LEVEL,
        };
        Ok(SoundSource { at: (x, y), kind, level })
    }
}

/// Reads the reverberation time of the room, in seconds.
pub(super) fn t60(written: Option<&Spanned<f64>>) -> Result<f64, Wrong> {
    match written {
        Some(t60) if !(0.0..=SoundRoom::T60_MOST).contains(t60.get_ref()) => {
            let most = SoundRoom::T60_MOST;
            Err(Wrong::at(t60, format!("a reverberation time is from 0 (nothing reflects sound) to {most} s")))
        }
        Some(t60) => Ok(*t60.get_ref()),
        None => Ok(0.0),
    }
}
