//! Sessions of the other robots: each run of a robot's program has a random number, and states that count from 1.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// Time after the last state of a session until which no other session of the robot begins.
const LIVES: Duration = Duration::from_millis(500);
/// Maximum number of sessions of a robot that are known to be over.
const OVER: usize = 256;

/// The sessions of all other robots.
#[derive(Debug, Default)]
pub(super) struct Sessions(BTreeMap<String, Session>);

/// The current session of a robot.
#[derive(Debug)]
struct Session {
    session: u64,
    /// Number of the newest state.
    number: u64,
    /// Time at which the newest state arrived.
    at: Instant,
    /// Sessions of the robot that are over.
    over: VecDeque<u64>,
}

impl Sessions {
    /// Returns the current session of a robot, if a state of it has arrived.
    pub(super) fn of(&self, robot: &str) -> Option<u64> {
        self.0.get(robot).map(|known| known.session)
    }

    /// Takes the session and the number of a robot's state that has arrived at time `now`; returns `true` if the state
    /// is newer than all others of the robot.
    ///
    /// # Errors
    /// The state is of a session that is over, or of another robot with the same name: the end of a sentence.
    pub(super) fn take(&mut self, robot: &str, (session, number): (u64, u64), now: Instant) -> Result<bool, String> {
        let Some(known) = self.0.get_mut(robot) else {
            self.0.insert(robot.to_owned(), Session { session, number, at: now, over: VecDeque::new() });
            return Ok(true);
        };
        if known.session == session {
            let is_newer = number > known.number;
            if is_newer {
                (known.number, known.at) = (number, now);
            }
            return Ok(is_newer);
        }
        // Somebody may have recorded a session that is over: it must not take the place of the current one.
        if known.over.contains(&session) {
            return Err(format!("it sends a state of `{robot}` from a run that is over"));
        }
        if now.saturating_duration_since(known.at) < LIVES {
            return Err(format!("another robot with the name `{robot}` sends states: give each robot its own name"));
        }
        if known.over.len() >= OVER {
            known.over.pop_front();
        }
        known.over.push_back(known.session);
        (known.session, known.number, known.at) = (session, number, now);
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_that_was_replaced_does_not_come_back() {
        let (mut sessions, begun) = (Sessions::default(), Instant::now());
        let mut take = |session, number, milliseconds| {
            sessions.take("ada", (session, number), begun + Duration::from_millis(milliseconds))
        };
        assert_eq!([take(1, 5, 0), take(1, 6, 100), take(1, 4, 200)], [Ok(true), Ok(true), Ok(false)]);
        // A program that was started again counts from 1.
        assert_eq!(take(2, 1, 700), Ok(true));
        for (number, milliseconds) in [(7, 800), (8, 9_000)] {
            assert_eq!(take(1, number, milliseconds).unwrap_err(), "it sends a state of `ada` from a run that is over");
        }
        assert_eq!(take(2, 2, 9_100), Ok(true));
    }

    #[test]
    fn a_second_robot_of_one_name_is_refused() {
        let (mut sessions, now) = (Sessions::default(), Instant::now());
        assert_eq!(sessions.take("ada", (1, 1), now), Ok(true));
        let refused = sessions.take("ada", (2, 1), now).unwrap_err();
        assert_eq!(refused, "another robot with the name `ada` sends states: give each robot its own name");
        assert_eq!((sessions.take("bob", (2, 1), now), sessions.of("ada")), (Ok(true), Some(1)));
    }
}
