//! Proposes configuration entries for missing topics. The proposals are topics of the same type that are on the graph.

use std::collections::BTreeSet;

use crate::choices::RANGES;
use crate::command_graph::{TWIST, TWIST_STAMPED};
use crate::config::Config;
use crate::graph::{Endpoint, Graph};
use crate::names::{dds_topic, dds_type, ros_topic};
use crate::source::Input;

/// Maximum number of topics in a list.
const LISTED: usize = 8;

/// A missing topic, and the topics of the same type on the graph.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Missing<'a> {
    key: &'static str,
    /// `true` if the only topic of this type on the graph may be proposed without reservation.
    is_telling: bool,
    topic: &'a str,
    candidates: BTreeSet<&'a str>,
}

impl<'a> Missing<'a> {
    /// Creates the data about the missing topic `topic`; `None` if one of `endpoints` has this topic.
    fn among(
        endpoints: &'a [Endpoint],
        topic: &'a str,
        kinds: &[&str],
        (key, is_telling): (&'static str, bool),
    ) -> Option<Self> {
        let name = dds_topic(topic);
        if endpoints.iter().any(|endpoint| endpoint.topic == name) {
            return None;
        }
        let has_type = |endpoint: &&Endpoint| kinds.iter().any(|kind| endpoint.kind == dds_type(kind));
        let candidates = endpoints.iter().filter(has_type).filter_map(|endpoint| ros_topic(&endpoint.topic));
        Some(Self { key, is_telling, topic, candidates: candidates.collect() })
    }

    /// Returns the namespaces in which the graph contains this topic.
    fn namespaces(&self) -> BTreeSet<&'a str> {
        let inside = self.candidates.iter().filter_map(|candidate| candidate.strip_suffix(self.topic));
        inside.filter(|namespace| !namespace.is_empty()).collect()
    }

    /// Returns a configuration entry with the most probable topic, and the other candidates in a comment; `None` if no
    /// topic of the type is on the graph.
    fn choice(&self) -> Option<String> {
        let last = |topic: &'a str| topic.rsplit('/').next().unwrap_or(topic);
        let mut candidates: Vec<_> = self.candidates.iter().copied().collect();
        candidates.sort_by_key(|candidate| last(candidate) != last(self.topic));
        let (first, others) = candidates.split_first()?;
        let others: Vec<_> = others.iter().take(LISTED).map(|other| format!("\"{other}\"")).collect();
        if self.key == RANGES {
            let comment = if others.is_empty() { String::new() } else { format!(" # also: {}", others.join(", ")) };
            return Some(format!("{RANGES} = [{{ topic = \"{first}\" }}]{comment}"));
        }
        let comment = match (others.as_slice(), self.is_telling) {
            ([], true) => String::new(),
            ([], false) => format!(" # if that is the {}", self.key),
            ([..], _) => format!(" # or {}", others.join(", ")),
        };
        Some(format!("{} = \"{first}\"{comment}", self.key))
    }
}

impl Graph {
    /// Returns a help text with configuration entries for missing topics. It contains the missing topics for which the
    /// graph has candidates of the same type; empty if there are no candidates. If all missing topics exist in a single
    /// other namespace, the entry sets `namespace`, unless `config` contains absolute names, because a namespace does
    /// not change these.
    #[must_use]
    pub fn help<'i>(&'i self, inputs: impl Iterator<Item = &'i Input>, commands: &'i str, config: &Config) -> String {
        let of_input =
            |input: &'i Input| Missing::among(&self.writers, &input.topic, &[input.kind], input.source.key()?);
        let mut missing: Vec<_> = inputs.filter_map(of_input).collect();
        missing.extend(Missing::among(&self.readers, commands, &[TWIST, TWIST_STAMPED], ("cmd-vel", true)));
        let is_absolute = config.robot_topics().any(|(_, name)| name.starts_with('/'));
        let namespace = namespace(&missing).filter(|_| !is_absolute);
        let choices = || {
            let mut choices: Vec<_> = missing.iter().filter_map(Missing::choice).collect();
            // Each missing range sensor has the same candidates.
            choices.dedup();
            choices
        };
        let entries = namespace.map_or_else(choices, |namespace| vec![namespace]);
        match entries.as_slice() {
            [] => String::new(),
            [entry] => format!("\nhelp: write `{entry}` into the file of --config"),
            [..] => format!("\nhelp: write into the file of --config:\n{}", entries.join("\n")),
        }
    }
}

/// Returns an entry that sets the namespace that contains all topics in `missing`; `None` if `missing` has fewer than
/// two topics, or if there is not exactly one such namespace.
fn namespace(missing: &[Missing<'_>]) -> Option<String> {
    let (first, others) = missing.split_first().filter(|(_, others)| !others.is_empty())?;
    let mut common = first.namespaces();
    for other in others {
        let namespaces = other.namespaces();
        common.retain(|namespace| namespaces.contains(namespace));
    }
    let only = common.first().filter(|_| common.len() == 1)?;
    Some(format!("namespace = \"{only}\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choices::{BumperSource, RangeSensor};
    use crate::config::Configured;

    fn endpoint(topic: &str, kind: &str) -> Endpoint {
        Endpoint { topic: dds_topic(topic), kind: dds_type(kind), is_reliable: true, mismatch: None }
    }

    fn help(graph: &Graph, change: impl Fn(&mut Config)) -> String {
        let mut config = Configured::read(None).unwrap().config;
        change(&mut config);
        let inputs = crate::source::inputs(&config).unwrap();
        graph.help(inputs.iter(), "/cmd_vel", &config)
    }

    #[test]
    fn the_only_topic_of_a_type_is_proposed() {
        let mut graph = Graph::default();
        assert_eq!(help(&graph, |_| {}), "");
        graph.writers.push(endpoint("/wheel_odom", "nav_msgs/msg/Odometry"));
        graph.writers.push(endpoint("/wheel_odom", "nav_msgs/msg/Odometry"));
        assert_eq!(help(&graph, |_| {}), "\nhelp: write `odom = \"/wheel_odom\"` into the file of --config");
        graph.readers.push(endpoint("/robot/cmd_vel", "geometry_msgs/msg/TwistStamped"));
        let expected = "\nhelp: write into the file of --config:\nodom = \"/wheel_odom\"\ncmd-vel = \"/robot/cmd_vel\"";
        assert_eq!(help(&graph, |_| {}), expected);
    }

    #[test]
    fn several_topics_of_a_type_are_a_choice() {
        let mut graph = Graph::default();
        for topic in ["/filtered", "/robot/odom"] {
            graph.writers.push(endpoint(topic, "nav_msgs/msg/Odometry"));
        }
        graph.readers.push(endpoint("/cmd_vel", TWIST));
        let expected = "\nhelp: write `odom = \"/robot/odom\" # or \"/filtered\"` into the file of --config";
        assert_eq!(help(&graph, |config| config.scan.clear()), expected);
        graph.writers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        graph.writers.push(endpoint("/estop", "std_msgs/msg/Bool"));
        let bool_bumper =
            |config: &mut Config| (config.bumper_type, config.bumper) = (BumperSource::Bool, "b".to_owned());
        assert_eq!(
            help(&graph, bool_bumper),
            "\nhelp: write `bumper = \"/estop\" # if that is the bumper` into the file of --config"
        );
    }

    #[test]
    fn range_sensors_are_proposed_once() {
        let mut graph = Graph::default();
        graph.readers.push(endpoint("/cmd_vel", TWIST));
        graph.writers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        graph.writers.push(endpoint("/front", "sensor_msgs/msg/Range"));
        let two_sensors = |config: &mut Config| {
            config.scan.clear();
            let sensor = |topic: &str| RangeSensor { topic: topic.to_owned(), x: 0.0, y: 0.0, yaw: 0.0 };
            config.ranges.0 = vec![sensor("r1"), sensor("r2")];
        };
        let expected = "\nhelp: write `ranges = [{ topic = \"/front\" }]` into the file of --config";
        assert_eq!(help(&graph, two_sensors), expected);
        graph.writers.push(endpoint("/rear", "sensor_msgs/msg/Range"));
        assert!(help(&graph, two_sensors).contains("`ranges = [{ topic = \"/front\" }] # also: \"/rear\"`"));
    }

    #[test]
    fn a_robot_in_a_namespace_is_found() {
        let mut graph = Graph::default();
        graph.writers.push(endpoint("/robot1/odom", "nav_msgs/msg/Odometry"));
        graph.writers.push(endpoint("/robot1/scan", "sensor_msgs/msg/LaserScan"));
        graph.readers.push(endpoint("/robot1/cmd_vel", TWIST));
        assert_eq!(help(&graph, |_| {}), "\nhelp: write `namespace = \"/robot1\"` into the file of --config");
        let help_of_absolute = help(&graph, |config| config.odom = "/odom".to_owned());
        assert!(help_of_absolute.contains("\nodom = \"/robot1/odom\"\n"), "{help_of_absolute}");
        graph.readers.push(endpoint("/robot2/cmd_vel", TWIST));
        assert!(help(&graph, |_| {}).contains("namespace = \"/robot1\""));
        graph.writers.push(endpoint("/robot2/odom", "nav_msgs/msg/Odometry"));
        graph.writers.push(endpoint("/robot2/scan", "sensor_msgs/msg/LaserScan"));
        assert!(help(&graph, |_| {}).contains("\nodom = \"/robot1/odom\" # or \"/robot2/odom\"\n"));
    }
}
