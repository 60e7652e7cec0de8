//! Sound on its way from a robot with two microphones to the module that listens to it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_runtime::Nanos;

/// Turns whose sound is kept for a listener that is slow: ten seconds of a robot with a period of 100 ms.
const KEPT: usize = 100;

/// The microphones of a run: a robot fills them turn by turn if a module listens.
#[derive(Debug, Clone, Default)]
pub struct Microphones(Arc<Mutex<Sound>>);

#[derive(Debug, Default)]
struct Sound {
    /// Radius of the head, in metres, if somebody listens.
    head: Option<f64>,
    turns: VecDeque<(Nanos, Vec<[f32; 2]>)>,
}

/// Gives a robot the microphones of its run, on a head of this radius in metres.
///
/// The function returns a sentence for the operator if there is nothing to be heard.
pub type EarsOf<R> = fn(&mut R, Microphones, f64) -> Result<(), String>;

impl Microphones {
    fn lock(&self) -> MutexGuard<'_, Sound> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks for sound, on a head of this radius in metres: called before the robot is connected.
    pub fn listen(&self, radius: f64) {
        self.lock().head = Some(radius);
    }

    /// Returns the radius of the head in metres; `None` if nobody listens.
    #[must_use]
    pub fn head(&self) -> Option<f64> {
        self.lock().head
    }

    /// Adds the samples of the left and the right ear since the turn before.
    pub fn put(&self, at: Nanos, samples: Vec<[f32; 2]>) {
        let mut sound = self.lock();
        if sound.turns.len() >= KEPT {
            sound.turns.pop_front();
        }
        sound.turns.push_back((at, samples));
    }

    /// Takes what the ears have heard until this time, the oldest first.
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
