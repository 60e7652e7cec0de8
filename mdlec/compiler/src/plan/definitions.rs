//! Collects the plans of a file by name, and determines the references between them and the plans that can be run.
//! Checks that no plan contains itself.

use std::collections::{BTreeMap, BTreeSet};

use super::size::{self, Bounds, DEPTH, Excess, Measure, Size};
use crate::alphabet::{Alphabet, DeclarationKind};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::Files;
use crate::syntax::tree::{self, Call, Element, Primary};

/// The plans of a file, and of the files that it uses.
#[derive(Debug)]
pub(super) struct Definitions<'a> {
    /// The plans; the plans of the file itself come first, in order.
    pub(super) plans: Vec<&'a tree::Plan<'a>>,
    /// Names of the plans.
    pub(super) names: Vec<&'a str>,
    by_name: BTreeMap<&'a str, usize>,
    /// For each plan, the plans to which it refers.
    refers: Vec<BTreeMap<usize, PlanUses>>,
    /// Plans that are too large, and plans that refer to such a plan. Only the plan that is too large by itself is
    /// reported, not the plans that contain it.
    too_large: BTreeSet<usize>,
    /// Number of plans in the file itself, without the plans of used files.
    own: usize,
    /// `true` if a used file that may contain more plans is missing.
    pub(super) is_incomplete: bool,
    /// Size of the files as written.
    written: Size,
    /// Length, in bytes, of the longest argument that is passed to a plan.
    longest: u64,
    /// Bounds on the sizes of plans.
    bounds: Bounds,
}

/// References in one plan to another plan.
#[derive(Debug, Clone, Copy)]
struct PlanUses {
    first: Span,
    count: u64,
}

impl<'a> Definitions<'a> {
    /// Collects the plans of `files`; reports duplicate names, recursion and plans that are too large.
    pub(super) fn collect(files: &'a Files<'a>, alphabet: &Alphabet, bounds: Bounds) -> (Self, Vec<Diagnostic>) {
        let mut found = Vec::new();
        let mut by_name = BTreeMap::new();
        for (index, plan) in files.plans.iter().enumerate() {
            let name = plan.name.node;
            if let Some(first) = by_name.get(name).and_then(|first: &usize| files.plans.get(*first)) {
                let message = format!("there are two plans called `{name}`");
                // A string before σ_null is a plan whose name is not in the text.
                let is_bare = [plan, first].iter().any(|plan| plan.name.span.start == plan.name.span.end);
                let help = match is_bare {
                    true => "write one of them with braces and a name of its own: `{ Name … }`",
                    false => "give one of them another name",
                };
                found.push(
                    Diagnostic::new(Code::E0203, message, plan.name.span, "the second one")
                        .also(first.name.span, "the first one")
                        .help(help),
                );
                continue;
            }
            // Signals are not in the name space of laws, interrupts and plans.
            if alphabet.declarations_of(name).any(|declaration| declaration.kind != DeclarationKind::Signal) {
                let message = format!("`{name}` is a quark, so a plan cannot be called that");
                found.push(
                    Diagnostic::new(Code::E0203, message, plan.name.span, "a quark of the alphabet has this name")
                        .help(format!("call it `{}`, for instance", plan_like(name))),
                );
            }
            by_name.insert(name, index);
        }
        let plans: Vec<_> = files.plans.iter().collect();
        let calls = plans.iter().map(|plan| calls(plan, &by_name)).collect::<Vec<_>>();
        let longest = size::longest(calls.iter().flatten().map(|(_, call)| *call));
        let refers = calls.iter().map(|calls| references(calls)).collect();
        let names = by_name.keys().copied().collect();
        let mut definitions = Self {
            plans,
            names,
            by_name,
            refers,
            too_large: BTreeSet::new(),
            own: files.own,
            is_incomplete: files.is_incomplete,
            written: Size::default(),
            longest,
            bounds,
        };
        definitions.measure(&mut found);
        (definitions, found)
    }

    /// Returns the plan with this name; `None` if there is no such plan.
    pub(super) fn get(&self, name: &str) -> Option<&'a tree::Plan<'a>> {
        self.by_name.get(name).and_then(|index| self.plans.get(*index)).copied()
    }

    /// Returns the plans of the file itself that no other plan refers to, in order.
    pub(super) fn roots(&self) -> Vec<&'a tree::Plan<'a>> {
        let referred: BTreeSet<usize> = self.refers.iter().flat_map(|refers| refers.keys().copied()).collect();
        let roots = self.by_name.values().filter(|index| **index < self.own && !referred.contains(index));
        let mut roots: Vec<usize> = roots.copied().collect();
        roots.sort_unstable();
        roots.into_iter().filter_map(|index| self.plans.get(index).copied()).collect()
    }

    /// Returns `true` if the plan with this index uses no other plan.
    pub(super) fn stands_alone(&self, plan: usize) -> bool {
        self.refers.get(plan).is_some_and(BTreeMap::is_empty)
    }

    /// Computes the sizes of all plans. A plan is measured after all plans to which it refers; plans that cannot be
    /// measured contain themselves.
    fn measure(&mut self, found: &mut Vec<Diagnostic>) {
        let mut waits: Vec<usize> = self.refers.iter().map(BTreeMap::len).collect();
        let mut referred_by = vec![Vec::new(); self.plans.len()];
        for (index, refers) in self.refers.iter().enumerate() {
            refers.keys().for_each(|target| referred_by[*target].push(index));
        }
        let mut ready: Vec<usize> = (0..self.plans.len()).filter(|index| waits[*index] == 0).collect();
        let mut sizes = vec![Size::default(); self.plans.len()];
        // All sizes are still zero, so these are the sizes of the plans as written, without copies.
        self.written = self.plans.iter().fold(Size::default(), |sum, plan| sum.and(self.size_of(plan, &sizes)));
        let mut done = 0;
        while let Some(index) = ready.pop() {
            done += 1;
            let plan = self.plans[index];
            sizes[index] = self.size_of(plan, &sizes);
            self.judge(index, &sizes, found);
            for user in &referred_by[index] {
                waits[*user] -= 1;
                if waits[*user] == 0 {
                    ready.push(*user);
                }
            }
        }
        if done < self.plans.len() {
            self.report_cycles(&waits, found);
        }
    }

    fn judge(&mut self, index: usize, sizes: &[Size], found: &mut Vec<Diagnostic>) {
        if self.refers[index].keys().any(|target| self.too_large.contains(target)) {
            self.too_large.insert(index);
            return;
        }
        let plan = self.plans[index];
        let here = plan.name.span;
        if let Some(excess) = sizes[index].excess(&self.written, &self.bounds) {
            self.too_large.insert(index);
            found.push(self.explosion(index, &excess, sizes));
        } else if sizes[index].depth > DEPTH {
            self.too_large.insert(index);
            let message = format!("`{}` nests scopes and loops more than {DEPTH} deep", plan.name.node);
            let label = "once every plan by name is copied in";
            found.push(
                Diagnostic::new(Code::E0106, message, here, label)
                    .help("run the plans one after the other, not each inside the next"),
            );
        }
    }

    /// Reports a plan that exceeds a limit. The report names the used plan that contributes most to the size.
    fn explosion(&self, index: usize, excess: &Excess, sizes: &[Size]) -> Diagnostic {
        let Excess { unit, limit, .. } = excess;
        let plan = self.plans[index];
        let count = excess.count(&sizes[index]);
        let message = format!(
            "`{}` has {count} {unit} once every plan by name is copied in; the limit is {limit}",
            plan.name.node
        );
        let report = Diagnostic::new(Code::E0501, message, plan.name.span, "this plan");
        let share = |(target, uses): &(&usize, &PlanUses)| excess.count(&sizes[**target]).saturating_mul(uses.count);
        let report = match self.refers[index].iter().max_by_key(share) {
            Some((target, PlanUses { first, count })) => {
                let (name, each) = (self.plans[*target].name.node, excess.count(&sizes[*target]));
                let times = if *count == 1 { "once".to_owned() } else { format!("{count} times") };
                report.also(*first, format!("`{name}` is used {times}, with {each} {unit} each time"))
            }
            None => report,
        };
        report.help("use a loop where the same plan is named many times: `ExecPlan 1000 Name`")
    }

    fn size_of(&self, plan: &tree::Plan<'_>, sizes: &[Size]) -> Size {
        Measure { by_name: &self.by_name, sizes, longest: self.longest }.plan(plan)
    }

    fn report_cycles(&self, waits: &[usize], found: &mut Vec<Diagnostic>) {
        let stuck: BTreeSet<usize> = (0..self.plans.len()).filter(|index| waits[*index] > 0).collect();
        let mut seen = BTreeSet::new();
        for start in &stuck {
            let mut path = Vec::new();
            let mut here = *start;
            // Every stuck plan refers to another stuck plan, so this walk ends in a cycle or at a plan that was visited
            // before.
            while seen.insert(here) {
                path.push(here);
                match self.refers[here].keys().find(|target| stuck.contains(target)) {
                    Some(next) => here = *next,
                    None => break,
                }
            }
            if let Some(from) = path.iter().position(|index| *index == here) {
                found.push(self.cycle(&path[from..]));
            }
        }
    }

    fn cycle(&self, cycle: &[usize]) -> Diagnostic {
        let name = |index: usize| self.plans[index].name.node;
        let first = cycle[0];
        let names: Vec<_> = cycle.iter().chain([&first]).map(|index| format!("`{}`", name(*index))).collect();
        let place = |at: usize| {
            let next = cycle[(at + 1) % cycle.len()];
            (self.refers[cycle[at]][&next].first, format!("`{}` runs `{}` here", name(cycle[at]), name(next)))
        };
        let (span, text) = place(0);
        let message = format!("plan `{}` contains itself: {}", name(first), names.join(" → "));
        let report = Diagnostic::new(Code::E0202, message, span, text);
        let report = (1..cycle.len()).map(place).fold(report, |report, (span, text)| report.also(span, text));
        report.help("for something that goes on for ever, write a loop: `ExecPlan inf { … }`")
    }
}

/// Returns the references in a plan to other plans, each with the index of the other plan.
fn calls<'a>(plan: &tree::Plan<'a>, by_name: &BTreeMap<&str, usize>) -> Vec<(usize, &'a Call<'a>)> {
    fn visit<'a>(elements: &[Element<'a>], refer: &mut impl FnMut(&'a Call<'a>)) {
        for element in elements {
            match &element.primary {
                Primary::Ref(call) => refer(call),
                Primary::Plan(plan) => visit(plan.elements, refer),
                Primary::Exec(exec) => visit(exec.body, refer),
                Primary::String(body) => visit(body, refer),
                Primary::Formal(formal) => visit(formal.body, refer),
                Primary::Atom(_) | Primary::Broken => {}
            }
        }
    }
    let mut calls = Vec::new();
    visit(plan.elements, &mut |call| calls.extend(by_name.get(call.name).map(|index| (*index, call))));
    calls
}

/// Groups calls by the plan to which they refer; the keys are indices of plans.
fn references(calls: &[(usize, &Call<'_>)]) -> BTreeMap<usize, PlanUses> {
    let mut references = BTreeMap::new();
    for (index, call) in calls {
        references.entry(*index).or_insert(PlanUses { first: call.name_span(), count: 0 }).count += 1;
    }
    references
}

/// Proposes a plan name that is similar to a word: `Stop` for `stop`, and `StopPlan` for a word that already begins
/// with a capital.
fn plan_like(name: &str) -> String {
    let mut letters = name.chars();
    match letters.next() {
        Some(first) if first.is_lowercase() => first.to_uppercase().chain(letters).collect(),
        Some(_) | None => format!("{name}Plan"),
    }
}
