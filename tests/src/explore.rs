//! Explores a plan by brute force: from each reachable situation, runs a turn for each combination of quark values and
//! each step of time. It is written only from the rules (docs/src/reference/semantics.md, 3 to 6), and shares no code
//! for steps with any machine.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use mdle_compiler::plan::{Condition, Interrupt, Mark, Node, Plan, QuarkId, Record, RecordId, Situation};

/// Values of the quarks in a turn, indexed by the numbers of the quarks.
#[derive(Debug, Clone, Default)]
pub struct QuarkValues {
    /// Interrupts that have fired.
    pub fired: Vec<bool>,
    /// Laws that have completed.
    pub completed: Vec<bool>,
}

/// Maximum number of transitions of a turn.
const TRANSITIONS: usize = 4096;

/// A scope, a loop or an atom.
struct Part<'p> {
    interrupt: Option<&'p Interrupt>,
    /// Number of passes of a loop; 0 for an endless loop.
    times: u64,
    law: Option<QuarkId>,
    record: Option<Record>,
    marks: &'p [Mark],
    children: Vec<usize>,
}

/// A plan whose parts are numbered in pre-order.
pub struct Explorer<'p> {
    plan: &'p Plan,
    parts: Vec<Part<'p>>,
}

/// A part of the plan that is entered.
#[derive(Debug, Clone)]
struct Frame {
    part: usize,
    entered: u64,
    way: u64,
    left: u64,
    memories: Vec<bool>,
    facts: Vec<bool>,
}

/// Situation of a running plan.
#[derive(Debug, Clone)]
pub struct Run {
    frames: Vec<Frame>,
    /// Nanoseconds since the plan began.
    pub now: u64,
    /// Nanometres that the robot has driven since the plan began.
    pub way: u64,
}

/// Result of a turn.
#[derive(Debug, Default)]
pub struct Turn {
    /// Numbers of the atoms that were current in the turn, in order. The law of the last atom is applied unless the
    /// turn is cut.
    pub current: Vec<usize>,
    /// Numbers of the parts that ended, each with the operands of its interrupt that fired, or without operands if the
    /// law completed.
    pub ended: Vec<(usize, Vec<usize>)>,
    /// `true` if a law was applied.
    pub applied: bool,
    /// `true` if the plan is over.
    pub over: bool,
}

/// Situation in which a condition is evaluated.
struct At<'r, 'p> {
    explorer: &'r Explorer<'p>,
    run: &'r Run,
    frame: &'r Frame,
    values: &'r QuarkValues,
}

impl Situation for At<'_, '_> {
    fn quark(&self, quark: QuarkId) -> bool {
        self.values.fired[quark.0 as usize]
    }

    fn waited(&self, nanos: u64) -> bool {
        self.run.now - self.frame.entered >= nanos
    }

    fn driven(&self, nanometers: u64) -> bool {
        self.run.way - self.frame.way >= nanometers
    }

    fn remembers(&self, memory: u32) -> bool {
        self.frame.memories[memory as usize]
    }

    fn recorded(&self, record: RecordId, fact: u32) -> bool {
        self.run.frames.iter().any(|frame| {
            let kept = self.explorer.parts[frame.part].record;
            kept.is_some_and(|kept| kept.id == record) && frame.facts[fact as usize]
        })
    }
}

impl<'p> Explorer<'p> {
    /// Returns an explorer of a plan, which numbers the parts of the plan.
    #[must_use]
    pub fn new(plan: &'p Plan) -> Self {
        let mut explorer = Self { plan, parts: Vec::new() };
        let root = &plan.root;
        explorer.parts.push(Part {
            interrupt: Some(&root.interrupt),
            times: 1,
            law: None,
            record: root.record,
            marks: &root.marks,
            children: Vec::new(),
        });
        explorer.add(0, &root.body);
        explorer
    }

    fn add(&mut self, parent: usize, body: &'p [Node]) {
        for node in body {
            let (interrupt, times, law, record, marks, inside) = match node {
                Node::Atom(atom) => (Some(&atom.interrupt), 1, Some(atom.law), None, &atom.marks, None),
                Node::Scope(scope) => (Some(&scope.interrupt), 1, None, scope.record, &scope.marks, Some(&scope.body)),
                Node::Loop(repeated) => {
                    (None, repeated.times.unwrap_or(0), None, None, &repeated.marks, Some(&repeated.body))
                }
            };
            let part = self.parts.len();
            self.parts.push(Part { interrupt, times, law, record, marks, children: Vec::new() });
            self.parts[parent].children.push(part);
            if let Some(body) = inside {
                self.add(part, body);
            }
        }
    }

    /// Returns the situation at the beginning of the plan.
    #[must_use]
    pub fn begin(&self) -> Run {
        let mut run = Run { frames: Vec::new(), now: 0, way: 0 };
        self.open(&mut run, 0);
        run
    }

    /// Returns the operands of a part's interrupt.
    #[must_use]
    pub fn operands(&self, part: usize) -> &'p [Condition] {
        self.parts[part].interrupt.map_or(&[], |interrupt| interrupt.condition.operands())
    }

    fn open(&self, run: &mut Run, mut part: usize) {
        loop {
            let this = &self.parts[part];
            run.frames.push(Frame {
                part,
                entered: run.now,
                way: run.way,
                left: this.times.saturating_sub(1),
                memories: vec![false; this.interrupt.map_or(0, |interrupt| interrupt.memories) as usize],
                facts: vec![false; this.record.map_or(0, |record| record.facts) as usize],
            });
            match this.children.first() {
                Some(first) => part = *first,
                None => return,
            }
        }
    }

    /// Runs a turn.
    #[must_use]
    pub fn turn(&self, run: &mut Run, values: &QuarkValues) -> Turn {
        let mut turn = Turn::default();
        loop {
            turn.current.push(run.frames.last().expect("an atom").part);
            let Some((place, operands)) = self.fired(run, values) else {
                turn.applied = true;
                break;
            };
            if turn.ended.len() == TRANSITIONS {
                break;
            }
            turn.ended.push((run.frames[place].part, operands.clone()));
            if !self.end(run, place, operands.first().copied()) {
                turn.over = true;
                return turn;
            }
        }
        self.remember(run, values);
        turn
    }

    /// Returns the outermost part that ends, as an index among the entered parts, with the operands that fired, or
    /// `None` if no part ends.
    fn fired(&self, run: &Run, values: &QuarkValues) -> Option<(usize, Vec<usize>)> {
        for (place, frame) in run.frames.iter().enumerate() {
            let at = At { explorer: self, run, frame, values };
            let operands = self.operands(frame.part).iter().enumerate();
            let fired: Vec<_> = operands.filter(|(_, operand)| operand.fired(&at)).map(|(number, _)| number).collect();
            if !fired.is_empty() {
                return Some((place, fired));
            }
        }
        let law = self.parts[run.frames.last()?.part].law?;
        let is_done = self.plan.quark(law).completes && values.completed[law.0 as usize];
        is_done.then(|| (run.frames.len() - 1, Vec::new()))
    }

    /// Ends the entered part with the index `place` and enters its successor. Returns `false` if there is no successor.
    fn end(&self, run: &mut Run, mut place: usize, cause: Option<usize>) -> bool {
        let mut ended = vec![(run.frames[place].part, cause)];
        let next = loop {
            let Some(holder) = place.checked_sub(1) else { return false };
            let children = &self.parts[run.frames[holder].part].children;
            let position = children.iter().position(|child| *child == run.frames[place].part).expect("a child");
            if let Some(next) = children.get(position + 1) {
                break *next;
            }
            let times = self.parts[run.frames[holder].part].times;
            if self.parts[run.frames[holder].part].interrupt.is_none() && (times == 0 || run.frames[holder].left > 0) {
                run.frames[holder].left = run.frames[holder].left.saturating_sub(1);
                break children[0];
            }
            place = holder;
            ended.push((run.frames[place].part, None));
        };
        self.record(run, &ended);
        run.frames.truncate(place);
        self.open(run, next);
        true
    }

    /// Updates the records of `after` with the labels of the parts that ended together.
    fn record(&self, run: &mut Run, ended: &[(usize, Option<usize>)]) {
        let mut fresh: BTreeMap<RecordId, Vec<u32>> = BTreeMap::new();
        for (part, cause) in ended {
            for mark in self.parts[*part].marks {
                let cause = cause.map(|cause| u32::try_from(cause).expect("few operands"));
                let holding = mark.facts.iter().filter(|fact| fact.holds(cause)).map(|fact| fact.number);
                fresh.entry(mark.record).or_default().extend(holding);
            }
        }
        for frame in &mut run.frames {
            let Some(record) = self.parts[frame.part].record else { continue };
            let Some(holding) = fresh.get(&record.id) else { continue };
            frame.facts.fill(false);
            holding.iter().for_each(|fact| frame.facts[*fact as usize] = true);
        }
    }

    /// Sets the memories of the RISING conditions whose operand has not fired in this turn.
    fn remember(&self, run: &mut Run, values: &QuarkValues) {
        let mut set = Vec::new();
        for (place, frame) in run.frames.iter().enumerate() {
            let at = At { explorer: self, run, frame, values };
            let Some(interrupt) = self.parts[frame.part].interrupt else { continue };
            interrupt.condition.each_rising(&mut |memory, operand| {
                if !operand.fired(&at) {
                    set.push((place, memory as usize));
                }
            });
        }
        set.into_iter().for_each(|(place, memory)| run.frames[place].memories[memory] = true);
    }

    /// Returns a key that identifies a situation. Times and distances are limited to `longest`, which exceeds all
    /// timers.
    fn key(&self, run: &Run, longest: u64) -> Vec<u64> {
        let mut key = Vec::new();
        for frame in &run.frames {
            let counted = [run.now - frame.entered, run.way - frame.way].map(|count| count.min(longest));
            key.extend([frame.part as u64, frame.left].into_iter().chain(counted));
            key.extend(frame.memories.iter().chain(&frame.facts).map(|bit| u64::from(*bit)));
        }
        key
    }

    /// Visits every turn from every reachable situation, breadth first, for each of these combinations of quark values
    /// and steps of time. If a condition reads the distance driven, each turn is visited with and without a movement.
    /// Visits at most `most` situations, and returns `true` if no situation was left out.
    pub fn explore(
        &self,
        values: &[QuarkValues],
        steps: &[u64],
        most: usize,
        visit: &mut impl FnMut(&Turn, &Run),
    ) -> bool {
        /// Maximum mean number of transitions per situation. The search stops beyond it, because searches with many cut
        /// turns take long.
        const TRANSITIONS_EACH: usize = 500;
        let longest = 20_000_000_000;
        let drives = self.parts.iter().any(|part| part.interrupt.is_some_and(|it| it.condition.drives()));
        let ways: &[u64] = if drives { &[0, 200_000_000] } else { &[0] };
        let mut made = 0;
        let mut seen = BTreeSet::new();
        let mut waiting = VecDeque::from([(self.begin(), true)]);
        while let Some((run, is_first)) = waiting.pop_front() {
            let steps = if is_first { &[0] } else { steps };
            let steps = steps.iter().flat_map(|step| ways.iter().map(move |way| (step, way)));
            for (step, way) in steps {
                for values in values {
                    let mut next = run.clone();
                    next.now += step;
                    next.way += if is_first { 0 } else { *way };
                    let turn = self.turn(&mut next, values);
                    made += turn.ended.len();
                    if made > most * TRANSITIONS_EACH {
                        return false;
                    }
                    visit(&turn, &next);
                    if !turn.over && seen.len() < most && seen.insert(self.key(&next, longest)) {
                        waiting.push_back((next, false));
                    }
                }
            }
        }
        seen.len() < most
    }
}
