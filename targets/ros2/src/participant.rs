//! The driver's DDS participant, and its readers and writers.

use std::net::IpAddr;
use std::time::Duration;

use rustdds::no_key::{DataWriter, SimpleDataReader};
use rustdds::policy::{Durability, History};
use rustdds::{
    DataWriterStatus, DomainParticipant, DomainParticipantBuilder, GUID, Publisher, QosPolicies, QosPolicyBuilder,
    RTPSEntity, StatusEvented, Subscriber, Topic, TopicKind,
};

use crate::cdr::Payload;
use crate::config::Config;
use crate::fault::Fault;
use crate::graph::{Endpoint, Graph};
use crate::local_addresses;
use crate::names::{dds_topic, dds_type};
use crate::payload_adapter::PayloadAdapter;

/// Maximum number of messages that a reader stores between two turns.
const KEPT: i32 = 16;
/// Maximum number of commands that a subscriber may leave unacknowledged; the next command is then rejected. At 50 Hz,
/// this number corresponds to 20 s, after which a dead program has left the graph.
const UNACKNOWLEDGED: i32 = 1000;
/// Maximum number of states of the plan that a subscriber may leave unacknowledged. A subscriber that joins late
/// receives the same number of states.
const STATES: i32 = 8;
/// Maximum time for which a writer waits for space in its queue.
const BLOCKING: rustdds::Duration = rustdds::Duration::from_millis(1);

/// A DDS participant.
pub(crate) struct Participant {
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
}

/// A reader of one topic.
pub(crate) struct Reader(SimpleDataReader<Payload, PayloadAdapter>);

/// A writer of one topic.
pub(crate) struct Writer {
    writer: DataWriter<Payload, PayloadAdapter>,
    /// Number of subscribers that the middleware has connected to this writer.
    matched: i32,
}

/// A received message, with the id of its writer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Arrival {
    pub(crate) payload: Payload,
    pub(crate) writer: [u8; 16],
}

/// Delivery guarantee of a topic's messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delivery {
    /// Best effort: only the newest message is relevant, and any message may be lost.
    BestEffort,
    /// Reliable: every message arrives.
    Reliable,
    /// Reliable and latched: every message arrives, and subscribers that join later also receive the last messages.
    Latched,
}

impl Delivery {
    fn qos(self, depth: i32) -> QosPolicies {
        let builder = QosPolicyBuilder::new().history(History::KeepLast { depth });
        match self {
            Self::BestEffort => builder.durability(Durability::Volatile).best_effort(),
            Self::Reliable => builder.durability(Durability::Volatile).reliable(BLOCKING),
            Self::Latched => builder.durability(Durability::TransientLocal).reliable(BLOCKING),
        }
        .build()
    }
}

impl Participant {
    /// Joins the DDS domain of `config`.
    pub(crate) fn join(config: &Config) -> Result<Self, Fault> {
        let failed = |what: &str| {
            let domain = config.domain;
            Fault::Middleware(format!("the network of ROS 2 cannot be used (domain {domain}): {what}"))
        };
        let domain = u16::try_from(config.domain).map_err(|_| failed("there is no such domain"))?;
        let mut builder = DomainParticipantBuilder::new(domain);
        if let Some(address) = local_addresses::read(&config.network).map_err(Fault::Network)? {
            local_addresses::check(address).map_err(Fault::Network)?;
            builder = builder.with_only_networks([IpAddr::V4(address)]);
        }
        let participant = builder.build().map_err(|error| failed(&plain(&error.to_string())))?;
        let qos = QosPolicyBuilder::new().build();
        let publisher = participant.create_publisher(&qos).map_err(|error| failed(&error.to_string()))?;
        let subscriber = participant.create_subscriber(&qos).map_err(|error| failed(&error.to_string()))?;
        Ok(Self { participant, publisher, subscriber })
    }

    /// Subscribes to the topic with this absolute name.
    pub(crate) fn reader(&self, topic: &str, kind: &str, delivery: Delivery) -> Result<Reader, Fault> {
        let qos = delivery.qos(KEPT);
        let dds = self.topic(&dds_topic(topic), kind, &qos)?;
        let reader = self.subscriber.create_simple_datareader_no_key(&dds, Some(qos));
        reader.map(Reader).map_err(|error| refused(topic, &error.to_string()))
    }

    /// Creates a writer for the topic with this absolute name.
    pub(crate) fn writer(&self, topic: &str, kind: &str, delivery: Delivery) -> Result<Writer, Fault> {
        self.dds_writer(&dds_topic(topic), kind, delivery)
    }

    /// Creates a writer for the topic with this DDS name.
    pub(crate) fn dds_writer(&self, topic: &str, kind: &str, delivery: Delivery) -> Result<Writer, Fault> {
        let qos = match delivery {
            Delivery::BestEffort | Delivery::Reliable => delivery.qos(UNACKNOWLEDGED),
            Delivery::Latched => delivery.qos(STATES),
        };
        let dds = self.topic(topic, kind, &qos)?;
        let writer = self.publisher.create_datawriter_no_key(&dds, Some(qos));
        let writer = writer.map_err(|error| refused(topic, &error.to_string()))?;
        Ok(Writer { writer, matched: 0 })
    }

    fn topic(&self, name: &str, kind: &str, qos: &QosPolicies) -> Result<Topic, Fault> {
        let topic = self.participant.create_topic(name.to_owned(), dds_type(kind), qos, TopicKind::NoKey);
        topic.map_err(|error| refused(name, &error.to_string()))
    }

    /// Returns the id of the participant.
    pub(crate) fn gid(&self) -> [u8; 16] {
        self.participant.guid().to_bytes()
    }

    /// Returns the readers and writers of other programs.
    pub(crate) fn graph(&self) -> Graph {
        let own = |guid: GUID| guid.prefix == self.participant.guid().prefix;
        let endpoint = |topic: &str, kind: &str, qos: &QosPolicies| Endpoint {
            topic: topic.to_owned(),
            kind: kind.to_owned(),
            is_reliable: qos.is_reliable(),
            mismatch: None,
        };
        let readers = self.participant.discovered_readers();
        let readers = readers.iter().filter(|reader| !own(reader.reader_proxy.remote_reader_guid)).map(|reader| {
            let data = &reader.subscription_topic_data;
            let mismatch = Delivery::Reliable.qos(1).compliance_failure_wrt(&data.qos());
            let mismatch = mismatch.map(|policy| format!("{policy:?}"));
            Endpoint { mismatch, ..endpoint(data.topic_name(), data.type_name(), &data.qos()) }
        });
        let writers = self.participant.discovered_writers();
        let writers = writers.iter().filter(|writer| !own(writer.writer_proxy.remote_writer_guid)).map(|writer| {
            let data = &writer.publication_topic_data;
            let mismatch = data.qos().compliance_failure_wrt(&Delivery::BestEffort.qos(1));
            let mismatch = mismatch.map(|policy| format!("{policy:?}"));
            Endpoint { mismatch, ..endpoint(data.topic_name(), &data.type_name, &data.qos()) }
        });
        Graph { readers: readers.collect(), writers: writers.collect() }
    }
}

/// Extracts the operating system's error text from the middleware's message `error`, which contains this text in Rust's
/// debug format. If there is no such text, returns `error` unchanged.
fn plain(error: &str) -> String {
    let code = error.split_once("Os { code: ").and_then(|(_, rest)| rest.split_once(','));
    let code = code.and_then(|(code, _)| code.parse().ok());
    code.map_or_else(|| error.to_owned(), |code| std::io::Error::from_raw_os_error(code).to_string())
}

/// Returns the fault about a topic that the middleware could not create.
fn refused(topic: &str, why: &str) -> Fault {
    Fault::Middleware(format!("`{topic}` cannot be used: {why}"))
}

impl Reader {
    /// Returns the next message that has arrived; `None` if no message has arrived.
    pub(crate) fn take(&self) -> Option<Arrival> {
        self.0.drain_read_notifications();
        loop {
            match self.0.try_take_one() {
                Ok(Some(sample)) => {
                    let writer = sample.writer_guid().to_bytes();
                    return Some(Arrival { payload: sample.into_value(), writer });
                }
                Ok(None) => return None,
                // Skips a message that cannot be read, for example one that is not in CDR format.
                Err(_) => {}
            }
        }
    }

    /// Returns the id of the reader.
    pub(crate) fn gid(&self) -> [u8; 16] {
        self.0.guid().to_bytes()
    }
}

impl Writer {
    /// Publishes a message.
    pub(crate) fn write(&self, payload: Payload) -> Result<(), String> {
        self.writer.write(payload, None).map_err(|error| error.to_string())
    }

    /// Waits until all reliable subscribers have acknowledged all messages. Returns `false` if the time `within` passes
    /// first.
    pub(crate) fn is_acknowledged(&self, within: Duration) -> bool {
        self.writer.wait_for_acknowledgments(within).unwrap_or(false)
    }

    /// Returns the number of subscribers that the middleware has connected to this writer.
    pub(crate) fn matched(&mut self) -> i32 {
        while let Some(status) = self.writer.try_recv_status() {
            if let DataWriterStatus::PublicationMatched { current, .. } = status {
                self.matched = current.count();
            }
        }
        self.matched
    }

    /// Returns the id of the writer.
    pub(crate) fn gid(&self) -> [u8; 16] {
        self.writer.guid().to_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_system_are_plain_words() {
        let error = "Internal error: Os { code: 92, kind: Uncategorized, message: \"Protocol not available\" }";
        assert_eq!(plain(error), "Protocol not available (os error 92)");
        assert_eq!(plain("there is no such domain"), "there is no such domain");
    }
}
