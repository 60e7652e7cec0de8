//! The film of a run: its speed, the atoms that run, and its SVG animations, which all repeat with the same period.

use mdle_runtime::Nanos;
use svg::node::element::{Animate, AnimateTransform};

use super::layout::round_step;
use crate::frames::FilmFrame;
use crate::point::Point;
use crate::trail::{Mark, Trail};

/// Maximum duration of the film, in seconds, without the pause at the end.
const SHOWN_MOST: f64 = 20.0;
/// Maximum number of recorded positions (about 200 m of path) for which the film draws each position.
const PLACES_MOST: usize = 20_000;
/// Maximum number of runs of atoms for which each run is drawn. If there are more, runs that begin and end between two
/// frames are omitted.
const ACTS_MOST: usize = 1000;
/// Pause at the end of the film, in seconds.
const REST: f64 = 2.5;

/// A film of a run.
pub(super) struct Film<'f> {
    /// Frames of the run.
    pub(super) frames: &'f [FilmFrame],
    /// Runs of atoms that the film shows, in order.
    pub(super) acts: Vec<Act>,
    /// Factor by which the film is faster than the run.
    pub(super) times: f64,
    /// `true` if the driven path is short enough to draw each position.
    smooth: bool,
}

/// A run of an atom in the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Act {
    /// Index of the run among the marks of the trail; `None` before the first atom.
    pub(super) mark: Option<usize>,
    pub(super) from: Nanos,
    pub(super) to: Nanos,
    /// Index of the act's first frame. The act's last frame is the first frame of the next act.
    first: usize,
    last: usize,
}

impl<'f> Film<'f> {
    /// Creates the film of these frames of `trail`.
    pub(super) fn of(frames: &'f [FilmFrame], trail: &Trail) -> Self {
        let marks = &trail.ways.marks;
        let mut acts: Vec<Act> = Vec::new();
        let mut begun = 0;
        for (number, frame) in frames.iter().enumerate() {
            let before = begun;
            while marks.get(begun).is_some_and(|mark| mark.t <= frame.t) {
                begun += 1;
            }
            let act = |mark, from| Act { mark, from, to: frame.t, first: number, last: number };
            if acts.is_empty() && begun == 0 {
                acts.push(act(None, frame.t));
            }
            if marks.len() > ACTS_MOST {
                // Only the last of the runs that have begun since the previous frame.
                acts.extend(newest(marks, before, begun).map(|(number, mark)| act(Some(number), mark.t)));
            } else {
                acts.extend((before..begun).filter_map(|mark| Some(act(Some(mark), marks.get(mark)?.t))));
            }
            if let Some(act) = acts.last_mut() {
                (act.to, act.last) = (frame.t, number);
            }
        }
        // Each act ends where the next one begins, and shares that frame with it.
        let nexts: Vec<(Nanos, usize)> = acts.iter().skip(1).map(|next| (next.from, next.first)).collect();
        for (act, next) in acts.iter_mut().zip(nexts) {
            (act.to, act.last) = next;
        }
        let seconds = frames.last().map_or(0.0, |frame| frame.t.seconds());
        let smooth = trail.ways.marks.iter().map(|mark| mark.way.len()).sum::<usize>() <= PLACES_MOST;
        Self { frames, acts, times: round_step((seconds / SHOWN_MOST).max(1.0)), smooth }
    }

    /// Returns the index of the atom that runs in an act; `None` before the first atom, or if the act combines all
    /// passes beyond the maximum number.
    pub(super) fn atom(act: &Act, trail: &Trail) -> Option<usize> {
        act.mark.and_then(|mark| trail.ways.marks.get(mark))?.atom
    }

    /// Returns the frames of an act.
    pub(super) fn of_act(&self, act: &Act) -> &'f [FilmFrame] {
        self.frames.get(act.first..=act.last).unwrap_or_default()
    }

    /// Returns the path that was driven in an act, followed by the paths of the runs that were omitted after it; `None`
    /// before the first atom, or if the whole path is too long to draw each position.
    pub(super) fn way(&self, act: &Act, trail: &Trail) -> Option<Vec<Point>> {
        let first = act.mark?;
        let next = self.acts.get(self.acts.partition_point(|other| other.mark <= act.mark)).and_then(|next| next.mark);
        let marks = trail.ways.marks.get(first..next.unwrap_or(trail.ways.marks.len())).filter(|_| self.smooth)?;
        Some(marks.iter().flat_map(|mark| &mark.way).copied().collect())
    }

    /// Returns the time of the run that the film's end shows.
    pub(super) fn end(&self) -> Nanos {
        self.frames.last().map_or(Nanos::ZERO, |frame| frame.t)
    }

    /// Returns the fraction of the run that has passed at the time `t`, from 0 to 1.
    pub(super) fn part(&self, t: Nanos) -> f64 {
        let end = self.end().seconds();
        if end > 0.0 { (t.seconds() / end).min(1.0) } else { 1.0 }
    }

    /// Returns the duration of the film in seconds, including the pause at its end.
    pub(super) fn duration(&self) -> f64 {
        libm::round((self.end().seconds() / self.times + REST) * 1e3) / 1e3
    }

    /// Returns the position of the run's time `t` within one repetition of the film, from 0 to 1, rounded to a
    /// hundred-thousandth.
    fn key(&self, t: Nanos) -> f64 {
        let shown = t.min(self.end()).seconds() / self.times;
        libm::round(shown / self.duration() * 1e5) / 1e5
    }

    /// Returns the animation of an attribute that changes smoothly through these values.
    pub(super) fn animate(&self, attribute: &str, values: impl Iterator<Item = (Nanos, String)>) -> Animate {
        let attributes = self.smooth(values).into_iter();
        attributes
            .fold(Animate::new().set("attributeName", attribute), |animate, (name, value)| animate.set(name, value))
    }

    /// Returns the animation of a transformation that changes smoothly through these values.
    pub(super) fn transform(&self, kind: &str, values: impl Iterator<Item = (Nanos, String)>) -> AnimateTransform {
        let animate = AnimateTransform::new().set("attributeName", "transform").set("type", kind);
        self.smooth(values).into_iter().fold(animate, |animate, (name, value)| animate.set(name, value))
    }

    /// Returns the animation of an attribute that has each of these values from the value's time on. The first value
    /// also applies before its time.
    pub(super) fn switch(&self, attribute: &str, values: impl Iterator<Item = (Nanos, String)>) -> Animate {
        let mut keyed: Vec<(f64, String)> = values.map(|(t, value)| (self.key(t), value)).collect();
        if let Some(first) = keyed.first_mut() {
            first.0 = 0.0;
        }
        let animate = Animate::new().set("attributeName", attribute).set("calcMode", "discrete");
        self.attributes(&keyed).into_iter().fold(animate, |animate, (name, value)| animate.set(name, value))
    }

    /// Returns an animation that shows an element from the time `from` on; if `to` is given, only until the time `to`.
    pub(super) fn visible(&self, from: Nanos, to: Option<Nanos>) -> Animate {
        let before = (self.key(from) > 0.0).then(|| (Nanos::ZERO, "hidden".to_owned()));
        let behind = to.map(|to| (to, "hidden".to_owned()));
        self.switch("visibility", before.into_iter().chain([(from, "visible".to_owned())]).chain(behind))
    }

    fn smooth(&self, values: impl Iterator<Item = (Nanos, String)>) -> [(&'static str, String); 4] {
        let mut keyed: Vec<(f64, String)> = values.map(|(t, value)| (self.key(t), value)).collect();
        // The values are constant before the first time and after the last.
        if let (Some((_, first)), Some((_, last))) = (keyed.first().cloned(), keyed.last().cloned()) {
            keyed.insert(0, (0.0, first));
            keyed.push((1.0, last));
        }
        self.attributes(&keyed)
    }

    fn attributes(&self, keyed: &[(f64, String)]) -> [(&'static str, String); 4] {
        let (mut times, mut values) = (String::new(), String::new());
        for (number, (key, value)) in keyed.iter().enumerate() {
            let between = if number == 0 { "" } else { ";" };
            times += &format!("{between}{key}");
            values += between;
            values += value;
        }
        let dur = format!("{}s", self.duration());
        [("keyTimes", times), ("values", values), ("dur", dur), ("repeatCount", "indefinite".to_owned())]
    }
}

/// Returns the last mark in the range `before..begun`, with its index; `None` if the range is empty.
fn newest(marks: &[Mark], before: usize, begun: usize) -> Option<(usize, &Mark)> {
    let number = begun.checked_sub(1).filter(|number| *number >= before)?;
    Some((number, marks.get(number)?))
}

/// Returns the values without each value that equals the previous one.
pub(super) fn changes<T>(values: impl Iterator<Item = (T, String)>) -> impl Iterator<Item = (T, String)> {
    let mut last = None;
    values.filter(move |(_, value)| last.replace(value.clone()).as_ref() != Some(value))
}
