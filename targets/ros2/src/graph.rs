//! The topics of other programs on the graph, and sentences about missing topics.

use crate::config::Config;
use crate::names::{dds_topic, dds_type, ros_topic, ros_type};
use crate::source::Input;

/// Maximum number of topics in a list.
const LISTED: usize = 30;
/// Maximum number of missing topics in a message.
const MISSING: usize = 8;

/// A reader or writer of another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Name of the topic in DDS.
    pub topic: String,
    /// Name of the message type in DDS.
    pub kind: String,
    /// `true` if delivery is reliable: a reader then acknowledges messages, and a writer waits for acknowledgements.
    pub is_reliable: bool,
    /// Setting of the quality of service that does not match the driver's; `None` if all settings match.
    pub mismatch: Option<String>,
}

/// The readers and writers of other programs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Graph {
    /// Readers of other programs.
    pub readers: Vec<Endpoint>,
    /// Writers of other programs.
    pub writers: Vec<Endpoint>,
}

impl Graph {
    /// Returns the readers of the topic with this absolute name.
    pub fn readers_of(&self, topic: &str) -> impl Iterator<Item = &Endpoint> {
        let name = dds_topic(topic);
        self.readers.iter().filter(move |reader| reader.topic == name)
    }

    /// Returns the writers of the topic with this absolute name.
    pub fn writers_of(&self, topic: &str) -> impl Iterator<Item = &Endpoint> {
        let name = dds_topic(topic);
        self.writers.iter().filter(move |writer| writer.topic == name)
    }

    /// Returns the number of publishers that send messages of the type of `input` on the topic of `input`.
    #[must_use]
    pub fn publishers(&self, input: &Input) -> usize {
        let kind = dds_type(input.kind);
        self.writers_of(&input.topic).filter(|writer| writer.kind == kind).count()
    }

    /// Returns `true` if the topic of `input` has publishers, and all of them have the expected type and a matching
    /// quality of service.
    #[must_use]
    pub fn is_offered(&self, input: &Input) -> bool {
        let kind = dds_type(input.kind);
        let mut writers = self.writers_of(&input.topic).peekable();
        writers.peek().is_some() && writers.all(|writer| writer.kind == kind && writer.mismatch.is_none())
    }

    /// Returns a sentence that explains why no message of a topic could be used; `left_out` is the reason why a message
    /// was rejected.
    #[must_use]
    pub fn about_input(&self, input: &Input, left_out: &str) -> String {
        let Input { topic, kind, .. } = input;
        let writers: Vec<_> = self.writers_of(topic).collect();
        if let Some(other) = writers.iter().find(|writer| writer.kind != dds_type(kind)) {
            return format!("`{topic}` has messages of the type {}, and {kind} is expected", ros_type(&other.kind));
        }
        if let Some(policy) = writers.iter().find_map(|writer| writer.mismatch.as_ref()) {
            return format!("the publisher of `{topic}` offers another quality of service ({policy})");
        }
        match (writers.is_empty(), left_out.is_empty()) {
            (true, _) => format!("nobody publishes `{topic}` ({kind})"),
            (false, true) => format!("`{topic}` has a publisher, and no message has come"),
            (false, false) => format!("`{topic}` has messages that cannot be used: {left_out}"),
        }
    }

    /// Returns an error message about all missing topics, with the topics that are on the graph. If no other program is
    /// on the graph, the message reports only that.
    #[must_use]
    pub fn about_missing(&self, missing: &[String], config: &Config) -> String {
        let is_empty = !self.readers.iter().chain(&self.writers).any(|endpoint| ros_topic(&endpoint.topic).is_some());
        let listed = self.listed(config);
        if is_empty {
            return listed;
        }
        let more = missing.len().saturating_sub(MISSING);
        let more = if more == 0 { String::new() } else { format!("; {more} more topics are missing") };
        let missing: Vec<_> = missing.iter().take(MISSING).map(String::as_str).collect();
        format!("{}{more}; {listed}", missing.join("; "))
    }

    /// Returns a sentence that lists the topics on the graph. Topics with publishers come before topics with
    /// subscribers.
    #[must_use]
    pub fn listed(&self, config: &Config) -> String {
        let domain = config.domain;
        let lists = [("publishers", &self.writers), ("subscribers", &self.readers)];
        let lists = lists.map(|(who, endpoints)| listed_topics(endpoints).map(|topics| format!("{who} of {topics}")));
        let lists: Vec<_> = lists.into_iter().flatten().collect();
        if lists.is_empty() {
            let network = if config.network.is_empty() { "" } else { " and `network`" };
            return format!(
                "no program of ROS 2 answers in domain {domain}: compare `domain`{network} with ROS_DOMAIN_ID of the \
                 robot, and see that the network passes multicast"
            );
        }
        format!("domain {domain} has {}", lists.join(", and "))
    }
}

/// Returns a list of the topics of `endpoints`, with their types; `None` if no topic belongs to ROS 2.
fn listed_topics(endpoints: &[Endpoint]) -> Option<String> {
    let mut topics: Vec<_> = endpoints
        .iter()
        .filter_map(|endpoint| {
            ros_topic(&endpoint.topic).map(|topic| format!("{topic} ({})", ros_type(&endpoint.kind)))
        })
        .collect();
    topics.sort();
    topics.dedup();
    let more = topics.len().saturating_sub(LISTED);
    topics.truncate(LISTED);
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    (!topics.is_empty()).then(|| format!("{}{more}", topics.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configured;
    use crate::source::TopicPurpose;

    fn endpoint(topic: &str, kind: &str) -> Endpoint {
        Endpoint { topic: dds_topic(topic), kind: dds_type(kind), is_reliable: true, mismatch: None }
    }

    #[test]
    fn a_missing_topic_names_what_is_there() {
        let odom = Input {
            source: TopicPurpose::Odometry,
            topic: "/odom".to_owned(),
            kind: "nav_msgs/msg/Odometry",
            limit: 500,
        };
        let mut graph = Graph::default();
        assert_eq!(graph.about_input(&odom, ""), "nobody publishes `/odom` (nav_msgs/msg/Odometry)");
        assert!(!graph.is_offered(&odom));
        graph.writers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        assert_eq!(graph.about_input(&odom, ""), "`/odom` has a publisher, and no message has come");
        assert!(graph.is_offered(&odom));
        assert_eq!(graph.about_input(&odom, "9 bytes"), "`/odom` has messages that cannot be used: 9 bytes");
        graph.writers[0].mismatch = Some("Deadline".to_owned());
        assert!(graph.about_input(&odom, "").ends_with("offers another quality of service (Deadline)"));
        assert!(!graph.is_offered(&odom));
        graph.writers.push(endpoint("/odom", "geometry_msgs/msg/Pose"));
        assert!(graph.about_input(&odom, "").contains("of the type geometry_msgs/msg/Pose, and nav_msgs"));
        assert_eq!(graph.publishers(&odom), 1);
    }

    #[test]
    fn subscribers_are_listed_apart() {
        let config = Configured::read(None).unwrap().config;
        let mut graph = Graph::default();
        graph.readers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        assert_eq!(graph.listed(&config), "domain 0 has subscribers of /odom (nav_msgs/msg/Odometry)");
        graph.writers.push(endpoint("/odom", "nav_msgs/msg/Odometry"));
        let expected = "domain 0 has publishers of /odom (nav_msgs/msg/Odometry), and subscribers of /odom \
                        (nav_msgs/msg/Odometry)";
        assert_eq!(graph.listed(&config), expected);
    }

    #[test]
    fn an_empty_graph_names_the_settings() {
        let config = Configured::read(None).unwrap().config;
        let missing = ["nobody publishes `/odom`".to_owned()];
        assert!(
            Graph::default().about_missing(&missing, &config).starts_with("no program of ROS 2 answers in domain 0:")
        );
        assert!(Graph::default().listed(&config).contains("no program of ROS 2 answers in domain 0"));
        let mut graph = Graph::default();
        for number in 0..35 {
            graph.writers.push(endpoint(&format!("/t{number:02}"), "std_msgs/msg/Bool"));
        }
        let missing = graph.about_missing(&missing, &config);
        assert!(missing.starts_with("nobody publishes `/odom`; domain 0 has publishers of /t00 "), "{missing}");
        let listed = graph.listed(&config);
        let begins = listed.starts_with("domain 0 has publishers of /t00 (std_msgs/msg/Bool), /t01");
        assert!(begins && listed.ends_with("and 5 more"), "{listed}");
    }
}
