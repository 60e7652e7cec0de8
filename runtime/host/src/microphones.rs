//! Passes the sound of a robot's two microphones to a module that listens.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_runtime::Nanos;

/// Maximum number of turns whose sound is stored for a slow listener: ten seconds at a period of 100 ms.
const KEPT: usize = 100;

/// Microphones of a run; if a module listens, the robot adds sound in each turn.
#[derive(Debug, Clone, Default)]
pub struct Microphones(Arc<Mutex<Sound>>);

#[derive(Debug, Default)]
struct Sound {
    /// Radius of the head, in metres; `None` if no module listens.
    head: Option<f64>,
    turns: VecDeque<(Nanos, Vec<[f32; 2]>)>,
}

/// A function that gives a robot the microphones of its run; they are on a head with this radius, in metres.
///
/// The function returns a message for the operator if the robot has no sound.
pub type EarsOf<R> = fn(&mut R, Microphones, f64) -> Result<(), String>;

impl Microphones {
    fn lock(&self) -> MutexGuard<'_, Sound> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests sound from microphones on a head with this radius, in metres. Called before the robot is connected.
    pub fn listen(&self, radius: f64) {
        self.lock().head = Some(radius);
    }

    /// Returns the radius of the head in metres; `None` if no module listens.
    #[must_use]
    pub fn head(&self) -> Option<f64> {
        self.lock().head
    }

    /// Appends the samples of the left and the right ear since the previous turn.
    pub fn put(&self, at: Nanos, samples: Vec<[f32; 2]>) {
        let mut sound = self.lock();
        if sound.turns.len() >= KEPT {
            sound.turns.pop_front();
        }
        sound.turns.push_back((at, samples));
    }

    /// Removes and returns the samples up to the time `until`, oldest first.
    #[must_use]
    pub fn take(&self, until: Nanos) -> Vec<[f32; 2]> {
        let mut sound = self.lock();
        let count = sound.turns.iter().take_while(|(at, _)| *at <= until).count();
        sound.turns.drain(..count).flat_map(|(_, samples)| samples).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_listener_hears_no_turn_before_its_time() {
        let microphones = Microphones::default();
        for turn in 0..4_u16 {
            microphones.put(Nanos(u64::from(turn)), vec![[f32::from(turn), 0.0]]);
        }
        let sound = |until| microphones.take(Nanos(until)).iter().map(|[left, _]| *left).collect::<Vec<_>>();
        assert_eq!(sound(1), [0.0, 1.0]);
        assert_eq!(sound(1), []);
        assert_eq!(sound(9), [2.0, 3.0]);
    }

    #[test]
    fn a_slow_listener_loses_the_oldest() {
        let microphones = Microphones::default();
        (0..KEPT as u64 + 5).for_each(|turn| microphones.put(Nanos(turn), vec![[0.0; 2]]));
        assert_eq!(microphones.take(Nanos(u64::MAX)).len(), KEPT);
    }
}
