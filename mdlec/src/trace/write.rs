//! Traces as JSON lines: the one form in which every machine tells what it did (semantics, section 9).

use std::fmt;

use mdle_runtime::Nanos;

/// What came of one turn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line<'p> {
    /// The number of the turn, from 0.
    pub turn: usize,
    /// Its time.
    pub t: Nanos,
    /// What the machine did in it.
    pub outcome: Outcome<'p>,
}

/// What a machine did in one turn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome<'p> {
    /// The state it ended in, numbered in the expanded plan.
    pub state: u64,
    /// The input it ended with.
    pub applied: Applied<'p>,
    /// Its transitions, in order.
    pub fired: Vec<Fired<'p>>,
}

/// The input of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Applied<'p> {
    /// The law of this quark text.
    Law(&'p str),
    /// The null input, because the limit of transitions cut the turn.
    Cut,
    /// The null input, because the plan is over.
    Over,
}

/// A transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fired<'p> {
    /// The state left.
    pub from: u64,
    /// How many scopes are around the one that ended.
    pub level: usize,
    /// The condition text of its interrupt, or [`Fired::COMPLETED`].
    pub by: &'p str,
}

impl Fired<'_> {
    /// What a scope ended by where only its law's completion did it.
    pub const COMPLETED: &'static str = "completed";
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outcome { state, applied, fired } = &self.outcome;
        write!(f, "{{\"turn\":{},\"t\":{},\"state\":{state},\"law\":", self.turn, Seconds(self.t))?;
        match applied {
            Applied::Law(text) => write!(f, "{}", Quoted(text))?,
            Applied::Cut | Applied::Over => f.write_str("null")?,
        }
        f.write_str(",\"fired\":[")?;
        for (place, Fired { from, level, by }) in fired.iter().enumerate() {
            let comma = if place == 0 { "" } else { "," };
            write!(f, "{comma}{{\"from\":{from},\"level\":{level},\"by\":{}}}", Quoted(by))?;
        }
        f.write_str("]}")
    }
}

/// A time in seconds: exact, which an `f64` is not after some months, and always with a point.
struct Seconds(Nanos);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nanos(nanos) = self.0;
        let digits = format!("{:09}", nanos % 1_000_000_000);
        let fraction = match digits.trim_end_matches('0') {
            "" => "0",
            fraction => fraction,
        };
        write!(f, "{}.{fraction}", nanos / 1_000_000_000)
    }
}

/// A JSON string.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&serde_json::to_string(self.0).map_err(|_| fmt::Error)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_look_as_the_interface_says() {
        let outcome = Outcome { state: 1, applied: Applied::Law("goAvoid 90 40 20"), fired: Vec::new() };
        let line = Line { turn: 0, t: Nanos::ZERO, outcome };
        assert_eq!(line.to_string(), r#"{"turn":0,"t":0.0,"state":1,"law":"goAvoid 90 40 20","fired":[]}"#);

        let fired =
            vec![Fired { from: 1, level: 2, by: "completed" }, Fired { from: 2, level: 0, by: "bumper OR path \"x\"" }];
        let line =
            Line { turn: 1, t: Nanos(100_000_000), outcome: Outcome { state: 9, applied: Applied::Over, fired } };
        assert_eq!(
            line.to_string(),
            concat!(
                r#"{"turn":1,"t":0.1,"state":9,"law":null,"fired":[{"from":1,"level":2,"by":"completed"},"#,
                r#"{"from":2,"level":0,"by":"bumper OR path \"x\""}]}"#
            )
        );
    }

    #[test]
    fn times_are_exact() {
        let texts = [(0, "0.0"), (1, "0.000000001"), (12_340_000_000, "12.34"), (u64::MAX, "18446744073.709551615")];
        for (nanos, text) in texts {
            assert_eq!(Seconds(Nanos(nanos)).to_string(), text);
        }
    }
}
