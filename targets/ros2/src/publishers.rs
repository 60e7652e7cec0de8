//! Detects, from the messages that arrive, that the odometry has a second publisher.

use std::time::Duration;

use crate::fault::Fault;
use crate::graph::Graph;
use crate::source::{Input, TopicPurpose};

/// Minimum time for which the search at the start waits for messages of a second publisher that is on the graph.
const WATCH: Duration = Duration::from_secs(1);

/// Publishers of the odometry from which messages have arrived.
///
/// A killed program stays on the graph for some time. After a restart of the robot, there are therefore two publishers,
/// and the first one is silent. If, however, two programs publish different poses at the same time, the first publisher
/// sends again after the second one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Publishers {
    /// Publishers before the last one.
    earlier: Vec<[u8; 16]>,
    last: Option<[u8; 16]>,
    /// `true` if a publisher has sent again after another publisher.
    is_mixed: bool,
}

impl Publishers {
    /// Calls `take` for a message of `input` that `publisher` sent.
    ///
    /// # Errors
    /// Fails if `take` fails, or if a publisher of the odometry has sent again after another publisher.
    pub(crate) fn pass(
        &mut self,
        input: &Input,
        publisher: [u8; 16],
        graph: impl Fn() -> Graph,
        take: impl FnOnce() -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        if input.source != TopicPurpose::Odometry {
            return take();
        }
        let several = |may_be_restart| {
            let count = graph().publishers(input).max(2);
            Fault::Several { topic: input.topic.clone(), count, may_be_restart }
        };
        if self.last != Some(publisher) {
            self.is_mixed |= self.earlier.contains(&publisher);
            self.earlier.extend(self.last.replace(publisher));
        }
        if self.is_mixed {
            return Err(several(false));
        }
        take().map_err(|fault| {
            // The poses of two publishers look like a robot that jumps, and their time stamps like a clock that goes
            // back.
            let is_break = matches!(fault, Fault::Jumped { .. } | Fault::Backwards(_));
            let are_two = is_break && !self.earlier.is_empty() && graph().publishers(input) > 1;
            if are_two { several(true) } else { fault }
        })
    }
}

/// Waiting period for messages of a second publisher. Contains the time at which the second publisher was first seen on
/// the graph; `None` before that.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Probation(Option<Duration>);

impl Probation {
    /// Returns `true` if `input` has at most one publisher on the graph, or if the waiting period for messages of a
    /// second publisher is over at the time `now`.
    pub(crate) fn is_over(&mut self, input: &Input, graph: &Graph, now: Duration) -> bool {
        if graph.publishers(input) < 2 {
            return true;
        }
        now.saturating_sub(*self.0.get_or_insert(now)) >= WATCH.max(Duration::from_millis(input.limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Endpoint;
    use crate::names::{dds_topic, dds_type};

    const KIND: &str = "nav_msgs/msg/Odometry";

    fn input(source: TopicPurpose) -> Input {
        Input { source, topic: "/odom".to_owned(), kind: KIND, limit: 1 }
    }

    /// Returns a graph with `count` publishers of the odometry.
    fn graph(count: usize) -> Graph {
        let (topic, kind) = (dds_topic("/odom"), dds_type(KIND));
        let endpoint = Endpoint { topic, kind, is_reliable: true, mismatch: None };
        Graph { readers: Vec::new(), writers: vec![endpoint; count] }
    }

    /// Passes messages of the publishers `ids` in this order; the last message causes `fault`.
    fn passed(ids: &[u8], source: TopicPurpose, fault: Option<Fault>) -> Result<(), Fault> {
        let (input, mut publishers) = (input(source), Publishers::default());
        let pass = |publishers: &mut Publishers, id: u8, fault: Option<Fault>| {
            publishers.pass(&input, [id; 16], || graph(2), || fault.map_or(Ok(()), Err))
        };
        let (last, first) = ids.split_last().unwrap();
        first.iter().try_for_each(|id| pass(&mut publishers, *id, None))?;
        pass(&mut publishers, *last, fault)
    }

    fn several(may_be_restart: bool) -> Result<(), Fault> {
        Err(Fault::Several { topic: "/odom".to_owned(), count: 2, may_be_restart })
    }

    #[test]
    fn a_publisher_after_another_is_a_restart() {
        assert_eq!(passed(&[1, 1, 2, 2, 2], TopicPurpose::Odometry, None), Ok(()));
        assert_eq!(passed(&[1, 2, 1], TopicPurpose::Odometry, None), several(false));
        assert_eq!(passed(&[1, 2, 3, 2], TopicPurpose::Odometry, None), several(false));
        assert_eq!(passed(&[1, 2, 1], TopicPurpose::Scan, None), Ok(()));
    }

    #[test]
    fn a_jump_between_publishers_is_no_jump() {
        let jumped = || Fault::Jumped { way: 1.0, degrees: 0.0, seconds: 0.1 };
        assert_eq!(passed(&[1, 2], TopicPurpose::Odometry, Some(jumped())), several(true));
        assert_eq!(passed(&[1, 2], TopicPurpose::Odometry, Some(Fault::Backwards(2.0))), several(true));
        assert_eq!(passed(&[1, 2], TopicPurpose::Odometry, Some(Fault::NoPose)), Err(Fault::NoPose));
        assert_eq!(passed(&[1, 1], TopicPurpose::Odometry, Some(jumped())), Err(jumped()));
        let alone = Publishers { last: Some([1; 16]), ..Publishers::default() }.pass(
            &input(TopicPurpose::Odometry),
            [2; 16],
            || graph(1),
            || Err(jumped()),
        );
        assert_eq!(alone, Err(jumped()));
    }

    #[test]
    fn a_silent_second_publisher_delays_the_start() {
        let (odometry, mut probation) = (input(TopicPurpose::Odometry), Probation::default());
        let mut is_over =
            |count: usize, millis: u64| probation.is_over(&odometry, &graph(count), Duration::from_millis(millis));
        assert_eq!([is_over(1, 0), is_over(2, 500), is_over(2, 1499), is_over(2, 1500)], [true, false, false, true]);
    }
}
