//! The summary of several runs: the number of runs with each outcome, the times of runs, and a command that repeats the
//! first run of each group.

use std::fmt::{self, Write as _};
use std::time::Duration;

use mdle_runtime::Nanos;
use mdle_runtime::trace::{Json, Seconds};

use crate::call::quoted;
use crate::outcome::{EndedRun, RunOutcome};
use crate::report::Over;
use crate::run_end;

/// Runs of a batch, in the order of their seeds.
pub(crate) struct Summary<'a> {
    pub(crate) runs: &'a [EndedRun],
    /// Number of requested runs. It is higher than the number of runs made if a signal ended the batch.
    pub(crate) asked: u64,
    /// Seed of the first run.
    pub(crate) first: u64,
    /// Function that returns the options that repeat the run with a given seed alone.
    pub(crate) alone: &'a dyn Fn(u64) -> Vec<String>,
    /// Time limit of the runs; `None` if an option limits them.
    pub(crate) timeout: Option<Duration>,
    /// Command line of the program before its options, as typed in a shell.
    pub(crate) program: &'a str,
}

impl RunOutcome {
    const NAMES: [&'static str; 7] = ["ended", "arrived", "bumped", "astray", "ended otherwise", "timed out", "failed"];

    fn name(&self) -> &'static str {
        let [ended, arrived, bumped, astray, otherwise, timed_out, failed] = Self::NAMES;
        match self {
            Self::Ended => ended,
            Self::Arrived => arrived,
            Self::Bumped => bumped,
            Self::Astray(_) => astray,
            Self::Otherwise => otherwise,
            Self::TimedOut => timed_out,
            Self::Failed(_) => failed,
        }
    }

    /// Returns `true` if the run ended as required.
    fn is_good(&self) -> bool {
        match self {
            Self::Ended | Self::Arrived => true,
            Self::Bumped | Self::Astray(_) | Self::Otherwise | Self::TimedOut | Self::Failed(_) => false,
        }
    }
}

impl Summary<'_> {
    /// Returns the exit status of a batch that no signal has ended.
    pub(crate) fn status(&self) -> u8 {
        if self.count("failed") > 0 {
            run_end::FAULT
        } else if self.good().count() as u64 == self.asked {
            run_end::OVER
        } else {
            run_end::MISSED
        }
    }

    fn count(&self, name: &str) -> u64 {
        self.runs.iter().filter(|run| run.outcome.name() == name).count() as u64
    }

    /// Returns the number of contacts, and the number of runs with contacts.
    fn contacts(&self) -> (u64, usize) {
        let touched = self.runs.iter().filter(|run| run.contacts > 0);
        (touched.clone().map(|run| run.contacts).sum(), touched.count())
    }

    /// Returns the runs that ended as required.
    fn good(&self) -> impl Iterator<Item = &EndedRun> {
        self.runs.iter().filter(|run| run.outcome.is_good())
    }

    /// Returns the median time of the runs that ended as required, and the slowest of these runs; `None` if no run
    /// ended as required.
    fn times(&self) -> Option<(Nanos, &EndedRun)> {
        let mut good: Vec<&EndedRun> = self.good().collect();
        // The sort is stable: among runs with equal times, the run with the first seed comes first.
        good.sort_by_key(|run| run.t);
        let worst = *good.last()?;
        let worst = good.iter().find(|run| run.t == worst.t).copied().unwrap_or(worst);
        let middle = |at: usize| good.get(at).map_or(Nanos::ZERO, |run| run.t);
        let (low, high) = (middle((good.len() - 1) / 2), middle(good.len() / 2));
        Some((Nanos(low.0 + (high.0 - low.0) / 2), worst))
    }

    /// Returns the command that repeats a run alone.
    fn command(&self, run: &EndedRun) -> String {
        let timeout = self.timeout.filter(|_| run.outcome == RunOutcome::TimedOut);
        let timeout = timeout.map(|timeout| ["--timeout".to_owned(), timeout.as_secs().to_string()]);
        let options = (self.alone)(run.seed).into_iter().chain(timeout.into_iter().flatten());
        options.fold(self.program.to_owned(), |command, word| command + " " + &quoted(&word))
    }

    /// Returns groups of similar runs, in the order of the first seed of each group. Runs that reached their goal are
    /// omitted.
    fn groups(&self) -> Vec<OutcomeGroup<'_>> {
        let mut groups: Vec<OutcomeGroup<'_>> = Vec::new();
        for run in self.runs.iter().filter(|run| run.outcome != RunOutcome::Arrived) {
            match groups.iter_mut().find(|group| group.holds(run)) {
                Some(group) => group.count += 1,
                None => groups.push(OutcomeGroup { first: run, count: 1 }),
            }
        }
        groups
    }

    /// Returns the summary as a JSON object, without a line break.
    pub(crate) fn json(&self) -> String {
        let mut json = format!("{{\"runs\":{},\"done\":{},\"first_seed\":{}", self.asked, self.runs.len(), self.first);
        for name in RunOutcome::NAMES {
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
            let EndedRun { seed, outcome, t, over, contacts } = run;
            let name = outcome.name().replace(' ', "_");
            let between = if number == 0 { "" } else { "," };
            let _ = write!(json, "{between}{{\"seed\":{seed},\"outcome\":{},\"t\":{}", Json(&name), Seconds(*t));
            let Over { cause, by, operands, .. } = over.clone().unwrap_or_default();
            let operands: Vec<_> = operands.iter().map(|operand| Json(operand).to_string()).collect();
            let (by, operands, cause) = (Json(&by), operands.join(","), Json(&cause));
            let _ = write!(json, ",\"by\":{by},\"operands\":[{operands}],\"cause\":{cause}");
            let _ = write!(json, ",\"contacts\":{contacts}");
            if let RunOutcome::Astray(message) | RunOutcome::Failed(message) = outcome {
                let _ = write!(json, ",\"said\":{}", Json(message));
            }
            let _ = write!(json, ",\"command\":{}}}", Json(&self.command(run)));
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
        write!(f, "{}, seeds {} to {last}", count_text(self.asked, "run"), self.first)?;
        let counts = RunOutcome::NAMES.into_iter().map(|name| (name, self.count(name)));
        for (number, (name, count)) in counts.filter(|(_, count)| *count > 0).enumerate() {
            write!(f, "{} {count} {name}", if number == 0 { ":" } else { "," })?;
        }
        writeln!(f)?;
        if let Some((median, worst)) = self.times() {
            let (median, slowest) = (median.seconds(), worst.t.seconds());
            let what = if worst.outcome == RunOutcome::Arrived { "time to arrive" } else { "time" };
            writeln!(f, "{what}: median {median:.1} s, worst {slowest:.1} s (seed {})", worst.seed)?;
        }
        let (contacts, runs) = self.contacts();
        if contacts > 0 {
            writeln!(f, "{} in {}", count_text(contacts, "contact"), count_text(runs as u64, "run"))?;
        }
        for group in self.groups() {
            writeln!(f, "\n{group}\n  {}", self.command(group.first))?;
        }
        Ok(())
    }
}

/// Runs with the same outcome and the same cause.
struct OutcomeGroup<'a> {
    first: &'a EndedRun,
    count: u64,
}

impl OutcomeGroup<'_> {
    /// Returns `true` if a run belongs to the group. Measured values and positions are ignored, because they differ
    /// from run to run.
    fn holds(&self, run: &EndedRun) -> bool {
        let is_alike = match (&self.first.outcome, &run.outcome) {
            (RunOutcome::Astray(_), RunOutcome::Astray(_)) => true,
            (one, other) => one == other,
        };
        is_alike && self.first.over.as_ref().map(|over| &over.words) == run.over.as_ref().map(|over| &over.words)
    }
}

impl fmt::Display for OutcomeGroup<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let EndedRun { seed, outcome, t, over, .. } = self.first;
        write!(f, "{} {}", self.count, outcome.name())?;
        match (outcome, over) {
            (RunOutcome::Failed(sentence), _) => write!(f, ": {sentence}")?,
            (RunOutcome::Ended, Some(over)) => write!(f, " by {}", over.words)?,
            (_, Some(over)) => write!(f, ", plan over: {}", over.words)?,
            (_, None) => {}
        }
        write!(f, "; {}seed {seed} at {:.1} s", if self.count > 1 { "the first is " } else { "" }, t.seconds())?;
        match outcome {
            RunOutcome::Astray(place) => write!(f, ", {place}"),
            RunOutcome::Ended
            | RunOutcome::Arrived
            | RunOutcome::Bumped
            | RunOutcome::Otherwise
            | RunOutcome::TimedOut
            | RunOutcome::Failed(_) => Ok(()),
        }
    }
}

fn count_text(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
