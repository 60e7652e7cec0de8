//! Synonyms of quark names: words that users type before they know an alphabet.

/// Names of quarks, each with a list of synonyms.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("go", &["forward", "drive", "move", "ahead", "straight", "forwards", "run", "velocity"]),
    ("goAvoid", &["goto", "moveTo", "driveTo", "navigate", "avoid"]),
    ("turn", &["left", "right", "spin", "rotateBy"]),
    ("rotate", &["face", "heading", "turnTo"]),
    ("stop", &["halt", "brake", "stand", "idle", "still"]),
    ("Follow", &["follow", "chase"]),
    ("wait", &["sleep", "delay", "pause", "timeout", "timer", "after_time"]),
    ("bumper", &["bump", "contact", "touch", "collision", "hit", "crash"]),
    ("lowBattery", &["batteryLow", "low"]),
    ("r", &["range", "sonar", "distance", "dist", "obstacle"]),
    ("way", &["distance", "dist", "driven", "odometer", "travelled", "traveled", "mileage"]),
    ("t", &["time", "elapsed", "seconds", "clock"]),
    ("theta", &["heading", "yaw", "angle", "orientation", "direction"]),
    ("v", &["speed", "velocity"]),
    ("battery", &["voltage", "volts"]),
];

/// Returns the names of the quarks that have `name` as a synonym.
pub(super) fn meant(name: &str) -> impl Iterator<Item = &'static str> {
    let is_meant = move |words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(name));
    SYNONYMS.iter().filter(move |(_, words)| is_meant(words)).map(|(quark, _)| *quark)
}
