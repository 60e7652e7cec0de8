//! The link between robots in one process. A random seed determines which states are delayed, lost or duplicated.
//! Letters (plans and answers) are only delayed, because a real sender would retransmit lost letters.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_runtime::Nanos;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::letter;
use super::{Letter, Link, State};

/// Maximum number of unread states for one robot. The limit is needed because a robot that makes no more turns reads no
/// states.
const UNREAD: usize = 4096;

/// Faults of the link between two robots: delay, loss and duplication.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Minimum and maximum transmission time of a state or a letter.
    pub latency: (Nanos, Nanos),
    /// Probability that a state is lost.
    pub loss: f64,
    /// Probability that a state arrives twice.
    pub duplication: f64,
}

/// One robot's end of a link between robots in one process.
///
/// A state never arrives in the turn in which it was sent, so the order in which robots make their turns has no effect.
/// Each pair of sender and recipient has its own stream of random numbers.
pub struct Air {
    own: usize,
    faults: Faults,
    /// Random number generator of each robot to which states are sent.
    randoms: Vec<ChaCha8Rng>,
    /// Random number generator for letters.
    random: ChaCha8Rng,
    mail: Arc<[Mail]>,
}

/// States and letters on the way to a robot.
struct Mail {
    /// Name of the robot.
    robot: String,
    states: Mutex<Vec<Sent<State>>>,
    letters: Mutex<Vec<Sent<Letter>>>,
}

/// A state or a letter on its way.
struct Sent<T> {
    content: T,
    sent: Nanos,
    due: Nanos,
}

impl Air {
    /// Creates the endpoints of a link between robots with these names, in the order of the names.
    #[must_use]
    pub fn new(names: &[&str], faults: Faults, seed: u64) -> Vec<Self> {
        let empty =
            |name: &&str| Mail { robot: (*name).to_owned(), states: Mutex::default(), letters: Mutex::default() };
        let (robots, mail) = (names.len(), names.iter().map(empty).collect::<Arc<[Mail]>>());
        let stream = |own: usize, other: usize| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream((own.wrapping_mul(robots).wrapping_add(other)) as u64);
            random
        };
        let end = |own| {
            let randoms = (0..robots).map(|other| stream(own, other)).collect();
            let random = stream(robots, own);
            Self { own, faults, randoms, random, mail: Arc::clone(&mail) }
        };
        (0..robots).map(end).collect()
    }

    /// Returns the names of the other robots.
    #[must_use]
    pub fn others(&self) -> Vec<String> {
        let others = self.mail.iter().enumerate().filter(|(place, _)| *place != self.own);
        others.map(|(_, mail)| mail.robot.clone()).collect()
    }
}

impl Faults {
    /// Returns a random transmission time, in nanoseconds.
    fn delay(&self, random: &mut ChaCha8Rng) -> u64 {
        let (least, most) = (self.latency.0.0, self.latency.1.0.max(self.latency.0.0));
        least.saturating_add((unit(random) * (most - least) as f64) as u64)
    }
}

/// Returns a random number from 0 up to, but not including, 1.
fn unit(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

fn lock<T>(sent: &Mutex<Vec<Sent<T>>>) -> MutexGuard<'_, Vec<Sent<T>>> {
    sent.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `take` with each state or letter that has arrived by `now`, and removes it from `sent`.
fn arrive<T: Clone>(sent: &Mutex<Vec<Sent<T>>>, now: Nanos, take: &mut dyn FnMut(T)) {
    lock(sent).retain(|sent| {
        let arrives = sent.sent < now && sent.due <= now;
        if arrives {
            take(sent.content.clone());
        }
        !arrives
    });
}

impl Link for Air {
    fn send(&mut self, state: &State, now: Nanos) {
        let Self { own, faults, randoms, mail, .. } = self;
        for ((other, mail), random) in mail.iter().enumerate().zip(randoms) {
            if other == *own {
                continue;
            }
            // Each state uses the same number of random numbers, so one fault does not change the later ones.
            let (is_lost, is_doubled) = (unit(random) < faults.loss, unit(random) < faults.duplication);
            let delays = [faults.delay(random), faults.delay(random)];
            let copies = if is_lost { 0 } else { 1 + usize::from(is_doubled) };
            for delay in delays.into_iter().take(copies) {
                let due = Nanos(now.0.saturating_add(delay));
                let mut states = lock(&mail.states);
                if states.len() < UNREAD {
                    states.push(Sent { content: state.clone(), sent: now, due });
                }
            }
        }
    }

    fn receive(&mut self, now: Nanos, take: &mut dyn FnMut(State)) {
        if let Some(mail) = self.mail.get(self.own) {
            arrive(&mail.states, now, take);
        }
    }

    fn post(&mut self, to: &str, letter: &Letter, now: Nanos) -> Result<(), String> {
        let due = Nanos(now.0.saturating_add(self.faults.delay(&mut self.random)));
        let mail = self.mail.iter().find(|mail| mail.robot == to).ok_or_else(|| format!("there is no robot `{to}`"))?;
        let mut letters = lock(&mail.letters);
        let plans = letters.iter().filter(|sent| sent.content.content.is_plan()).count();
        if letter.content.is_plan() && plans >= letter::UNREAD {
            return Err(format!("{plans} plans wait for {to} already"));
        }
        letters.push(Sent { content: letter.clone(), sent: now, due });
        Ok(())
    }

    fn letters(&mut self, now: Nanos, take: &mut dyn FnMut(Letter)) {
        if let Some(mail) = self.mail.get(self.own) {
            arrive(&mail.letters, now, take);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::Content;
    use crate::plans::When;

    const TURN: u64 = 100_000_000;

    /// Returns, for each turn, the numbers of the states that arrive in it if one state is sent per turn.
    fn heard(faults: Faults, turns: u64, seed: u64) -> Vec<Vec<u64>> {
        let [mut ada, mut bob] = Air::new(&["ada", "bob"], faults, seed).try_into().ok().unwrap();
        let turn = |number| {
            let now = Nanos(number * TURN);
            ada.send(&State::of("ada", number), now);
            let mut heard = Vec::new();
            bob.receive(now, &mut |state| heard.push(state.number));
            heard
        };
        (0..turns).map(turn).collect()
    }

    #[test]
    fn a_state_arrives_in_the_next_turn_or_after_its_latency() {
        assert_eq!(heard(Faults::default(), 4, 1), [vec![], vec![0], vec![1], vec![2]]);
        let late = Faults { latency: (Nanos(2 * TURN), Nanos(2 * TURN)), ..Faults::default() };
        assert_eq!(heard(late, 4, 1), [vec![], vec![], vec![0], vec![1]]);
    }

    #[test]
    fn a_letter_arrives_after_its_latency_and_is_not_lost() {
        let faults = Faults { latency: (Nanos(2 * TURN), Nanos(2 * TURN)), loss: 1.0, duplication: 1.0 };
        let [mut ada, mut bob] = Air::new(&["ada", "bob"], faults, 1).try_into().ok().unwrap();
        let content = Content::Answer { of: 1, is_accepted: true, sentence: String::new() };
        let letter = Letter { from: "ada".to_owned(), number: 1, content };
        assert_eq!(ada.post("bob", &letter, Nanos::ZERO), Ok(()));
        assert_eq!(ada.post("eve", &letter, Nanos::ZERO), Err("there is no robot `eve`".to_owned()));
        for (turn, expected) in [(1, vec![]), (2, vec![letter.clone()]), (3, vec![])] {
            let mut letters = Vec::new();
            bob.letters(Nanos(turn * TURN), &mut |letter| letters.push(letter));
            assert_eq!(letters, expected, "turn {turn}");
        }
        let content = Content::Plan { when: When::Now, text: String::new() };
        let plan = Letter { content, ..letter.clone() };
        for _ in 0..letter::UNREAD {
            assert_eq!([&plan, &letter].map(|letter| ada.post("bob", letter, Nanos::ZERO)), [Ok(()), Ok(())]);
        }
        assert_eq!(ada.post("bob", &plan, Nanos::ZERO), Err("8 plans wait for bob already".to_owned()));
        assert_eq!(ada.post("bob", &letter, Nanos::ZERO), Ok(()), "there are few answers to few plans");
    }

    #[test]
    fn states_are_lost_and_doubled_as_often_as_asked_for() {
        let count = |faults| heard(faults, 10_000, 1).concat().len();
        assert!((8_900..9_100).contains(&count(Faults { loss: 0.1, ..Faults::default() })));
        assert!((11_900..12_100).contains(&count(Faults { duplication: 0.2, ..Faults::default() })));
        assert_eq!(count(Faults { loss: 1.0, ..Faults::default() }), 0);
    }

    #[test]
    fn the_seed_decides_and_latency_overtakes() {
        let faults = Faults { latency: (Nanos::ZERO, Nanos(5 * TURN)), loss: 0.3, duplication: 0.3 };
        assert_eq!(heard(faults, 200, 7), heard(faults, 200, 7));
        assert_ne!(heard(faults, 200, 7), heard(faults, 200, 8));
        let order = heard(faults, 200, 7).concat();
        assert!(order.windows(2).any(|pair| pair[0] > pair[1]), "a later state arrives first");
    }
}
