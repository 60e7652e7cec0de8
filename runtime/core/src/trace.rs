//! Formats a turn as a line of a trace: a JSON object with the transitions and the law
//! (docs/src/reference/interfaces.md, 4).

use core::fmt::{self, Write};

use crate::{Cause, Frame, Nanos, Plan, Radians, Transition};

/// A line of a trace, without the line break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<'a, F> {
    /// The number of the turn, counted from 0.
    pub turn: u64,
    /// Time of the turn.
    pub t: Nanos,
    /// State in which the turn ended, in the expanded plan, counted from 1.
    pub state: u64,
    /// The quark text of the law that was applied; `None` for the null input.
    pub law: Option<&'a str>,
    /// Frame of the law, if a `FRAME here` encloses its atom.
    pub frame: Option<Frame>,
    /// Transitions of the turn, in order: any iterator over [`Fired`].
    pub fired: F,
}

/// A transition in a trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fired<'a, O> {
    /// Number of the state left, in the expanded plan, counted from 1.
    pub from: u64,
    /// Number of scopes that enclose the scope that ended.
    pub level: usize,
    /// Condition text of the ended scope's interrupt, or [`COMPLETED`].
    pub by: &'a str,
    /// Condition texts of the interrupt's operands that have fired, in order; empty if the law completed.
    pub operands: O,
}

/// Text in a trace for a scope that ended because its law completed.
pub const COMPLETED: &str = "completed";

impl Cause {
    /// Returns the trace text for this cause; `condition` is the condition text of the scope's interrupt.
    #[must_use]
    pub const fn by(self, condition: &str) -> &str {
        match self {
            Self::Fired(_) => condition,
            Self::Completed(_) => COMPLETED,
        }
    }
}

impl Transition {
    /// Returns the trace text for the cause: the condition text of the scope's interrupt, or [`COMPLETED`].
    pub fn by<'p, P: Plan>(&self, plan: &'p P) -> &'p str {
        self.cause.by(plan.condition(self.scope))
    }

    /// Returns this transition of `plan` as a trace shows it, with the texts of the operands that have fired.
    pub fn fired<'p, P: Plan, O>(&self, plan: &'p P, operands: O) -> Fired<'p, O> {
        Fired { from: self.from, level: usize::from(self.cause.level()), by: self.by(plan), operands }
    }
}

impl<'a, F, O> fmt::Display for Line<'_, F>
where
    F: IntoIterator<Item = Fired<'a, O>> + Clone,
    O: IntoIterator<Item: AsRef<str>>,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{\"turn\":{},\"t\":{},\"state\":{},\"law\":", self.turn, Seconds(self.t), self.state)?;
        match self.law {
            Some(law) => write!(f, "{}", Json(law))?,
            None => f.write_str("null")?,
        }
        if let Some(frame) = self.frame {
            write!(f, ",\"frame\":{}", Degrees(frame.0))?;
        }
        f.write_str(",\"fired\":[")?;
        for (place, Fired { from, level, by, operands }) in self.fired.clone().into_iter().enumerate() {
            f.write_str(if place == 0 { "" } else { "," })?;
            write!(f, "{{\"from\":{from},\"level\":{level},\"by\":{},\"operands\":[", Json(by))?;
            for (place, operand) in operands.into_iter().enumerate() {
                write!(f, "{}{}", if place == 0 { "" } else { "," }, Json(operand.as_ref()))?;
            }
            f.write_str("]}")?;
        }
        f.write_str("]}")
    }
}

/// A time as a JSON number of seconds, with at least one decimal. It is exact, while an `f64` would lose
/// precision after some months.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seconds(pub Nanos);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nanos(nanos) = self.0;
        let (seconds, mut rest) = (nanos / 1_000_000_000, nanos % 1_000_000_000);
        write!(f, "{seconds}.")?;
        // Digit by digit, because a width that `write!` gets at run time adds code that can panic.
        loop {
            rest = rest.saturating_mul(10);
            write!(f, "{}", rest / 1_000_000_000)?;
            rest %= 1_000_000_000;
            if rest == 0 {
                return Ok(());
            }
        }
    }
}

/// A direction as a JSON number of degrees, above -180 and up to 180, rounded to a millionth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degrees(pub Radians);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const HALF: i64 = 180_000_000;
        let millionths = match libm::round(self.0.wrapped().degrees() * 1e6) as i64 {
            turned if turned <= -HALF => HALF,
            turned => turned,
        };
        let sign = if millionths < 0 { "-" } else { "" };
        write!(f, "{sign}{}", Seconds(Nanos(millionths.unsigned_abs().saturating_mul(1000))))
    }
}

/// A JSON string.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Json<'a>(pub &'a str);

impl fmt::Display for Json<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('"')?;
        for letter in self.0.chars() {
            match letter {
                '"' => f.write_str("\\\"")?,
                '\\' => f.write_str("\\\\")?,
                '\n' => f.write_str("\\n")?,
                '\r' => f.write_str("\\r")?,
                '\t' => f.write_str("\\t")?,
                '\u{8}' => f.write_str("\\b")?,
                '\u{c}' => f.write_str("\\f")?,
                control if control < ' ' => write!(f, "\\u{:04x}", u32::from(control))?,
                plain => f.write_char(plain)?,
            }
        }
        f.write_char('"')
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn lines_look_as_the_interface_says() {
        let none: [Fired<'_, [&str; 0]>; 0] = [];
        let line = Line { turn: 0, t: Nanos::ZERO, state: 1, law: Some("goAvoid 90 40 20"), frame: None, fired: none };
        assert_eq!(line.to_string(), r#"{"turn":0,"t":0.0,"state":1,"law":"goAvoid 90 40 20","fired":[]}"#);
        let fired = [
            Fired { from: 1, level: 2, by: COMPLETED, operands: &[][..] },
            Fired { from: 2, level: 0, by: "bumper OR path \"x\"", operands: &["bumper", "path \"x\""] },
        ];
        assert_eq!(
            Line { turn: 1, t: Nanos(100_000_000), state: 9, law: None, frame: None, fired }.to_string(),
            concat!(
                r#"{"turn":1,"t":0.1,"state":9,"law":null,"fired":[{"from":1,"level":2,"by":"completed","operands":[]},"#,
                r#"{"from":2,"level":0,"by":"bumper OR path \"x\"","operands":["bumper","path \"x\""]}]}"#
            )
        );
    }

    #[test]
    fn headings_are_written_in_degrees() {
        let line = |degrees: f64| {
            let frame = Some(Frame(Radians::from_degrees(degrees)));
            let fired: [Fired<'_, [&str; 0]>; 0] = [];
            Line { turn: 0, t: Nanos::ZERO, state: 1, law: Some("stop"), frame, fired }.to_string()
        };
        assert_eq!(line(90.0), r#"{"turn":0,"t":0.0,"state":1,"law":"stop","frame":90.0,"fired":[]}"#);
        let angles = [0.0, -22.5, 180.0, -180.0, 190.0, 720.25, 33.333_333_333, -1e-9];
        let angles = angles.map(|degrees| Degrees(Radians::from_degrees(degrees)).to_string());
        assert_eq!(angles, ["0.0", "-22.5", "180.0", "180.0", "-170.0", "0.25", "33.333333", "0.0"]);
    }

    #[test]
    fn seconds_are_exact_and_short() {
        let texts = [
            (0, "0.0"),
            (1, "0.000000001"),
            (100_000_000, "0.1"),
            (12_340_000_000, "12.34"),
            (7_000_000_000, "7.0"),
            (33_333_333, "0.033333333"),
            (1_000_000_001, "1.000000001"),
            (60_050_000_000, "60.05"),
            (u64::MAX, "18446744073.709551615"),
        ];
        for (nanos, text) in texts {
            assert_eq!(Seconds(Nanos(nanos)).to_string(), text);
        }
    }

    #[test]
    fn strings_are_escaped() {
        assert_eq!(Json(r#"path "a\b""#).to_string(), r#""path \"a\\b\"""#);
        assert_eq!(Json("a\nb\tc\rd\u{8}\u{c}\u{1}\u{7f}π").to_string(), "\"a\\nb\\tc\\rd\\b\\f\\u0001\u{7f}π\"");
    }
}
