//! The plans of a file by name: who refers to whom, which plan is the one to run, and that none contains itself.

use std::collections::{BTreeMap, BTreeSet};

use crate::alphabet::{Alphabet, DeclarationKind};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::Files;
use crate::syntax::tree::{self, Call, Element, Primary};

/// The most atoms a plan may have once every plan by name is copied in, unless the file has more; loops are not expanded
/// for this.
const ATOMS: u64 = 1 << 19;
/// The deepest nesting once every plan by name is copied in.
const DEPTH: u32 = 512;

/// The plans of a file and of those that it uses.
#[derive(Debug)]
pub(super) struct Definitions<'a> {
    /// The file's own first, in its order.
    pub(super) plans: Vec<&'a tree::Plan<'a>>,
    /// Their names.
    pub(super) names: Vec<&'a str>,
    by_name: BTreeMap<&'a str, usize>,
    /// For each plan the plans it refers to, with the first place.
    refers: Vec<BTreeMap<usize, Span>>,
    /// The plans that are too large, or refer to one that is: the first is reported, those around it are not.
    too_large: BTreeSet<usize>,
    /// How many are of the file itself, not of one that it uses.
    own: usize,
    /// Whether a file is missing that may have more of them.
    pub(super) is_incomplete: bool,
    /// The atoms of the files, as written.
    written: u64,
}

impl<'a> Definitions<'a> {
    /// Collects the plans of `files` and reports duplicates, recursion and explosion.
    pub(super) fn collect(files: &'a Files<'a>, alphabet: &Alphabet) -> (Self, Vec<Diagnostic>) {
        let mut found = Vec::new();
        let mut by_name = BTreeMap::new();
        for (index, plan) in files.plans.iter().enumerate() {
            let name = plan.name.node;
            if let Some(first) = by_name.get(name).and_then(|first: &usize| files.plans.get(*first)) {
                let message = format!("there are two plans called `{name}`");
                found.push(
                    Diagnostic::new(Code::E0203, message, plan.name.span, "the second one")
                        .also(first.name.span, "the first one")
                        .help("give one of them another name"),
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
        let refers = plans.iter().map(|plan| references(plan, &by_name)).collect();
        let names = by_name.keys().copied().collect();
        let mut definitions = Self {
            plans,
            names,
            by_name,
            refers,
            too_large: BTreeSet::new(),
            own: files.own,
            is_incomplete: files.is_incomplete,
            written: 0,
        };
        definitions.measure(&mut found);
        (definitions, found)
    }

    /// The plan of this name.
    pub(super) fn get(&self, name: &str) -> Option<&'a tree::Plan<'a>> {
        self.by_name.get(name).and_then(|index| self.plans.get(*index)).copied()
    }

    /// The plans of the file itself that no other refers to, in its order.
    pub(super) fn roots(&self) -> Vec<&'a tree::Plan<'a>> {
        let referred: BTreeSet<usize> = self.refers.iter().flat_map(|refers| refers.keys().copied()).collect();
        let roots = self.by_name.values().filter(|index| **index < self.own && !referred.contains(index));
        let mut roots: Vec<usize> = roots.copied().collect();
        roots.sort_unstable();
        roots.into_iter().filter_map(|index| self.plans.get(index).copied()).collect()
    }

    /// Whether a plan, by its number, uses no other one.
    pub(super) fn stands_alone(&self, plan: usize) -> bool {
        self.refers.get(plan).is_some_and(BTreeMap::is_empty)
    }

    /// Visits the plans so that each comes after all it refers to; what is left over contains itself.
    fn measure(&mut self, found: &mut Vec<Diagnostic>) {
        let mut waits: Vec<usize> = self.refers.iter().map(BTreeMap::len).collect();
        let mut referred_by = vec![Vec::new(); self.plans.len()];
        for (index, refers) in self.refers.iter().enumerate() {
            refers.keys().for_each(|target| referred_by[*target].push(index));
        }
        let mut ready: Vec<usize> = (0..self.plans.len()).filter(|index| waits[*index] == 0).collect();
        let mut sizes = vec![Size { atoms: 0, depth: 0 }; self.plans.len()];
        // With nothing copied in yet, the sizes are those of the text.
        self.written = self.plans.iter().map(|plan| self.size_of(plan.elements, &sizes).atoms).sum();
        let mut done = 0;
        while let Some(index) = ready.pop() {
            done += 1;
            let plan = self.plans[index];
            sizes[index] = self.size_of(plan.elements, &sizes).deeper();
            self.judge(index, sizes[index], found);
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

    fn judge(&mut self, index: usize, size: Size, found: &mut Vec<Diagnostic>) {
        if self.refers[index].keys().any(|target| self.too_large.contains(target)) {
            self.too_large.insert(index);
            return;
        }
        let plan = self.plans[index];
        let here = plan.name.span;
        if size.atoms > ATOMS.max(self.written) {
            self.too_large.insert(index);
            let message = format!("`{}` has {} atoms once every plan by name is copied in", plan.name.node, size.atoms);
            found.push(
                Diagnostic::new(Code::E0501, message, here, "this plan")
                    .help("use a loop where the same plan is named many times: `ExecPlan 1000 Name`"),
            );
        } else if size.depth > DEPTH {
            self.too_large.insert(index);
            let message = format!("`{}` nests scopes and loops more than {DEPTH} deep", plan.name.node);
            let label = "once every plan by name is copied in";
            found.push(
                Diagnostic::new(Code::E0106, message, here, label)
                    .help("run the plans one after the other, not each inside the next"),
            );
        }
    }

    fn size_of(&self, elements: &[Element<'_>], sizes: &[Size]) -> Size {
        elements.iter().fold(Size { atoms: 0, depth: 0 }, |sum, element| {
            let size = match &element.primary {
                Primary::Atom(_) | Primary::Broken => Size { atoms: 1, depth: 1 },
                Primary::Plan(plan) => self.size_of(plan.elements, sizes).deeper(),
                Primary::Ref(call) => {
                    self.by_name.get(call.name).map_or(Size { atoms: 1, depth: 1 }, |index| sizes[*index])
                }
                Primary::Exec(exec) => self.size_of(exec.body, sizes).deeper(),
                Primary::String(body) => self.size_of(body, sizes).deeper(),
                Primary::Formal(formal) => self.size_of(formal.body, sizes).deeper(),
            };
            let size = if element.power().is_some() { size.deeper() } else { size };
            Size { atoms: sum.atoms.saturating_add(size.atoms), depth: sum.depth.max(size.depth) }
        })
    }

    fn report_cycles(&self, waits: &[usize], found: &mut Vec<Diagnostic>) {
        let stuck: BTreeSet<usize> = (0..self.plans.len()).filter(|index| waits[*index] > 0).collect();
        let mut seen = BTreeSet::new();
        for start in &stuck {
            let mut path = Vec::new();
            let mut here = *start;
            // Every stuck plan refers to a stuck one, so this walk ends in a cycle or in one that was walked before.
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
            (self.refers[cycle[at]][&next], format!("`{}` runs `{}` here", name(cycle[at]), name(next)))
        };
        let (span, text) = place(0);
        let message = format!("plan `{}` contains itself: {}", name(first), names.join(" → "));
        let report = Diagnostic::new(Code::E0202, message, span, text);
        let report = (1..cycle.len()).map(place).fold(report, |report, (span, text)| report.also(span, text));
        report.help("for something that goes on for ever, write a loop: `ExecPlan inf { … }`")
    }
}

/// How large a plan is once every plan by name is copied in.
#[derive(Debug, Clone, Copy)]
struct Size {
    atoms: u64,
    depth: u32,
}

impl Size {
    fn deeper(self) -> Self {
        Self { depth: self.depth.saturating_add(1), ..self }
    }
}

fn references(plan: &tree::Plan, by_name: &BTreeMap<&str, usize>) -> BTreeMap<usize, Span> {
    fn visit(elements: &[Element], refer: &mut impl FnMut(&Call)) {
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
    let mut references = BTreeMap::new();
    visit(plan.elements, &mut |call| {
        if let Some(index) = by_name.get(call.name) {
            references.entry(*index).or_insert(call.name_span());
        }
    });
    references
}

/// `Stop` for `stop`, `StopPlan` where it starts with a capital already.
fn plan_like(name: &str) -> String {
    let mut letters = name.chars();
    match letters.next() {
        Some(first) if first.is_lowercase() => first.to_uppercase().chain(letters).collect(),
        Some(_) | None => format!("{name}Plan"),
    }
}
