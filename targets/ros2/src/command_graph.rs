//! Finds other programs that subscribe to velocity commands or publish them, and describes them in sentences.

use crate::choices::Stamped;
use crate::graph::{Endpoint, Graph};
use crate::names::{dds_type, ros_type};

/// Type of a velocity command without a time stamp.
pub(crate) const TWIST: &str = "geometry_msgs/msg/Twist";
/// Type of a velocity command with a time stamp.
pub(crate) const TWIST_STAMPED: &str = "geometry_msgs/msg/TwistStamped";

impl Graph {
    /// Returns `true` if velocity commands have a time stamp; `None` if this depends on a subscriber that has not been
    /// found yet. If there are subscribers of both types, commands have no time stamp.
    #[must_use]
    pub fn is_stamped(&self, topic: &str, stamped: Stamped) -> Option<bool> {
        let takes = |kind: &str| self.readers_of(topic).any(|reader| reader.kind == dds_type(kind));
        match stamped {
            Stamped::Yes => Some(true),
            Stamped::No => Some(false),
            Stamped::Auto if takes(TWIST) => Some(false),
            Stamped::Auto => takes(TWIST_STAMPED).then_some(true),
        }
    }

    /// Returns a sentence that explains why no program receives the velocity commands.
    #[must_use]
    pub fn about_commands(&self, topic: &str, stamped: Stamped) -> String {
        let kinds = match stamped {
            Stamped::Auto => &[TWIST, TWIST_STAMPED][..],
            Stamped::Yes => &[TWIST_STAMPED],
            Stamped::No => &[TWIST],
        };
        let sent = kinds.join(" or ");
        let readers: Vec<_> = self.readers_of(topic).collect();
        let Some(first) = readers.first() else { return format!("nobody subscribes to `{topic}` ({sent})") };
        let of_kind = |kinds: &[&str]| {
            readers.iter().find(|reader| kinds.iter().any(|kind| reader.kind == dds_type(kind))).copied()
        };
        match (of_kind(kinds), of_kind(&[TWIST, TWIST_STAMPED])) {
            (Some(Endpoint { mismatch: Some(policy), .. }), _) => {
                format!("the subscriber of `{topic}` wants another quality of service ({policy})")
            }
            (Some(_), _) => format!("`{topic}` has a subscriber ({sent}), and the driver has not reached it"),
            (None, Some(other)) => {
                let has = ros_type(&other.kind);
                format!(
                    "the subscriber of `{topic}` takes {has}, and commands are {sent}: `stamped` in the configuration \
                     chooses the type"
                )
            }
            (None, None) => {
                let has = ros_type(&first.kind);
                format!(
                    "the subscriber of `{topic}` takes {has}, and commands are {sent}: set `cmd-vel` to the topic from \
                     which the base takes velocities"
                )
            }
        }
    }

    /// Returns a warning that there are subscribers of both types of velocity commands; `is_stamped` tells which type
    /// is used. Returns `None` if all subscribers have the same type, or if the configuration selects the type.
    #[must_use]
    pub fn about_types(&self, topic: &str, stamped: Stamped, is_stamped: bool) -> Option<String> {
        let takes = |kind: &str| self.readers_of(topic).any(|reader| reader.kind == dds_type(kind));
        if stamped != Stamped::Auto || !takes(TWIST) || !takes(TWIST_STAMPED) {
            return None;
        }
        let (taken, other) = if is_stamped { (TWIST_STAMPED, TWIST) } else { (TWIST, TWIST_STAMPED) };
        Some(format!(
            "`{topic}` has subscribers of two types, {TWIST} and {TWIST_STAMPED}: commands are {taken}, and those that \
             take {other} do not hear them; choose the robot's type by `stamped = {}` or `stamped = {}`",
            is_stamped, !is_stamped
        ))
    }

    /// Returns a warning that other programs also publish velocity commands on `topic`; `None` if there are no such
    /// programs.
    #[must_use]
    pub fn about_rivals(&self, topic: &str) -> Option<String> {
        let (others, them) = match self.writers_of(topic).count() {
            0 => return None,
            1 => ("another publisher".to_owned(), "it"),
            count => (format!("{count} other publishers"), "them"),
        };
        Some(format!(
            "`{topic}` has {others}, and the base obeys whichever command came last: stop {them}, or set `cmd-vel` to \
             an input of a multiplexer"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::dds_topic;

    const TOPIC: &str = "/cmd_vel";

    fn endpoint(topic: &str, kind: &str) -> Endpoint {
        Endpoint { topic: dds_topic(topic), kind: dds_type(kind), is_reliable: true, mismatch: None }
    }

    fn graph(readers: &[&str]) -> Graph {
        Graph { readers: readers.iter().map(|kind| endpoint(TOPIC, kind)).collect(), writers: Vec::new() }
    }

    #[test]
    fn commands_name_the_type_of_their_subscriber() {
        let about = |readers: &[&str], stamped| graph(readers).about_commands(TOPIC, stamped);
        assert_eq!(about(&[], Stamped::No), "nobody subscribes to `/cmd_vel` (geometry_msgs/msg/Twist)");
        assert!(about(&[], Stamped::Auto).ends_with("(geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped)"));
        let other = about(&[TWIST_STAMPED], Stamped::No);
        assert!(other.contains("takes geometry_msgs/msg/TwistStamped, and commands are geometry_msgs/msg/Twist:"));
        assert!(other.ends_with("`stamped` in the configuration chooses the type"), "{other}");
        let text = about(&["std_msgs/msg/String"], Stamped::Auto);
        let expected = "the subscriber of `/cmd_vel` takes std_msgs/msg/String, and commands are \
                        geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped: set `cmd-vel` to the topic from \
                        which the base takes velocities";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_subscriber_with_another_quality_is_named() {
        let mut graph = graph(&["std_msgs/msg/String", TWIST_STAMPED]);
        let unreached = graph.about_commands(TOPIC, Stamped::Auto);
        assert!(unreached.ends_with("and the driver has not reached it"), "{unreached}");
        graph.readers[1].mismatch = Some("Deadline".to_owned());
        let expected = "the subscriber of `/cmd_vel` wants another quality of service (Deadline)";
        assert_eq!(graph.about_commands(TOPIC, Stamped::Auto), expected);
    }

    #[test]
    fn two_types_of_subscribers_are_a_warning() {
        let graph = graph(&[TWIST_STAMPED, TWIST]);
        assert_eq!(graph.is_stamped(TOPIC, Stamped::Auto), Some(false));
        let expected = "`/cmd_vel` has subscribers of two types, geometry_msgs/msg/Twist and \
                        geometry_msgs/msg/TwistStamped: commands are geometry_msgs/msg/Twist, and those that take \
                        geometry_msgs/msg/TwistStamped do not hear them; choose the robot's type by `stamped = false` \
                        or `stamped = true`";
        assert_eq!(graph.about_types(TOPIC, Stamped::Auto, false).as_deref(), Some(expected));
        assert!(
            graph.about_types(TOPIC, Stamped::Auto, true).unwrap().contains("commands are geometry_msgs/msg/TwistS")
        );
        assert_eq!(graph.about_types(TOPIC, Stamped::No, false), None);
        assert_eq!(self::graph(&[TWIST, TWIST]).about_types(TOPIC, Stamped::Auto, false), None);
        assert_eq!(self::graph(&[TWIST_STAMPED]).is_stamped(TOPIC, Stamped::Auto), Some(true));
        assert_eq!(self::graph(&["std_msgs/msg/String"]).is_stamped(TOPIC, Stamped::Auto), None);
    }

    #[test]
    fn rivals_are_counted() {
        let mut graph = Graph::default();
        let about = |graph: &Graph| graph.about_rivals(TOPIC);
        graph.writers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        assert_eq!(about(&graph), None);
        graph.writers.push(endpoint(TOPIC, TWIST));
        assert!(about(&graph).unwrap().starts_with("`/cmd_vel` has another publisher, and the base obeys"));
        graph.writers.push(endpoint(TOPIC, TWIST_STAMPED));
        assert!(about(&graph).unwrap().starts_with("`/cmd_vel` has 2 other publishers, and the base obeys"));
    }
}
