//! Tests which rules a safety file contains, and which errors are reported.

use super::*;

/// A safety file with every rule.
const WHOLE: &str = r#"
[limits]
speed = "40cm/s"
turn_rate = "90deg/s"
acceleration = "1m/s2"

[[fence]]
inside = [[-0.5, -0.5], [2, -0.5], [2, 0.5], [-0.5, 0.5]]
margin = "3cm"
deceleration = "0.5m/s2"

[contact]
then = "retreat.mdle"

[stale]
output = "400ms"
module = "2s"
then = "hold"

[overrun]
turns = 10
then = "end"

[guards.near]
when = "r0 < 20cm AND v > 5cm/s"
then = "hold forward"

[guards.far]
when = "x > 5m"
then = "retreat.mdle"
"#;

#[test]
fn a_file_has_its_rules_in_si_units() {
    let rules = read(WHOLE).unwrap();
    insta::assert_debug_snapshot!(rules);
    assert_eq!(read("# nothing\n"), Ok(Rules::default()));
}

#[test]
fn a_wrong_file_is_refused_with_line_and_cure() {
    let wrong = [
        "speed = \"40cm/s\"",
        "[limit]\nspeed = \"40cm/s\"",
        "[limits]\nturnrate = \"40cm/s\"",
        "[limits]\nspeed = 0.4",
        "[limits]\nspeed = \"0.4\"",
        "[limits]\nspeed = \"40 cm/s\"",
        "[limits]\nspeed = \"40deg/s\"",
        "[limits]\nspeed = \"40knots\"",
        "[limits]\n\nacceleration = \"0m/s2\"",
        "[limits]\nspeed = \"-3m/s\"",
        "[limits]\nspeed = \"NaNm/s\"",
        "limits = 3",
        "[limits",
        "[fence]\ninside = []",
        "[[fence]]\nmargin = \"1cm\"",
        "[[fence]]\ninside = [[0, 0], [1, 0]]\ndeceleration = \"1m/s2\"",
        "[[fence]]\ninside = [[0, 0], [1, 0], [1, \"1m\"]]\ndeceleration = \"1m/s2\"",
        "[[fence]]\ninside = [[0, 0], [1, 0], [1, inf]]\ndeceleration = \"1m/s2\"",
        "[[fence]]\ninside = [[0, 0], [1, 0], [1, 1]]",
        "[[fence]]\ninside = [[0, 0], [1, 1], [1, 0], [0, 1]]\ndeceleration = \"1m/s2\"",
        "[[fence]]\ninside = [[0, 0], [1, 0], [1, 1], [0, 1]]\nmargin = \"50cm\"\ndeceleration = \"1m/s2\"",
        "[[fence]]\ninside = [[0, 0], [1, 0], [1, 1], [0, 1]]\nmargin = \"-1cm\"\ndeceleration = \"1m/s2\"",
        "[contact]",
        "[contact]\nthen = \"stop\"",
        "[contact]\nthen = true",
        "[stale]\nthen = \"hold\"",
        "[stale]\noutput = \"0s\"\nthen = \"hold\"",
        "[stale]\noutput = \"1s\"\nthen = \"hold forward\"",
        "[stale]\nmodule = \"2m\"\nthen = \"hold\"",
        "[overrun]\nturns = 0\nthen = \"end\"",
        "[overrun]\nturns = 2.5\nthen = \"end\"",
        "[guards]\nnear = \"r0 < 1m\"",
        "[guards.near]\nthen = \"hold\"",
        "[guards.near]\nwhen = 3\nthen = \"hold\"",
        "[guards.near]\nwhen = \"bumper\"",
        "[guards.contact]\nwhen = \"bumper\"\nthen = \"hold\"",
        "[guards.\"a/b\"]\nwhen = \"bumper\"\nthen = \"hold\"",
        "[limits]\nspeed = \"1m/s\"\nspeed = \"2m/s\"",
    ];
    let refusals = wrong.map(|text| format!("{text}\n  → {}\n", read(text).unwrap_err()));
    insta::assert_snapshot!(refusals.join("\n"));
}
