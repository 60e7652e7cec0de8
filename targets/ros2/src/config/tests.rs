//! Tests that configurations are read, printed and rejected.

use std::fs;
use std::path::PathBuf;

use super::*;
use crate::capabilities::Capabilities;

/// Writes a configuration file with this name and text.
fn file(name: &str, text: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("mdle-ros2-{}-{name}.toml", std::process::id()));
    fs::write(&path, text).unwrap();
    path
}

fn read(name: &str, text: &str) -> Result<Config, String> {
    let path = file(name, text);
    let configured = Configured::read(Some(&path));
    fs::remove_file(path).unwrap();
    configured.map(|configured| configured.config)
}

#[test]
fn a_domain_of_the_environment_is_a_number() {
    assert_eq!(["", " ", "0", " 7 ", "232"].map(domain_of), [0, 0, 0, 7, 232].map(Ok));
    for text in ["233", "-1", "robot", "7.0", "99999999999999999999"] {
        let refused = domain_of(text).unwrap_err();
        assert!(
            refused.contains(&format!("ROS_DOMAIN_ID is `{text}`, and has to be a number from 0 to 232")),
            "{refused}"
        );
    }
}

/// Returns the example configurations of the book.
fn examples() -> Vec<(&'static str, &'static str)> {
    let book = include_str!("../../../../docs/src/ros2.md");
    let blocks = book.split("```toml,").skip(1);
    blocks.map(|block| block.split_once("```").unwrap().0.split_once('\n').unwrap()).collect()
}

#[test]
fn the_examples_of_the_book_are_read() {
    let configs: Vec<_> = examples().iter().map(|(name, text)| read(name, text).expect(name)).collect();
    assert_eq!(configs.len(), 4);
    let has = |config: &Config| Capabilities::of(config).suffice(&["goAvoid 90 2 20", "bumper", "lowBattery"]);
    let blind: Vec<_> = configs.iter().map(|config| has(config).is_err()).collect();
    assert_eq!(blind, [false, false, true, false]);
    assert_eq!(configs[3].topic(&configs[3].odom).unwrap(), "/a200_0000/platform/odom");
    assert_eq!(configs[3].shape().half_length, Meters(0.5));
}

#[test]
fn what_is_printed_is_read_again() {
    for (name, text) in examples().into_iter().chain([("ranges", "ranges = [{ topic = \"a\", x = 0.1, yaw = -1.5 }]")])
    {
        // Another test uses files with the plain names at the same time.
        let path = file(&format!("{name}-printed"), text);
        let first = Configured::read(Some(&path)).unwrap();
        assert_eq!(read(&format!("{name}-again"), &first.to_string()), Ok(first.config), "{name}");
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn the_default_domain_is_printed_as_a_comment() {
    let printed = Configured::read(None).unwrap().to_string();
    assert!(printed.contains("\n# domain = 0 ") && !printed.contains("\ndomain"), "{printed}");
    let path = file("domain", "domain = 7");
    let printed = Configured::read(Some(&path)).unwrap().to_string();
    fs::remove_file(path).unwrap();
    assert!(printed.contains("\ndomain = 7 "), "{printed}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    for (text, sentence) in [
        ("stamped = \"maybe\"", "`stamped` is \"maybe\", and has to be true or false or \"auto\""),
        ("domain = 233", "`domain` is 233, and has to be a whole number from 0 to 232"),
        ("bumper-type = \"bool\"\nbumper = \"\"", "`bumper` is empty: write the topic that `bumper-type` needs"),
        ("odom = \"\"", "`odom` is empty, and no plan can drive without it: write the topic, as in `odom = \"odom\"`"),
        ("bumper-type = \"button\"", "has to be \"none\" or \"bool\" or \"hazard\" or \"scan\""),
        (
            "ranges = [{ topic = \"a\", yaw = 700 }]",
            "`yaw` of the range sensor `a` is 700, and has to be a number from -6.3",
        ),
        (
            "ranges = [{ topic = \"a\", z = 1 }]",
            "`ranges` is [{ topic = \"a\", z = 1 }], and has to be a list of sensors { topic = ",
        ),
        ("namespace = \"a b\"", "`namespace` is `a b`, and has to be words of letters, digits and `_` between slashes"),
        ("half-length = 0.5", "`half-length` is 0.5 m, and `body-radius` is 0.18 m: it is the radius of the smallest"),
        ("body-radius = 0.3\nhalf-width = 0.4", "`half-width` is 0.4 m, and `body-radius` is 0.3 m"),
        ("domain = -1", "`domain` is -1, and has to be a whole number from 0 to 232"),
        ("domain = 7.0", "`domain` is 7.0, and has to be a whole number"),
        ("fastest = \"quick\"", "`fastest` is \"quick\", and has to be a number from 0.01 to 2 m/s"),
        ("fastest = nan", "`fastest` is NaN, and has to be a number from 0.01 to 2 m/s"),
        ("jump = inf", "`jump` is inf, and has to be a number from 0.01 to 100 m"),
        ("odom = 7", "`odom` is 7, and has to be a text in quotes"),
        ("use-sim-time = \"yes\"", "`use-sim-time` is \"yes\", and has to be true or false"),
        ("stamped = 1", "`stamped` is 1, and has to be true or false or \"auto\""),
        ("bumper-type = \"hazards\"", "\"hazard\" or \"scan\"; did you mean `hazard`?"),
        (
            "cmd_vel = \"a\"",
            "there is no key `cmd_vel`; did you mean `cmd-vel`?\nhelp: the keys are distribution, domain",
        ),
        ("odom = ", "line 1: "),
        ("state = \"cmd_vel\"", "`cmd-vel` and `state` are the same topic, `/cmd_vel`; each needs a topic of its own"),
        ("odom = \"scan\"", "`odom` and `scan` are the same topic, `/scan`"),
        ("namespace = \"a\"\nstate = \"/a/odom\"", "`odom` and `state` are the same topic, `/a/odom`"),
        ("odom = \"/clock\"\nuse-sim-time = true", "`odom` and `use-sim-time` are the same topic, `/clock`"),
        ("ranges = [{ topic = \"a\" }, { topic = \"/a\" }]", "two of `ranges` are the same topic, `/a`"),
    ] {
        let refused = read("refused", text).unwrap_err();
        assert!(refused.contains(sentence), "{text}: {refused}");
    }
}

#[test]
fn messages_about_numbers_are_short() {
    let digits = "9".repeat(300);
    for text in [
        format!("fastest = {digits}.0"),
        format!("fastest = -{digits}.0"),
        format!("domain = {digits}"),
        "fastest = 1e999".to_owned(),
        "fastest = -1e999".to_owned(),
        "fastest = inf".to_owned(),
        "domain = 0xffffffffffffffffffff".to_owned(),
        "fastest = 0x1p3".to_owned(),
        "ranges = [{ topic = \"a\", x = inf }]".to_owned(),
        format!("ranges = [{{ topic = \"a\", yaw = {digits}.0 }}]"),
        format!("{digits} = 7"),
        format!("namespace = \"{digits}\""),
        format!("network = \"{digits}\""),
        format!("odom = \"{digits}\""),
        format!("stamped = \"{digits}\""),
    ] {
        let refused = read("numbers", &text).unwrap_err();
        let longest = refused.split(['`', ' ']).map(str::len).max();
        assert!(longest < Some(120), "{refused}");
    }
}
