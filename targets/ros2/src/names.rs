//! Converts names of topics and types between ROS 2 and DDS.

/// Returns the absolute name of a topic; a relative name is placed in `namespace`.
///
/// # Errors
/// Returns the reason, as a sentence, if `name` is not a valid topic name.
pub fn absolute(namespace: &str, name: &str) -> Result<String, String> {
    let whole = match namespace.trim_matches('/') {
        _ if name.starts_with('/') => name.to_owned(),
        "" => format!("/{name}"),
        namespace => format!("/{namespace}/{name}"),
    };
    if whole.split('/').skip(1).all(is_word) {
        Ok(whole)
    } else {
        let name = mdle_serial::shortened(name);
        Err(format!("`{name}` is no name of a topic: words of letters, digits and `_` between slashes"))
    }
}

/// Returns `true` if `text` is a valid namespace. It may be empty, and may have a slash at each end.
#[must_use]
pub fn is_namespace(text: &str) -> bool {
    let words = text.strip_prefix('/').unwrap_or(text);
    let words = words.strip_suffix('/').unwrap_or(words);
    words.is_empty() || words.split('/').all(is_word)
}

/// Returns `true` if `word` is valid as a part of a name between two slashes.
fn is_word(word: &str) -> bool {
    let starts = word.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    starts && word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

/// Returns the DDS name of the ROS topic with this absolute name.
#[must_use]
pub fn dds_topic(absolute: &str) -> String {
    format!("rt{absolute}")
}

/// Returns the DDS name of a type, such as `std_msgs/msg/Bool`.
#[must_use]
pub fn dds_type(ros: &str) -> String {
    let parts: Vec<_> = ros.split('/').collect();
    match parts.as_slice() {
        [package, folder, name] => format!("{package}::{folder}::dds_::{name}_"),
        [..] => ros.to_owned(),
    }
}

/// Returns the ROS name of a DDS topic; `None` if the topic does not belong to ROS 2.
#[must_use]
pub fn ros_topic(dds: &str) -> Option<&str> {
    dds.strip_prefix("rt").filter(|name| name.starts_with('/'))
}

/// Returns the ROS name of a DDS type; a type that does not belong to ROS 2 keeps its name.
#[must_use]
pub fn ros_type(dds: &str) -> String {
    dds.replace("::dds_::", "::").trim_end_matches('_').replace("::", "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_relative_to_the_namespace() {
        for (namespace, name, whole) in [
            ("", "odom", "/odom"),
            ("/", "odom", "/odom"),
            ("a200_0000", "platform/odom", "/a200_0000/platform/odom"),
            ("/robot/", "/clock", "/clock"),
        ] {
            assert_eq!(absolute(namespace, name).as_deref(), Ok(whole));
        }
        for wrong in ["", "2nd", "a b", "a//b", "a/", "größe", "~/x"] {
            assert!(absolute("", wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_namespace_has_words_between_slashes() {
        assert!(["", "/", "a", "/a", "a/", "/robot1/base_2/"].iter().all(|text| is_namespace(text)));
        assert!(["a b", "//a", "a//b", "1", "größe", "~"].iter().all(|text| !is_namespace(text)));
    }

    #[test]
    fn names_of_dds_come_back() {
        assert_eq!(dds_topic("/odom"), "rt/odom");
        assert_eq!(dds_type("nav_msgs/msg/Odometry"), "nav_msgs::msg::dds_::Odometry_");
        assert_eq!(ros_type("nav_msgs::msg::dds_::Odometry_"), "nav_msgs/msg/Odometry");
        assert_eq!((ros_topic("rt/odom"), ros_topic("ros_discovery_info")), (Some("/odom"), None));
    }
}
