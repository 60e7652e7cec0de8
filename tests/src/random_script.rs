//! Generates random scripts as text, with irregular times, interrupts that come and go, and laws that complete.

use std::fmt::Write;

use mdle_scripted::{INTERRUPTS, LAWS};

use crate::chance::Chance;
use crate::signals::Values;

/// Steps between turns in seconds: zero, lengths of timers, and steps that differ from them by a nanosecond.
const STEPS: &[&str] =
    &["0", "0.05", "0.1", "0.1", "0.1", "0.099999999", "0.100000001", "0.25", "0.299999999", "1", "2.500000001", "7"];

/// Distances driven between turns in metres, chosen like [`STEPS`].
const WAYS: &[&str] =
    &["0", "0", "0.05", "0.1", "0.1", "0.099999999", "0.100000001", "0.01", "0.25", "0.299999999", "1.000000001"];

/// Headings in degrees.
const HEADINGS: &[&str] = &["0", "90", "-90", "180", "-179.5", "33.25", "0.001"];

/// Returns a random script with `turns` turns for the target `scripted`.
pub fn script(chance: &mut Chance, turns: usize) -> String {
    let mut text = String::new();
    let mut nanos: u64 = if chance.percent(80) { 0 } else { 1_234_567_890 };
    let mut way: u64 = if chance.percent(80) { 0 } else { 1_234_567_890 };
    let mut heading = chance.pick(HEADINGS);
    let mut fired = vec![false; INTERRUPTS.len()];
    // Laws that never complete are included: this must have no effect.
    let mut completed = vec![false; LAWS.len()];
    // Probabilities, in this script, that interrupts fire and laws complete, and that they change between turns.
    let often = [2, 5, 10, 20, 40, 70][chance.below(6)];
    let done = [2, 5, 20, 60][chance.below(4)];
    let restless = [10, 50, 100][chance.below(3)];
    let mut values = Values::new(chance);
    for _ in 0..turns {
        change(chance, &mut fired, often, restless);
        if chance.percent(restless) {
            values = Values::new(chance);
        }
        change(chance, &mut completed, done, restless);
        let (seconds, fraction) = (nanos / 1_000_000_000, nanos % 1_000_000_000);
        let odometer = format!("\"way\": {}.{:09}, \"heading\": {heading}", way / 1_000_000_000, way % 1_000_000_000);
        let compared: String = values.texts().iter().map(|text| format!("{text:?}, ")).collect();
        let (fired, completed) = (quoted(INTERRUPTS, &fired), quoted(LAWS, &completed));
        let fired = if fired.is_empty() { compared.trim_end_matches(", ").to_owned() } else { compared + &fired };
        writeln!(
            text,
            "{{\"t\": {seconds}.{fraction:09}, {odometer}, \"fired\": [{fired}], \"completed\": [{completed}]}}"
        )
        .unwrap();
        let step: f64 = chance.pick(STEPS).parse().unwrap();
        nanos += (step * 1e9).round() as u64;
        let step: f64 = chance.pick(WAYS).parse().unwrap();
        way += (step * 1e9).round() as u64;
        if chance.percent(restless) {
            heading = chance.pick(HEADINGS);
        }
    }
    text
}

fn change(chance: &mut Chance, reports: &mut [bool], often: usize, restless: usize) {
    for report in reports {
        if chance.percent(restless) {
            *report = chance.percent(often);
        }
    }
}

fn quoted(texts: &[&str], reports: &[bool]) -> String {
    let listed = texts.iter().zip(reports).filter(|(_, reported)| **reported);
    listed.map(|(text, _)| format!("{text:?}")).collect::<Vec<_>>().join(", ")
}
