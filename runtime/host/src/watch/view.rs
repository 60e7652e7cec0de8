//! Formats the text around the map: time and position above it, and the current atom with its enclosing scopes below
//! it.

use mdle_runtime::{Pose, Printable};

use crate::{EnclosingScope, PlanPosition};

/// Maximum number of scopes in the view. The outermost and the innermost scopes are shown, because they are most
/// important.
const SCOPES_MOST: usize = 4;
/// Width of a bar, in characters.
const BAR: usize = 20;

/// Data that the live view shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Now {
    pub(super) pose: Pose,
    pub(super) touches: bool,
    pub(super) contacts: u64,
    seconds: f64,
    atom: String,
    scopes: Vec<ViewedScope>,
}

/// A scope in the live view.
#[derive(Debug, Clone, PartialEq)]
struct ViewedScope {
    title: String,
    seconds: f64,
    /// Time in the scope's `wait`, in seconds; `None` if its condition has no `wait`.
    wait: Option<f64>,
}

impl Now {
    /// Updates the data with the current position in the plan.
    pub(super) fn stands(&mut self, standing: &PlanPosition<'_>) {
        self.seconds = standing.t.seconds();
        let place = if standing.place.is_empty() { String::new() } else { format!("  ({})", standing.place) };
        let since = if standing.since.is_empty() { String::new() } else { format!("  <- {}", standing.since) };
        self.atom = format!("{}{place}{since}", standing.law);
        self.scopes = standing.scopes.iter().map(ViewedScope::of).collect();
        let middle = 1..self.scopes.len().saturating_sub(SCOPES_MOST - 2).max(1);
        if self.scopes.len() > SCOPES_MOST {
            let title = format!("… {} more …", middle.len());
            let seconds = self.scopes.get(1).map_or(0.0, |scope| scope.seconds);
            self.scopes.splice(middle, [ViewedScope { title, seconds, wait: None }]);
        }
    }

    /// Returns the line above the map.
    pub(super) fn above(&self, columns: usize) -> String {
        let (x, y) = (self.pose.x.0, self.pose.y.0);
        let heading = libm::round(self.pose.theta.degrees()) + 0.0;
        let touches = match (self.touches, self.contacts) {
            (true, _) => "  contact!".to_owned(),
            (false, 0) => String::new(),
            (false, contacts) => format!("  contacts: {contacts}"),
        };
        let text = format!(" {:.1} s  at ({x:.2}, {y:.2}) heading {heading}{touches}", self.seconds);
        format!("\x1b[7m{:<columns$}", cut(&text, columns))
    }

    /// Returns the lines below the map.
    pub(super) fn below(&self, columns: usize) -> Vec<String> {
        let mut lines = vec![format!("\x1b[1m{}", cut(&self.atom, columns))];
        let widest = self.scopes.iter().map(|scope| scope.title.chars().count()).max().unwrap_or(0);
        let room = columns.saturating_sub(BAR + 26).max(8).min(widest);
        lines.extend(self.scopes.iter().map(|scope| scope.line(room, columns)));
        lines.push(format!("\x1b[2m{}", cut("Ctrl-C stops the robot", columns)));
        lines
    }
}

impl ViewedScope {
    fn of(around: &EnclosingScope<'_>) -> Self {
        // `null` never fires.
        let condition = if around.condition == "null" { "" } else { around.condition };
        let title = match (around.name, condition) {
            ("", "") => "atom".to_owned(),
            ("", condition) => format!("until {condition}"),
            (name, "") => name.to_owned(),
            (name, condition) => format!("{name} until {condition}"),
        };
        Self { title, seconds: around.since.seconds(), wait: wait(around.condition) }
    }

    fn line(&self, room: usize, columns: usize) -> String {
        let bar = self.wait.map_or_else(String::new, |wait| {
            let part = if wait > 0.0 { (self.seconds / wait).clamp(0.0, 1.0) } else { 1.0 };
            let full = libm::round(part * BAR as f64) as usize;
            format!("  {}{}  of {wait} s", "█".repeat(full), "░".repeat(BAR - full))
        });
        cut(&format!("  {:<room$} {:>8.1} s{bar}", cut(&self.title, room), self.seconds), columns)
    }
}

/// Returns the time, in seconds, of the first `wait` in the text of a condition; `None` if there is no `wait` or its
/// time is not a number.
fn wait(condition: &str) -> Option<f64> {
    let words: Vec<&str> = condition.split([' ', '(', ')']).filter(|word| !word.is_empty()).collect();
    let at = words.iter().position(|word| *word == "wait")?;
    words.get(at + 1)?.parse().ok().filter(|seconds: &f64| seconds.is_finite())
}

/// Returns the longest beginning of a text that fits into `room` characters.
fn cut(text: &str, room: usize) -> String {
    let text = Printable(text).to_string();
    if text.chars().count() <= room {
        text
    } else {
        text.chars().take(room.saturating_sub(1)).chain(['…']).take(room).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::Nanos;

    fn now(scopes: usize) -> Now {
        let around = |number: usize| EnclosingScope {
            name: if number == 0 {
                "LabTour"
            } else if number + 1 == scopes {
                ""
            } else {
                "Lab2ToLab1Plan"
            },
            condition: ["null", "bumper", "atIsection 0100 OR wait 7.5"][number.min(2)],
            since: Nanos(1_500_000_000 * (scopes - number) as u64),
        };
        let scopes = (0..scopes).map(around).collect();
        let mut now = Now { contacts: 2, ..Now::default() };
        let (place, since) = ("tour.mdle:12, pass 2 of 3".to_owned(), "wait 7s (tour.mdle:11)");
        now.stands(&PlanPosition { t: Nanos(73_800_000_000), state: 5, law: "go 0 0.36", place, since, scopes });
        now
    }

    #[test]
    fn the_words_tell_what_runs_and_how_long() {
        let now = now(3);
        let text = format!("{}\n{}", now.above(60), now.below(78).join("\n"));
        insta::assert_snapshot!(text.replace('\x1b', "^"));
    }

    #[test]
    fn many_scopes_and_narrow_screens_are_cut() {
        let all = now(30);
        assert_eq!(all.scopes.len(), SCOPES_MOST);
        assert!(all.scopes[1].title.contains("27 more"), "{:?}", all.scopes);
        for columns in [0, 1, 5, 20, 60, 200] {
            for line in all.below(columns).iter().chain([&all.above(columns)]) {
                let plain = line.split('m').skip(usize::from(line.starts_with('\x1b'))).collect::<Vec<_>>().join("m");
                assert!(plain.chars().count() <= columns, "{columns}: {line:?}");
            }
        }
    }

    #[test]
    fn a_wait_is_found_in_its_condition() {
        assert_eq!(wait("wait 7"), Some(7.0));
        assert_eq!(wait("(atIsection 1000 OR wait 0.5) AND bumper"), Some(0.5));
        assert_eq!([wait("wait inf"), wait("bumper"), wait("wait")], [None; 3]);
    }
}
