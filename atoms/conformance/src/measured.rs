//! Compares a measured number with the expected number, and names the probable cause of a difference.

use std::format;

use core::f64::consts::PI;

/// Factors of the most common unit errors, with their names.
const FACTORS: [(f64, &str); 10] = [
    (180.0 / PI, "degrees for radians"),
    (PI / 180.0, "radians for degrees"),
    (10.0, "tenths taken for wholes"),
    (0.1, "wholes taken for tenths"),
    (2.54, "inches for centimetres"),
    (1.0 / 2.54, "centimetres for inches"),
    (100.0, "centimetres for metres"),
    (1000.0, "millimetres for metres"),
    (2.0, "a diameter for a radius, or two sides added"),
    (0.5, "a radius for a diameter"),
];

/// Fraction of the expected number below which a measured number is treated as zero.
const NOTHING: f64 = 0.01;

/// A measured number, the expected number, and the texts for the message about a difference.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured<'a> {
    /// Text of the message before the number: the action, and the measured quantity.
    pub(super) what: &'a str,
    /// Unit of the quantity.
    pub(super) unit: &'a str,
    /// Name of the quantity that causes a wrong sign or scale, such as "the input".
    pub(super) whose: &'a str,
    pub(super) found: f64,
    pub(super) wanted: f64,
    /// Tolerance, in the same unit.
    pub(super) within: f64,
}

impl Measured<'_> {
    /// Checks that the measured number is within the tolerance.
    ///
    /// # Errors
    /// Fails with a message about the difference and its probable cause.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { what, unit, whose, found, wanted, within } = *self;
        if (found - wanted).abs() <= within {
            return Ok(());
        }
        Err(format!("{what} {found:.3} {unit} instead of {wanted:.3} {unit}{}", why(found, wanted, within, whose)))
    }
}

/// Returns the probable cause of a difference, as the end of a sentence; empty if no cause is known.
fn why(found: f64, wanted: f64, within: f64, whose: &str) -> String {
    let factor = found / wanted;
    if wanted.abs() <= within || !factor.is_finite() {
        return String::new();
    }
    if factor.abs() < NOTHING {
        return format!(": nothing comes of {whose}");
    }
    let is_scaled = (found.abs() - wanted.abs()).abs() > within;
    let what = match (factor < 0.0, is_scaled) {
        (true, true) => "a sign and a scale",
        (true, false) => "a sign",
        (false, _) => "a scale",
    };
    let is_about = |known: f64| (factor.abs() / known - 1.0).abs() < 0.04;
    let scale = match FACTORS.iter().find(|(known, _)| is_about(*known)) {
        _ if !is_scaled => String::new(),
        Some((_, name)) => format!(" (as with {name})"),
        None => format!(" ({:.3} times as much)", factor.abs()),
    };
    format!(": {what} in {whose}{scale}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_says_what_is_probably_wrong() {
        let message = |found| {
            let measured =
                Measured { what: "it went", unit: "m", whose: "the input", found, wanted: 0.4, within: 0.02 };
            measured.check().err().unwrap_or_default()
        };
        assert_eq!(message(0.41), "");
        assert_eq!(message(-0.4), "it went -0.400 m instead of 0.400 m: a sign in the input");
        assert_eq!(message(0.0), "it went 0.000 m instead of 0.400 m: nothing comes of the input");
        assert_eq!(
            message(4.0),
            "it went 4.000 m instead of 0.400 m: a scale in the input (as with tenths taken for wholes)"
        );
        assert_eq!(
            message(-0.6),
            "it went -0.600 m instead of 0.400 m: a sign and a scale in the input (1.500 times as much)"
        );
    }
}
