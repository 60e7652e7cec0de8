//! Sessions of the other robots. Each run of a robot's program is a session, which has a random number and counts its
//! states from 1.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// Time after a session's last state during which no other session of the same robot is accepted. A robot repeats its
/// state every half second, regardless of the duration of its turns.
const LIVES: Duration = Duration::from_secs(2);
/// Maximum number of ended sessions of a robot that are kept.
const OVER: usize = 256;

/// Sessions of all other robots.
#[derive(Debug, Default)]
pub(super) struct Sessions(BTreeMap<String, RobotSession>);

/// The current session of a robot, and the sessions that have ended.
#[derive(Debug)]
struct RobotSession {
    session: u64,
    /// Number of the newest state.
    number: u64,
    /// Arrival time of the last state, new or repeated.
    at: Instant,
    /// Ended sessions of the robot, from which no state is accepted.
    over: VecDeque<u64>,
}

impl Sessions {
    /// Returns the current session of a robot; `None` before its first state has arrived.
    pub(super) fn of(&self, robot: &str) -> Option<u64> {
        self.0.get(robot).map(|known| known.session)
    }

    /// Processes the session and the number of a robot's state, which has arrived at time `now`. Returns `true` if the
    /// state is newer than all earlier states of the robot.
    ///
    /// # Errors
    /// Returns the end of a sentence if the state belongs to an ended session, or to another robot with the same name.
    pub(super) fn take(&mut self, robot: &str, (session, number): (u64, u64), now: Instant) -> Result<bool, String> {
        let Some(known) = self.0.get_mut(robot) else {
            self.0.insert(robot.to_owned(), RobotSession { session, number, at: now, over: VecDeque::new() });
            return Ok(true);
        };
        if known.session == session {
            let is_newer = number > known.number;
            (known.number, known.at) = (known.number.max(number), now);
            return Ok(is_newer);
        }
        // The state may be a replay of an ended session, which must not replace the current one.
        if known.over.contains(&session) {
            return Err(format!(
                "another run of `{robot}` has taken its place: give each robot its own name, or start this one again"
            ));
        }
        if now.saturating_duration_since(known.at) < LIVES {
            let seconds = LIVES.as_secs();
            return Err(format!(
                "another run of `{robot}` has sent states within {seconds} s: give each robot its own name, or wait if it \
                 was started again"
            ));
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

    const OVER: &str =
        "another run of `ada` has taken its place: give each robot its own name, or start this one again";
    const TWO: &str = "another run of `ada` has sent states within 2 s: give each robot its own name, or wait if it was \
                       started again";

    #[test]
    fn a_session_that_was_replaced_does_not_come_back() {
        let (mut sessions, begun) = (Sessions::default(), Instant::now());
        let mut take = |session, number, milliseconds| {
            sessions.take("ada", (session, number), begun + Duration::from_millis(milliseconds))
        };
        assert_eq!([take(1, 5, 0), take(1, 6, 100), take(1, 4, 200)], [Ok(true), Ok(true), Ok(false)]);
        assert_eq!(take(2, 1, 2_100).unwrap_err(), TWO);
        // A program that was restarted counts from 1 again.
        assert_eq!(take(2, 1, 2_200), Ok(true));
        assert_eq!([take(1, 7, 2_300).unwrap_err(), take(1, 8, 9_000).unwrap_err()], [OVER, OVER]);
        assert_eq!(take(2, 2, 9_100), Ok(true));
    }

    #[test]
    fn a_robot_with_long_turns_keeps_its_session() {
        let (mut sessions, begun) = (Sessions::default(), Instant::now());
        let mut take =
            |session, milliseconds| sessions.take("ada", (session, 1), begun + Duration::from_millis(milliseconds));
        assert_eq!(take(1, 0), Ok(true));
        for milliseconds in (500..60_000).step_by(500) {
            assert_eq!(take(1, milliseconds), Ok(false), "it repeats its state");
            assert_eq!(take(2, milliseconds + 200).unwrap_err(), TWO);
        }
    }

    #[test]
    fn a_second_robot_of_one_name_is_refused() {
        let (mut sessions, now) = (Sessions::default(), Instant::now());
        assert_eq!(sessions.take("ada", (1, 1), now), Ok(true));
        assert_eq!(sessions.take("ada", (2, 1), now).unwrap_err(), TWO);
        assert_eq!((sessions.take("bob", (2, 1), now), sessions.of("ada")), (Ok(true), Some(1)));
    }
}
