//! Writes the string of a machine as MDLe text: a plan with one atom per line, followed by the number and name of the
//! atom's state.

use std::cmp::Reverse;
use std::fmt::Write;

use super::names::{MachineTexts, UsedNames, in_a_comment, texts};
use super::{Found, InterruptId, Machine, ScopeRun};

/// Maximum nesting depth of brackets in a plan. Deeper parts become separate plans, which are used by name.
const DEPTH: usize = 100;

/// A scope or a loop, with the range of positions that it encloses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Enclosed {
    first: usize,
    last: Reverse<usize>,
    /// Rank of the scope or loop among those with the same range. A loop is inside the scopes that lead out of it, and
    /// encloses the scopes that lead back to its start.
    rank: Rank,
    interrupt: Option<InterruptId>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    LeadsOut,
    Loop,
    LeadsBack,
}

/// Returns the text of the string `found` of a machine.
#[must_use]
pub fn string(machine: &Machine, found: &Found) -> String {
    let (texts, mut names) = texts(machine);
    let main = names.name("Decompiled");
    let mut enclosed: Vec<_> = found.runs.iter().map(enclosed_by).collect();
    enclosed.extend(found.loops.iter().map(|repeated| Enclosed {
        first: repeated.first,
        last: Reverse(repeated.last),
        rank: Rank::Loop,
        interrupt: None,
    }));
    enclosed.sort_unstable();
    if let Some(completed) = completed(machine, &enclosed) {
        enclosed.retain(|one| one.interrupt != Some(completed));
    }
    let last = found.order.len().saturating_sub(2);
    let root = enclosed.first().copied().filter(|one| one.first == 0 && one.last.0 == last && one.rank != Rank::Loop);
    // A plan cannot consist of an atom alone.
    let root = root.filter(|_| last > 0 || enclosed.len() > 1);
    let rest = if root.is_some() { &enclosed[1..] } else { &enclosed[..] };
    let condition = root.and_then(|root| root.interrupt).map_or("null", |interrupt| condition(&texts, interrupt));
    let mut writer =
        StringWriter { machine, found, texts: &texts, names, plans: vec![String::new()], open: Vec::new() };
    for (name, means) in &texts.renamed {
        let _ = writeln!(writer.plans[0], "// {name}: {}", in_a_comment(means));
    }
    let _ = writeln!(writer.plans[0], "{{ {main} ({condition})");
    writer.write(rest);
    let end = in_a_comment(machine.name(machine.end()));
    let _ = writeln!(writer.plans[0], "}}    // {}: {end}", found.order.len());
    writer.plans.concat()
}

fn enclosed_by(run: &ScopeRun) -> Enclosed {
    let rank = if run.to == run.first { Rank::LeadsBack } else { Rank::LeadsOut };
    Enclosed { first: run.first, last: Reverse(run.last), rank, interrupt: Some(run.interrupt) }
}

/// Returns the interrupt that fires when a law completes, if the plan need not contain it. This is the case if it
/// encloses only single atoms, and leads to the same states as the atoms' own interrupts.
fn completed(machine: &Machine, enclosed: &[Enclosed]) -> Option<InterruptId> {
    let completed = machine.completed()?;
    let mut own = enclosed.chunk_by(|one, other| (one.first, one.last) == (other.first, other.last));
    let is_plain = own.all(|alike| {
        let Some(found) = alike.iter().find(|one| one.interrupt == Some(completed)) else { return true };
        let is_innermost = alike.iter().all(|one| one.rank <= found.rank);
        found.first == found.last.0 && is_innermost
    });
    is_plain.then_some(completed)
}

fn condition(texts: &MachineTexts, interrupt: InterruptId) -> &str {
    &texts.conditions[interrupt.0 as usize]
}

/// An open bracket, the content of which is being written.
struct WrittenBracket {
    last: usize,
    end: &'static str,
    /// Index of the plan that contains the bracket.
    plan: usize,
    /// Nesting depth of the bracket in that plan.
    depth: usize,
}

struct StringWriter<'w> {
    machine: &'w Machine,
    found: &'w Found,
    texts: &'w MachineTexts,
    names: UsedNames,
    /// Texts of the plans, the main plan first.
    plans: Vec<String>,
    open: Vec<WrittenBracket>,
}

impl StringWriter<'_> {
    /// Writes all scopes and loops, from left to right.
    fn write(&mut self, enclosed: &[Enclosed]) {
        let mut rest = enclosed;
        for place in 0..self.found.order.len() - 1 {
            let count = rest.iter().take_while(|one| one.first == place).count();
            let (here, behind) = rest.split_at(count);
            rest = behind;
            let own = here.last().filter(|one| one.last.0 == place && one.rank != Rank::Loop);
            for one in &here[..count - usize::from(own.is_some())] {
                self.begin(*one);
            }
            let condition = own.and_then(|own| own.interrupt).map_or("null", |own| condition(self.texts, own));
            let state = self.found.order[place];
            let law = &self.texts.laws[state.0 as usize];
            let name = in_a_comment(self.machine.name(state));
            self.line(&format!("(Atom ({condition}) {law})    // {}: {name}", place + 1));
            while let Some(bracket) = self.open.pop_if(|bracket| bracket.last == place) {
                self.indented(bracket.plan, bracket.depth, bracket.end);
            }
        }
    }

    fn begin(&mut self, one: Enclosed) {
        let (plan, depth) = self.inside();
        let interrupt = one.interrupt.map(|interrupt| condition(self.texts, interrupt));
        let last = one.last.0;
        if depth >= DEPTH {
            let name = self.names.name("Part");
            self.line(&name);
            let plan = self.plans.len();
            self.plans.push(format!("{{ {name} ({})\n", interrupt.unwrap_or("null")));
            self.open.push(WrittenBracket { last, end: "}", plan, depth: 0 });
            if interrupt.is_none() {
                self.begin(one);
            }
            return;
        }
        let (start, end) = match interrupt {
            Some(condition) => (format!("{{ {} ({condition})", self.names.name("B")), "}"),
            None => ("(".to_owned(), ")^inf"),
        };
        self.line(&start);
        self.open.push(WrittenBracket { last, end, plan, depth });
    }

    /// Returns the position of the next line: the index of the plan, and the nesting depth in it.
    fn inside(&self) -> (usize, usize) {
        self.open.last().map_or((0, 1), |bracket| (bracket.plan, bracket.depth + 1))
    }

    fn line(&mut self, text: &str) {
        let (plan, depth) = self.inside();
        self.indented(plan, depth, text);
    }

    fn indented(&mut self, plan: usize, depth: usize, text: &str) {
        let line = [&"  ".repeat(depth), text, "\n"].concat();
        self.plans[plan].push_str(&line);
    }
}
