//! Tables that a loaded plan owns.

use std::sync::Arc;

use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{
    Alphabet, Condition, Fact, Fsm, Guard, InRows, LawRow, MarkRow, Meeting, Memories, ModuleRead, Table, Words,
};

use super::Entered;
use crate::fsm::{self, Element, Machine, PlanWords};

/// A loaded plan, with its quarks created, before it begins.
pub struct Loaded<A: Alphabet> {
    brackets: Vec<Bracket>,
    atoms: Vec<Atom>,
    termination: u64,
    owned: Owned<A>,
    laws: Vec<Box<str>>,
    conditions: Vec<Box<str>>,
    names: Vec<Box<str>>,
    entered: Entered,
    slots: usize,
    /// Number of memories for each level of scopes, and number of levels.
    memories: (usize, usize),
    /// The machine of the plan; `None` if the plan is not observed.
    machine: Option<Arc<Machine>>,
}

/// The table rows of a plan.
pub(super) struct Owned<A: Alphabet> {
    pub(super) guards: Vec<Guard<A::Interrupt>>,
    pub(super) operands: Vec<Condition<A::Interrupt>>,
    pub(super) laws: Vec<LawRow<A::Control>>,
    pub(super) marks: Vec<MarkRow>,
    pub(super) facts: Vec<Fact>,
    pub(super) words: PlanWords,
    pub(super) paths: Vec<&'static str>,
    pub(super) reads: &'static [ModuleRead],
    pub(super) robots: Vec<&'static str>,
    pub(super) meetings: Vec<Meeting>,
}

/// The table rows of a loaded plan, with its memories.
pub(super) type LoadedRows<A> = InRows<SharedTables<A>, Entered, Box<[u64]>, Memories<Box<[bool]>>>;

/// Tables of a plan that several machines can run at the same time, each at its own position.
pub struct SharedTables<A: Alphabet>(Arc<Loaded<A>>);

impl<A: Alphabet> Loaded<A> {
    /// Returns the module attributes that the plan reads.
    #[must_use]
    pub fn reads(&self) -> &'static [ModuleRead] {
        self.owned.reads
    }

    pub(super) fn new(machine: &Machine, owned: Owned<A>) -> Self {
        let Fsm { brackets, atoms, termination } = machine.tables();
        let (brackets, atoms) = (brackets.to_vec(), atoms.to_vec());
        let laws = machine.atoms().map(fsm::Atom::law).map(|law| law.text.as_str().into()).collect();
        let conditions = machine.elements().map(Element::condition_text).map(Into::into).collect();
        let names = machine.elements().map(Element::name).map(Into::into).collect();
        let entered = Entered::of(machine);
        let slots = machine.sizes().slots;
        let memories = (machine.sizes().memories, machine.depth());
        Self { brackets, atoms, termination, owned, laws, conditions, names, entered, slots, memories, machine: None }
    }

    /// Returns the plan as an observed plan, which records the moments of its turns; `machine` is the plan's machine.
    #[must_use]
    pub fn looked_at(self, machine: Arc<Machine>) -> Self {
        Self { machine: Some(machine), ..self }
    }

    /// Returns the number of memories that RISING and `after` need in a run; each level of scopes has the same
    /// number.
    #[must_use]
    pub fn memories(&self) -> usize {
        let (width, levels) = self.memories;
        width.saturating_mul(levels)
    }

    /// Returns `true` if a run of the plan needs odometry, progress or memories.
    pub(super) fn observes(&self) -> bool {
        self.has_stamps() || self.memories() > 0
    }

    /// Returns `true` if a run of the plan needs odometry or progress.
    pub(super) fn has_stamps(&self) -> bool {
        self.entered.has_stamps()
    }

    /// Returns the machine of the plan; `None` if the plan is not observed.
    pub(super) fn machine(&self) -> Option<Arc<Machine>> {
        self.machine.clone()
    }

    /// Returns the rows of the plan for a run that has not begun yet.
    pub(super) fn rows(self: &Arc<Self>) -> LoadedRows<A> {
        let width = u32::try_from(self.memories.0).unwrap_or(u32::MAX);
        let memory = Memories::new(width, vec![false; self.memories()].into());
        InRows::remembering(SharedTables(Arc::clone(self)), self.entered.clone(), vec![0; self.slots].into(), memory)
    }
}

impl<A: Alphabet> Table for SharedTables<A> {
    type Alphabet = A;

    #[inline(always)]
    fn fsm(&self) -> Fsm<'_> {
        let Loaded { brackets, atoms, termination, .. } = &*self.0;
        Fsm { brackets, atoms, termination: *termination }
    }

    #[inline(always)]
    fn guards(&self) -> &[Guard<A::Interrupt>] {
        &self.0.owned.guards
    }

    #[inline(always)]
    fn operands(&self) -> &[Condition<A::Interrupt>] {
        &self.0.owned.operands
    }

    #[inline(always)]
    fn laws(&self) -> &[LawRow<A::Control>] {
        &self.0.owned.laws
    }

    #[inline(always)]
    fn marks(&self) -> &[MarkRow] {
        &self.0.owned.marks
    }

    #[inline(always)]
    fn facts(&self) -> &[Fact] {
        &self.0.owned.facts
    }

    fn law(&self, atom: u32) -> &str {
        text(&self.0.laws, atom)
    }

    fn condition(&self, scope: u32) -> &str {
        text(&self.0.conditions, scope)
    }

    fn name(&self, scope: u32) -> &str {
        text(&self.0.names, scope)
    }

    fn source(&self) -> &dyn Words {
        &self.0.owned.words
    }

    fn paths(&self) -> &[&'static str] {
        &self.0.owned.paths
    }

    fn reads(&self) -> &'static [ModuleRead] {
        self.0.owned.reads
    }

    fn robots(&self) -> &[&'static str] {
        &self.0.owned.robots
    }

    fn meetings(&self) -> &[Meeting] {
        &self.0.owned.meetings
    }
}

fn text(texts: &[Box<str>], index: u32) -> &str {
    texts.get(index as usize).map_or("", |text| text)
}
