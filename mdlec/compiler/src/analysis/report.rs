//! Writes an analysis, either as text with the figures of the plan and tables of its scopes and atoms, or as JSON.

use std::fmt::Write;

use super::{Analysis, AtomAnswer, Duration, Reach, ScopeAnswer};

/// Maximum number of enclosing scopes that the report lists as causes of an atom's end.
const AROUND: usize = 3;

impl Analysis {
    /// Returns the analysis as a JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialization fails only for maps with keys that are not strings, and there are none.
        serde_json::to_string_pretty(self).map(|text| text + "\n").unwrap_or_default()
    }

    /// Returns the analysis as text for users.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = self.figures();
        let scopes = self.scopes.iter().map(scope_row).collect::<Vec<_>>();
        text += "\n";
        text += &table(["scope", "atoms", "can end by", "never ends by"], &scopes);
        text += "\n";
        let atoms = self.atoms.iter().map(|atom| self.atom_row(atom)).collect::<Vec<_>>();
        text += &table(["atom", "state", "law", "runs", "can end by", "never ends by"], &atoms);
        text
    }

    /// Returns the figures of the plan as text for users, without the tables of scopes and atoms.
    #[must_use]
    pub fn figures(&self) -> String {
        let Self { plan, states, atom_count, interrupts, depth, loop_depth, transitions, bytes, .. } = self;
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:22}{value}");
        };
        line("plan", plan.clone());
        line("states", format!("{states}: {} in all, and the end", count(states - 1, "atom")));
        line(
            "as written",
            format!("{}, {}", count(*atom_count as u64, "atom"), count(*interrupts as u64, "interrupt")),
        );
        line("nesting", format!("{}, {}", count(*depth as u64, "scope"), count(*loop_depth as u64, "loop")));
        line("transitions a turn", format!("{transitions} at most"));
        line(
            "reaction",
            match self.reaction_turns {
                Some(turns) => count(turns, "turn"),
                None => "not bounded: a loop without end may be searched round and round".to_owned(),
            },
        );
        line("shortest", self.shortest.map_or_else(|| "it never ends".to_owned(), |time| format!("{time} s")));
        line("longest", longest(&self.longest));
        let memories = if bytes.memories > 0 { format!(", {} to remember", bytes.memories) } else { String::new() };
        line("bytes of state", format!("{}{memories}, and those of the law that runs", bytes.state));
        line("bytes of tables", format!("{}, and {} of texts ({})", bytes.machine, bytes.texts, bytes.form));
        text
    }

    fn atom_row(&self, atom: &AtomAnswer) -> Vec<String> {
        let mut ends = atom.ended_by.clone();
        let mut around = std::iter::successors(self.scopes.get(atom.within.wrapping_sub(1)), |scope| {
            self.scopes.get(scope.within?.wrapping_sub(1))
        })
        .filter(|scope| !scope.ended_by.is_empty() && atom.reach != Reach::Never);
        for scope in around.by_ref().take(AROUND) {
            let name = if scope.name.is_empty() { "the scope around it" } else { scope.name.as_str() };
            ends.push(format!("{} ({name})", scope.ended_by.join(" OR ")));
        }
        let more = around.count();
        if more > 0 {
            ends.push(format!("{more} more around"));
        }
        let ends = if ends.is_empty() { "nothing".to_owned() } else { ends.join(", ") };
        let ends = if atom.reach == Reach::Never { String::new() } else { ends };
        let reach = match atom.reach {
            Reach::Runs => "yes",
            Reach::Skipped => "skipped",
            Reach::Never => "never",
        };
        let numbers = [atom.atom.to_string(), atom.state.to_string()];
        [&numbers[..], &[atom.law.clone(), reach.to_owned(), ends, atom.never_by.join(", ")]].concat()
    }
}

fn scope_row(scope: &ScopeAnswer) -> Vec<String> {
    let [first, last] = scope.atoms;
    let atoms = if first == last { first.to_string() } else { format!("{first}-{last}") };
    let name = if scope.name.is_empty() { "_" } else { scope.name.as_str() };
    let ends = if scope.ended_by.is_empty() { "its last element".to_owned() } else { scope.ended_by.join(", ") };
    let ends = match scope.reach {
        Reach::Runs => ends,
        Reach::Skipped => "skipped".to_owned(),
        Reach::Never => "never reached".to_owned(),
    };
    vec![name.to_owned(), atoms, ends, scope.never_by.join(", ")]
}

fn longest(longest: &Duration) -> String {
    match (longest.seconds, longest.turns, &longest.because) {
        (Some(seconds), Some(0), _) => format!("{seconds} s"),
        (Some(seconds), Some(turns), _) => format!("{seconds} s and {}", count(turns, "turn")),
        (_, _, Some(because)) => format!("not bounded: {because}"),
        (_, _, None) => "not bounded".to_owned(),
    }
}

/// Returns a number followed by its noun: `1 atom`, `2 atoms`.
fn count(number: u64, thing: &str) -> String {
    if number == 1 { format!("1 {thing}") } else { format!("{number} {thing}s") }
}

/// Formats rows as a table. Each column is as wide as its widest cell, up to the length of a line. An empty last column
/// is omitted.
fn table<const COLUMNS: usize>(heads: [&str; COLUMNS], rows: &[Vec<String>]) -> String {
    const WIDEST: usize = 48;
    let shown = if rows.iter().all(|row| row.last().is_none_or(String::is_empty)) { COLUMNS - 1 } else { COLUMNS };
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count()).filter(|width| *width <= WIDEST);
        cells.chain([heads[column].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..shown).map(width).collect();
    let line = |cells: Vec<&str>| {
        let cells: String = cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}  ")).collect();
        format!("{}\n", cells.trim_end())
    };
    let lines = rows.iter().map(|row| line(row.iter().take(shown).map(String::as_str).collect()));
    line(heads.into_iter().take(shown).collect()) + &lines.collect::<String>()
}
