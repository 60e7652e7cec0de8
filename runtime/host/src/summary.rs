//! What is said of several runs: how many arrived and how fast, and how each of the others can be run again.

use std::fmt::{self, Write as _};
use std::time::Duration;

use mdle_runtime::Nanos;
use mdle_runtime::trace::{Json, Seconds};

use crate::batch::{Done, Outcome};
use crate::ending;
use crate::report::Over;

/// The runs of a batch, in the order of their seeds.
pub(crate) struct Summary<'a> {
    pub(crate) runs: &'a [Done],
    /// How many there were to be: more, if a signal ended the batch.
    pub(crate) asked: u64,
    /// The first seed.
    pub(crate) first: u64,
    /// The options with which the run of a seed is made alone.
    pub(crate) alone: &'a dyn Fn(u64) -> Vec<String>,
    /// When runs were given up that no option limits.
    pub(crate) timeout: Option<Duration>,
    /// What the executable was called as.
    pub(crate) program: &'a str,
}

impl Outcome {
    const NAMES: [&'static str; 5] = ["arrived", "bumped", "astray", "timed out", "failed"];

    fn name(&self) -> &'static str {
        let [arrived, bumped, astray, timed_out, failed] = Self::NAMES;
        match self {
            Self::Arrived => arrived,
            Self::Bumped => bumped,
            Self::Astray(_) => astray,
            Self::TimedOut => timed_out,
            Self::Failed(_) => failed,
        }
    }
}

impl Summary<'_> {
    /// The exit status of the batch, if no signal ended it.
    pub(crate) fn status(&self) -> u8 {
        if self.count("failed") > 0 {
            ending::FAULT
        } else if self.count("arrived") == self.asked {
            ending::OVER
        } else {
            ending::MISSED
        }
    }

    fn count(&self, name: &str) -> u64 {
        self.runs.iter().filter(|run| run.outcome.name() == name).count() as u64
    }

    /// How often something was touched, and in how many runs.
    fn contacts(&self) -> (u64, usize) {
        let touched = self.runs.iter().filter(|run| run.contacts > 0);
        (touched.clone().map(|run| run.contacts).sum(), touched.count())
    }

    /// The median of the times of those that arrived, and the slowest of them.
    fn times(&self) -> Option<(Nanos, &Done)> {
        let mut arrived: Vec<&Done> = self.runs.iter().filter(|run| run.outcome == Outcome::Arrived).collect();
        // The first of equals is the one with the first seed: sorting keeps their order.
        arrived.sort_by_key(|run| run.t);
        let worst = *arrived.last()?;
        let worst = arrived.iter().find(|run| run.t == worst.t).copied().unwrap_or(worst);
        let middle = |at: usize| arrived.get(at).map_or(Nanos::ZERO, |run| run.t);
        let (low, high) = (middle((arrived.len() - 1) / 2), middle(arrived.len() / 2));
        Some((Nanos(low.0 + (high.0 - low.0) / 2), worst))
    }

    /// The command that makes a run alone.
    fn command(&self, run: &Done) -> String {
        let timeout = self.timeout.filter(|_| run.outcome == Outcome::TimedOut);
        let timeout = timeout.map(|timeout| ["--timeout".to_owned(), timeout.as_secs().to_string()]);
        let options = (self.alone)(run.seed).into_iter().chain(timeout.into_iter().flatten());
        options.fold(quoted(self.program), |command, word| command + " " + &quoted(&word))
    }

    /// The runs that did not arrive.
    fn missed(&self) -> impl Iterator<Item = &Done> {
        self.runs.iter().filter(|run| run.outcome != Outcome::Arrived)
    }

    /// The summary as a JSON object, without the line break.
    pub(crate) fn json(&self) -> String {
        let mut json = format!("{{\"runs\":{},\"done\":{},\"first_seed\":{}", self.asked, self.runs.len(), self.first);
        for name in Outcome::NAMES {
            let _ = write!(json, ",{}:{}", Json(&name.replace(' ', "_")), self.count(name));
        }
        let _ = write!(json, ",\"contacts\":{}", self.contacts().0);
        match self.times() {
            Some((median, worst)) => {
                let (median, worst, seed) = (Seconds(median), Seconds(worst.t), worst.seed);
                let _ = write!(json, ",\"median\":{median},\"worst\":{worst},\"worst_seed\":{seed}");
            }
            None => json += ",\"median\":null,\"worst\":null,\"worst_seed\":null",
        }
        json += ",\"each\":[";
        for (number, run) in self.runs.iter().enumerate() {
            let Done { seed, outcome, t, over, contacts } = run;
            let name = outcome.name().replace(' ', "_");
            let between = if number == 0 { "" } else { "," };
            let _ = write!(json, "{between}{{\"seed\":{seed},\"outcome\":{},\"t\":{}", Json(&name), Seconds(*t));
            let Over { cause, by, operands, .. } = over.clone().unwrap_or_default();
            let operands: Vec<_> = operands.iter().map(|operand| Json(operand).to_string()).collect();
            let (by, operands, cause) = (Json(&by), operands.join(","), Json(&cause));
            let _ = write!(json, ",\"by\":{by},\"operands\":[{operands}],\"cause\":{cause}");
            let _ = write!(json, ",\"contacts\":{contacts}");
            if let Outcome::Astray(said) | Outcome::Failed(said) = outcome {
                let _ = write!(json, ",\"said\":{}", Json(said));
            }
            if *outcome != Outcome::Arrived {
                let _ = write!(json, ",\"command\":{}", Json(&self.command(run)));
            }
            json.push('}');
        }
        json + "]}"
    }
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let done = self.runs.len() as u64;
        let last = self.first.wrapping_add(self.asked.saturating_sub(1));
        if done < self.asked {
            write!(f, "{done} of ")?;
        }
        write!(f, "{}, seeds {} to {last}:", counted(self.asked, "run"), self.first)?;
        let counts = Outcome::NAMES.map(|name| (name, self.count(name)));
        // How many arrived is said whatever it is; the rest only where there is something to say.
        let said = counts.iter().enumerate().filter(|(number, (_, count))| *number == 0 || *count > 0);
        for (number, (name, count)) in said.map(|(_, count)| count).enumerate() {
            write!(f, "{} {count} {name}", if number == 0 { "" } else { "," })?;
        }
        writeln!(f)?;
        if let Some((median, worst)) = self.times() {
            let (median, slowest) = (median.seconds(), worst.t.seconds());
            writeln!(f, "time to arrive: median {median:.1} s, worst {slowest:.1} s (seed {})", worst.seed)?;
        }
        let (contacts, runs) = self.contacts();
        if contacts > 0 {
            writeln!(f, "{} in {}", counted(contacts, "contact"), counted(runs as u64, "run"))?;
        }
        for run in self.missed() {
            writeln!(f, "\nseed {}: {}\n  {}", run.seed, Missed(run), self.command(run))?;
        }
        Ok(())
    }
}

/// How a run went that did not arrive.
struct Missed<'a>(&'a Done);

impl fmt::Display for Missed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Done { outcome, t, over, .. } = self.0;
        let by = over.as_ref().map_or("", |over| &over.cause);
        write!(f, "{} at {:.1} s", outcome.name(), t.seconds())?;
        match outcome {
            Outcome::Arrived | Outcome::TimedOut => Ok(()),
            Outcome::Bumped => write!(f, ", plan over: {by}"),
            Outcome::Astray(place) => write!(f, ", {place}, plan over: {by}"),
            Outcome::Failed(said) => write!(f, ": {said}"),
        }
    }
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./,=:+@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
