//! Writes and reads the beginning of a record: the data of the run and of its plan, and the constant parts of the
//! robot's outputs.

use mdle_runtime::capability::Steering;
use mdle_runtime::{Meters, MetersPerSecond, Nanos, PathStore, Radians, Sensed, Setpoint, Shape, StoredPath};

use crate::bytes::{ByteReader, put_f64, put_text, put_u32, put_u64};

/// Data of a run that do not change while it runs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Begin {
    /// Version of the program that drove the robot.
    pub version: String,
    /// Name of the target.
    pub target: String,
    /// Name of the plan.
    pub plan: String,
    /// Shell command that repeats the run, without the options for writing a log.
    pub command: String,
    /// Period of a turn.
    pub period: Nanos,
    /// Name and text of each file of the plan, the plan's own file first. Empty for an executable, which does not
    /// contain the text of its plan.
    pub files: Vec<(String, String)>,
    /// Description of everything that influences the inputs in addition to the plan and the outputs, such as safety
    /// rules; empty if nothing else does.
    pub beside: String,
    /// Texts of the run's safety rules, `None` if there are none.
    pub safety: Option<SafetyTexts>,
}

/// Texts of safety rules.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SafetyTexts {
    /// Name of the safety file.
    pub name: String,
    /// Text of the safety file.
    pub text: String,
    /// Files of the plans to which rules divert the run, in the order of the rules. For each plan, its own file is
    /// first.
    pub plans: Vec<Vec<(String, String)>>,
}

/// Parts of a robot's outputs that never change in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// Constant measures of the body.
    pub shape: Shape,
    /// Paths that the plan can replay.
    pub paths: PathStore,
}

impl Begin {
    /// Value of [`Begin::beside`] in a record that begins in the middle of a run. The turns of such a record cannot be
    /// replayed.
    pub const MIDDLE: &str = "the run before it";

    /// Writes the beginning of a run whose first output is `y`, including the paths that the plan can replay.
    pub(crate) fn put(&self, y: &Sensed, to: &mut Vec<u8>) {
        for text in [&self.version, &self.target, &self.plan, &self.command, &self.beside] {
            put_text(to, text);
        }
        put_u64(to, self.period.0);
        put_files(&self.files, to);
        to.push(u8::from(self.safety.is_some()));
        if let Some(SafetyTexts { name, text, plans }) = &self.safety {
            put_text(to, name);
            put_text(to, text);
            put_u32(to, count(plans));
            plans.iter().for_each(|files| put_files(files, to));
        }
        put_shape(&y.shape, to);
        let paths: Vec<_> = y.paths.names().collect();
        put_u32(to, count(&paths));
        for name in paths {
            put_path(name, y.paths.path(name).unwrap_or_default(), to);
        }
    }

    /// Reads the beginning of a run. Its paths stay in memory until the program ends, as the paths that a plan replays
    /// do in a run.
    pub(crate) fn take(from: &mut ByteReader<'_>) -> Option<(Self, Constants)> {
        let [version, target, plan, command, beside] =
            [from.text()?, from.text()?, from.text()?, from.text()?, from.text()?];
        let period = from.nanos()?;
        let files = take_files(from)?;
        let safety = match from.u8()? {
            0 => None,
            _ => Some(SafetyTexts { name: from.text()?, text: from.text()?, plans: from.list(take_files)? }),
        };
        let shape = take_shape(from)?;
        let mut paths = from.list(take_path)?;
        paths.sort_by(|(one, _), (other, _)| one.cmp(other));
        let stored =
            paths.into_iter().map(|(name, setpoints)| StoredPath { name: name.leak(), setpoints: setpoints.leak() });
        let stored: Vec<_> = stored.collect();
        let paths = if stored.is_empty() { PathStore::EMPTY } else { PathStore::new(stored.leak()) };
        Some((Self { version, target, plan, command, period, files, beside, safety }, Constants { shape, paths }))
    }
}

/// Converts a number of items to the type in which a record stores it.
pub(crate) fn count<T>(items: &[T]) -> u32 {
    u32::try_from(items.len()).unwrap_or(u32::MAX)
}

/// Writes the names and texts of files.
pub(crate) fn put_files(files: &[(String, String)], to: &mut Vec<u8>) {
    put_u32(to, count(files));
    for (name, text) in files {
        put_text(to, name);
        put_text(to, text);
    }
}

/// Reads the names and texts of files.
pub(crate) fn take_files(from: &mut ByteReader<'_>) -> Option<Vec<(String, String)>> {
    from.list(|from| Some((from.text()?, from.text()?)))
}

/// Writes the name and the setpoints of a path.
pub(crate) fn put_path(name: &str, setpoints: &[Setpoint], to: &mut Vec<u8>) {
    put_text(to, name);
    put_u32(to, count(setpoints));
    for Setpoint { at, heading, speed } in setpoints {
        put_u64(to, at.0);
        put_f64(to, heading.0);
        put_f64(to, speed.0);
    }
}

/// Reads the name and the setpoints of a path.
pub(crate) fn take_path(from: &mut ByteReader<'_>) -> Option<(String, Vec<Setpoint>)> {
    let setpoint = |from: &mut ByteReader<'_>| {
        Some(Setpoint { at: from.nanos()?, heading: Radians(from.f64()?), speed: MetersPerSecond(from.f64()?) })
    };
    Some((from.text()?, from.list(setpoint)?))
}

fn put_shape(shape: &Shape, to: &mut Vec<u8>) {
    let Shape { body_radius, half_length, half_width, wheel_base, sonars_apart, ring_radius, confirmation, steering } =
        *shape;
    for Meters(length) in [body_radius, half_length, half_width, wheel_base, ring_radius] {
        put_f64(to, length);
    }
    to.push(u8::from(sonars_apart.is_some()));
    put_f64(to, sonars_apart.map_or(0.0, |apart| apart.0));
    put_u64(to, confirmation as u64);
    for gain in [steering.rotate, steering.align, steering.avoid] {
        put_f64(to, gain);
    }
}

fn take_shape(from: &mut ByteReader<'_>) -> Option<Shape> {
    let mut lengths = [Meters(0.0); 5];
    for length in &mut lengths {
        *length = Meters(from.f64()?);
    }
    let [body_radius, half_length, half_width, wheel_base, ring_radius] = lengths;
    let (is_known, apart) = (from.u8()? != 0, Meters(from.f64()?));
    let confirmation = usize::try_from(from.u64()?).ok()?;
    let steering = Steering { rotate: from.f64()?, align: from.f64()?, avoid: from.f64()? };
    let sonars_apart = is_known.then_some(apart);
    Some(Shape { body_radius, half_length, half_width, wheel_base, sonars_apart, ring_radius, confirmation, steering })
}
