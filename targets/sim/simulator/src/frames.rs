//! Records the frames of an animation. The number of frames is limited, and the frames are evenly spread over the run,
//! regardless of its duration.

use mdle_runtime::{Nanos, Pose, SONARS};

use crate::point::Point;

/// Maximum number of frames. When this number is reached, every second frame is removed.
pub(crate) const FRAMES_MOST: usize = 800;

/// A frame: the state of the robot and of the moving objects at one time of the run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FilmFrame {
    pub(crate) t: Nanos,
    pub(crate) pose: Pose,
    /// Position of each sonar's new echo; `None` for a sonar without a new echo.
    pub(crate) echoes: [Option<Point>; SONARS],
    /// Displacement of each moving object of the world; `None` for an open door.
    pub(crate) things: Vec<Option<Point>>,
}

/// Frames of a run. The longer a run is, the smaller is the fraction of its frames that is stored.
#[derive(Debug, Clone)]
pub(crate) struct Frames {
    kept: Vec<FilmFrame>,
    /// The last frame of the run, even if it is not among the stored frames; `None` before the first frame.
    last: Option<FilmFrame>,
    /// A frame is stored if its number is a multiple of this value.
    stride: u64,
    seen: u64,
}

impl Frames {
    /// Creates an empty record.
    pub(crate) fn new() -> Self {
        Self { kept: Vec::new(), last: None, stride: 1, seen: 0 }
    }

    /// Adds the next frame.
    pub(crate) fn push(&mut self, frame: FilmFrame) {
        if self.seen.is_multiple_of(self.stride) {
            self.kept.push(frame.clone());
        }
        if self.kept.len() >= FRAMES_MOST {
            let mut number = 0_usize;
            self.kept.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.stride = self.stride.saturating_mul(2);
        }
        self.last = Some(frame);
        self.seen = self.seen.saturating_add(1);
    }

    /// Returns the stored frames in order, followed by the last frame if it is not among them.
    pub(crate) fn all(&self) -> Vec<FilmFrame> {
        let last = self.last.as_ref().filter(|last| self.kept.last() != Some(last));
        self.kept.iter().chain(last).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_is_thinned_evenly_and_keeps_its_ends() {
        for turns in [1_u64, 2, 799, 800, 801, 5_000, 100_001] {
            let mut frames = Frames::new();
            for turn in 0..turns {
                frames.push(FilmFrame {
                    t: Nanos(turn),
                    pose: Pose::ORIGIN,
                    echoes: [None; SONARS],
                    things: Vec::new(),
                });
            }
            let times: Vec<u64> = frames.all().iter().map(|frame| frame.t.0).collect();
            assert!(times.len() <= FRAMES_MOST && (times.len() as u64) >= turns.min(FRAMES_MOST as u64 / 2));
            assert_eq!((times.first(), times.last()), (Some(&0), Some(&(turns - 1))));
            let steps: Vec<u64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let even =
                steps.split_last().is_none_or(|(last, rest)| rest.iter().all(|step| step == &steps[0] && last <= step));
            assert!(even, "{turns}: {steps:?}");
        }
    }
}
