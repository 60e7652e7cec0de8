//! Checks configuration values that are valid individually but not in combination.

use mdle_serial::shortened;

use super::{Config, has_topic};
use crate::choices::{BumperSource, RANGES};
use crate::local_addresses;
use crate::names::is_namespace;

impl Config {
    /// Checks conditions on the values that cannot be expressed as the range of a single value.
    pub(super) fn check(&self) -> Result<(), String> {
        local_addresses::read(&self.network)?;
        self.check_topics()?;
        if self.bumper_type == BumperSource::Scan && self.scan.is_empty() {
            return Err("`bumper-type` is \"scan\", and there is no `scan`".to_owned());
        }
        self.check_body()
    }

    /// Checks that the body fits into a circle with the radius `body_radius`.
    fn check_body(&self) -> Result<(), String> {
        let Self { body_radius, half_length, half_width, .. } = self;
        for (key, half) in [("half-length", half_length), ("half-width", half_width)] {
            if half > body_radius {
                return Err(format!(
                    "`{key}` is {half} m, and `body-radius` is {body_radius} m: it is the radius of the smallest \
                     circle around the body, so no less than {half} m"
                ));
            }
        }
        Ok(())
    }

    /// Checks that every topic has a valid name and that no two topics have the same name.
    fn check_topics(&self) -> Result<(), String> {
        if !is_namespace(&self.namespace) {
            return Err(format!(
                "`namespace` is `{}`, and has to be words of letters, digits and `_` between slashes, such as \
                 `/robot1`, or empty",
                shortened(&self.namespace)
            ));
        }
        let mut named: Vec<(&str, String)> = Vec::new();
        let clock = self.use_sim_time.then_some(("use-sim-time", "/clock"));
        for (key, name) in self.topics().chain(clock) {
            if name.is_empty() {
                return Err(empty(key));
            }
            let topic = self.topic(name).map_err(|why| format!("`{key}`: {why}"))?;
            if let Some((other, _)) = named.iter().find(|(_, known)| *known == topic) {
                let keys = if *other == key { format!("two of `{key}`") } else { format!("`{other}` and `{key}`") };
                return Err(format!("{keys} are the same topic, `{topic}`; each needs a topic of its own"));
            }
            named.push((key, topic));
        }
        Ok(())
    }

    /// Returns the topics that are in use, each with the configuration key that names it.
    fn topics(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let published = [("state", self.state.as_str()), ("diagnostics", self.diagnostics.as_str())];
        self.robot_topics().chain(published.into_iter().filter(|(_, topic)| !topic.is_empty()))
    }

    /// Returns the topics that are in use and that the robot provides, each with the configuration key that names it.
    pub(crate) fn robot_topics(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let optional = [("scan", &self.scan), ("battery", &self.battery)];
        let optional = optional.into_iter().filter(|(_, topic)| !topic.is_empty());
        let required = [("cmd-vel", &self.cmd_vel), ("odom", &self.odom)].into_iter();
        let required = required.chain(has_topic(self.bumper_type).then_some(("bumper", &self.bumper)));
        let required = required.chain(self.ranges.0.iter().map(|sensor| (RANGES, &sensor.topic)));
        required.chain(optional).map(|(key, topic)| (key, topic.as_str()))
    }
}

/// Returns the error message about a key that is empty although a topic is required.
fn empty(key: &str) -> String {
    match key {
        "bumper" => "`bumper` is empty: write the topic that `bumper-type` needs, as in `bumper = \"bumper\"`, or \
                     `bumper-type = \"none\"`"
            .to_owned(),
        "ranges" => "a sensor in `ranges` has an empty `topic`: write the topic of its messages".to_owned(),
        key => format!(
            "`{key}` is empty, and no plan can drive without it: write the topic, as in `{key} = \"{}\"`",
            key.replace('-', "_")
        ),
    }
}
