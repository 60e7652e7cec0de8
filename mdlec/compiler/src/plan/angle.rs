//! Writes an angle in degrees if it is a number of degrees with at most six decimals (up to rounding errors).

use mdle_runtime::Radians;

/// Returns the angle in degrees, rounded to a millionth, if this rounding changes the angle by no more than the
/// rounding errors of a sum; `None` otherwise.
#[must_use]
pub fn in_degrees(radians: f64) -> Option<f64> {
    let degrees = (radians.to_degrees() * 1e6).round() / 1e6;
    ((Radians::from_degrees(degrees).0 - radians).abs() < 1e-12 * radians.abs().max(1.0)).then_some(degrees)
}

/// Prefix of an element whose frame is the robot's heading when the element is entered.
pub const HERE: &str = "FRAME here ";

/// Returns the prefix of an element whose frame is turned by this angle: `FRAME 30deg `, or an empty text for
/// zero.
#[must_use]
pub fn frame_text(radians: f64) -> String {
    match in_degrees(radians) {
        Some(0.0) => String::new(),
        Some(degrees) => format!("FRAME {degrees}deg "),
        None => format!("FRAME {radians}rad "),
    }
}

#[cfg(test)]
mod tests {
    use super::{Radians, frame_text, in_degrees};

    #[test]
    fn degrees_come_back_as_they_were_written() {
        for degrees in (-720..=720).map(|half| f64::from(half) / 2.0) {
            assert_eq!(in_degrees(Radians::from_degrees(degrees).0), Some(degrees));
        }
        assert_eq!([frame_text(0.0), frame_text(1.5)], ["", "FRAME 1.5rad "]);
        let sum = Radians::from_degrees(0.1).0 + Radians::from_degrees(0.2).0;
        assert_eq!(frame_text(sum), "FRAME 0.3deg ");
        assert_eq!(frame_text(Radians::from_degrees(30.0).0), "FRAME 30deg ");
    }
}
