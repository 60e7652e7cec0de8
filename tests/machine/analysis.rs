//! Tests `mdlec analyze`: random plans are explored by brute force, which must find nothing that the analysis excludes;
//! plans in `plans/` have expected results; and the size of a machine is compared with that of the compiled Rust.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use mdle_compiler::Compiled;
use mdle_compiler::analysis::{Analysis, Reach, analyze, lints};
use mdle_compiler::fsm::ElementKind;
use mdle_compiler::plan::{Plan, Quark, condition_text};
use mdle_compiler::trace::{CountedRun, Script, ScriptedInput, TraceLine, TurnResult, run};
use mdle_runtime::{Cursor, Frame, Machine};
use mdle_scripted::INTERRUPTS;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::explore::{Explorer, QuarkValues, Run, Turn};
use mdle_tests::golden::judge;
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_tests::repository::{TextFile, files, root};
use mdle_tests::signals::Values;

/// Recorded Rust of two plans, which is compiled here.
mod recorded {
    pub(crate) mod lab_tour {
        include!("snapshots/machine__golden__rust-lab_tour.snap.rs");
    }
    pub(crate) mod patrol {
        include!("snapshots/machine__golden__rust-patrol.snap.rs");
    }
}

/// Number of random plans.
const PLANS: u64 = 350;
/// Maximum number of combinations of quark values that are tried for a plan. If a plan has more, this number of random
/// combinations is tried.
const CHOICES: usize = 16;
/// Maximum number of situations of a plan: if all combinations of quark values are tried, and if only some are tried.
const SITUATIONS: [usize; 2] = [1000, 80];
/// Steps between turns, in nanoseconds: zero, a step shorter than the shortest timer, the lengths of timers and
/// windows, and a step longer than all timers.
const STEPS: [u64; 5] = [0, 40_000_000, 100_000_000, 1_000_000_000, 5_000_000_000];

/// Counts over all plans.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    plans: usize,
    turns: usize,
    over: usize,
    /// Number of plans for which every situation was tried.
    whole: usize,
    /// Number of atoms of these plans. `idle` counts the atoms that never run, and `predicted` those of them for which
    /// the analysis predicts this.
    atoms: usize,
    idle: usize,
    predicted: usize,
    /// Number of operands that never end their scope, as the analysis predicts.
    never: usize,
    bounded: usize,
}

impl Count {
    fn and(self, other: Self) -> Self {
        Self {
            plans: self.plans + other.plans,
            turns: self.turns + other.turns,
            over: self.over + other.over,
            whole: self.whole + other.whole,
            atoms: self.atoms + other.atoms,
            idle: self.idle + other.idle,
            predicted: self.predicted + other.predicted,
            never: self.never + other.never,
            bounded: self.bounded + other.bounded,
        }
    }
}

#[test]
fn what_analysis_excludes_never_happens() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let count = std::thread::scope(|scope| {
        let hands: Vec<_> = (0..cores).map(|hand| scope.spawn(move || seeds(hand, cores))).collect();
        hands.into_iter().map(|hand| hand.join().expect("no difference")).fold(Count::default(), Count::and)
    });
    println!("{count:#?}");
    let plans = repeated(PLANS) as usize;
    assert!(count.plans * 10 > plans * 9 && count.turns > plans * 480 && count.over > plans * 10, "{count:?}");
    // Nearly all atoms that never run are predicted.
    assert!(count.whole * 13 > plans && count.idle * 50 > plans && count.predicted * 10 >= count.idle * 9, "{count:?}");
    assert!(count.never > plans && count.bounded * 4 > plans, "{count:?}");
}

fn seeds(first: usize, step: usize) -> Count {
    let mut count = Count::default();
    for seed in (first as u64..repeated(PLANS)).step_by(step) {
        let mut chance = Chance::new(seed);
        let text =
            RandomPlan::new(&mut chance, 2 + (seed as usize) * 12 / (repeated(PLANS) as usize), false).to_string();
        if let Ok(compiled) = compile(&text) {
            Trial::new(seed, &text, &compiled).run(&mut chance, &mut count);
        }
    }
    count
}

/// A plan and its analysis.
struct Trial<'c> {
    seed: u64,
    text: &'c str,
    compiled: &'c Compiled,
    analysis: Analysis,
    /// Atom or scope of each part of the plan, in pre-order.
    parts: Vec<Part>,
}

#[derive(Clone, Copy)]
enum Part {
    Atom(usize),
    Scope(usize),
    Loop,
}

impl<'c> Trial<'c> {
    fn new(seed: u64, text: &'c str, compiled: &'c Compiled) -> Self {
        let analysis = analyze(&compiled.machine);
        let machine = &compiled.machine;
        let (mut atoms, mut scopes) = (0, 0);
        let parts = machine.elements().map(|element| match element.kind() {
            ElementKind::Atom(_) => {
                atoms += 1;
                Part::Atom(atoms - 1)
            }
            ElementKind::Scope => {
                scopes += 1;
                Part::Scope(scopes - 1)
            }
            ElementKind::Loop { .. } => Part::Loop,
        });
        let parts = parts.collect();
        Self { seed, text, compiled, analysis, parts }
    }

    fn run(&self, chance: &mut Chance, count: &mut Count) {
        let plan = self.compiled.nondegenerate.plan();
        let explorer = Explorer::new(plan);
        let (message, all) = choices(plan, chance);
        let mut applied = BTreeSet::new();
        let whole = explorer.explore(&message, &STEPS, SITUATIONS[usize::from(!all)], &mut |turn, run| {
            count.turns += 1;
            count.over += usize::from(turn.over);
            self.check(&explorer, turn, run);
            if turn.applied {
                applied.extend(turn.current.last().copied());
            }
        });
        count.plans += 1;
        count.bounded += usize::from(self.analysis.longest.seconds.is_some());
        count.never += self.analysis.atoms.iter().map(|atom| atom.never_by.len()).sum::<usize>();
        if whole && all && !self.laws_complete_together() {
            count.whole += 1;
            count.atoms += self.analysis.atoms.len();
            let idle = self.parts.iter().enumerate().filter(|(number, _)| !applied.contains(number));
            for (_, part) in idle {
                let Part::Atom(atom) = part else { continue };
                count.idle += 1;
                count.predicted += usize::from(self.analysis.atoms[*atom].reach != Reach::Runs);
            }
        }
    }

    /// Returns `true` if two atoms have the same law and this law completes. In a turn that is tried, such a law
    /// completes either for both atoms or for neither.
    fn laws_complete_together(&self) -> bool {
        let mut laws = BTreeSet::new();
        let mut completing = self.compiled.machine.atoms().map(|atom| atom.law()).filter(|law| law.completes);
        !completing.all(|law| laws.insert(&law.text))
    }

    /// Asserts that a turn does not contradict the analysis.
    fn check(&self, explorer: &Explorer<'_>, turn: &Turn, run: &Run) {
        for part in &turn.current {
            let Part::Atom(atom) = self.parts[*part] else { panic!("an atom is current") };
            self.holds(self.analysis.atoms[atom].reach != Reach::Never, &format!("atom {} is reached", atom + 1));
        }
        if let (true, Some(part)) = (turn.applied, turn.current.last()) {
            let Part::Atom(atom) = self.parts[*part] else { panic!("an atom is current") };
            self.holds(self.analysis.atoms[atom].reach == Reach::Runs, &format!("atom {} runs", atom + 1));
        }
        for (part, operands) in &turn.ended {
            let (ends, ended_by) = match self.parts[*part] {
                Part::Atom(atom) => (self.analysis.atoms[atom].ends, &self.analysis.atoms[atom].ended_by),
                Part::Scope(scope) => (true, &self.analysis.scopes[scope].ended_by),
                Part::Loop => panic!("a loop has no interrupt"),
            };
            let texts = operands.iter().map(|operand| {
                let quark = |id| self.compiled.machine.quark(id).text.clone();
                condition_text(&explorer.operands(*part)[*operand], &quark)
            });
            let texts: Vec<_> = texts.collect();
            let texts = if texts.is_empty() { vec!["completed".to_owned()] } else { texts };
            for text in texts {
                self.holds(ends && ended_by.contains(&text), &format!("part {part} ends by {text}"));
            }
        }
        let most = usize::try_from(self.analysis.transitions).unwrap();
        self.holds(turn.ended.len() <= most, &format!("{} transitions", turn.ended.len()));
        if turn.over {
            let (now, gap) = (run.now as f64 / 1e9, STEPS[4] as f64 / 1e9);
            self.holds(self.analysis.shortest.is_some_and(|time| time <= now), &format!("it is over at {now} s"));
            if let (Some(seconds), Some(turns)) = (self.analysis.longest.seconds, self.analysis.longest.turns) {
                self.holds(now <= seconds + turns as f64 * gap, &format!("it takes {now} s"));
            }
        }
    }

    fn holds(&self, holds: bool, seen: &str) {
        if !holds {
            panic!("seed {}: {seen}\n{}\n{}", self.seed, self.text, self.analysis.to_text());
        }
    }
}

#[test]
fn runs_last_as_long_as_analysis_computes() {
    let (mut over, mut bounded) = (0, 0);
    for seed in 0..repeated(1350) {
        let mut chance = Chance::new(seed);
        let long = seed % 100 >= 98;
        let text = RandomPlan::new(&mut chance, 2 + seed as usize % 12, long).to_string();
        let script = Script::read(&script(&mut chance, 12)).expect("a script");
        let Ok(compiled) = compile(&text) else { continue };
        let analysis = analyze(&compiled.machine);
        let times: Vec<f64> = script.turns().iter().map(|turn| turn.t.0 as f64 / 1e9).collect();
        let gap = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        for TraceLine { turn, outcome: TurnResult { applied, fired, .. }, .. } in
            run(CountedRun::new(&compiled.machine), &script)
        {
            let now = times[turn];
            let message = || format!("seed {seed}, turn {turn} at {now} s\n{text}\n{}", analysis.to_text());
            assert!(fired.len() as u64 <= analysis.transitions, "{}", message());
            // The tolerance covers the rounding of printed times.
            let longest = analysis.longest.seconds.zip(analysis.longest.turns);
            let longest = longest.map(|(seconds, turns)| seconds + turns as f64 * gap + 1e-9);
            assert!(longest.is_none_or(|longest| now <= longest), "{}", message());
            if applied == ScriptedInput::Over {
                over += 1;
                bounded += usize::from(longest.is_some());
                assert!(analysis.shortest.is_some_and(|shortest| shortest <= now + 1e-9), "{}", message());
            }
        }
    }
    assert!(over > 165 && bounded > 65, "{over} plans are over, {bounded} of them with a longest time");
}

/// Returns combinations of quark values of a plan, and `true` if these are all combinations. Comparisons of the same
/// signal are consistent, because they are computed from a value of the signal.
fn choices(plan: &Plan, chance: &mut Chance) -> (Vec<QuarkValues>, bool) {
    let is_free = |quark: &Quark| quark.completes || INTERRUPTS.contains(&quark.text.as_str());
    let bits: Vec<usize> = (0..plan.quarks.len()).filter(|number| is_free(&plan.quarks[*number])).collect();
    let is_compared = plan.quarks.iter().any(|quark| quark.comparison.is_some());
    let all = 1 << bits.len().min(20) <= CHOICES && !is_compared;
    let count = if all { 1 << bits.len() } else { CHOICES };
    let message = (0..count).map(|number| {
        let mut fired = vec![false; plan.quarks.len()];
        for (place, bit) in bits.iter().enumerate() {
            fired[*bit] = if all { number >> place & 1 == 1 } else { chance.percent(35) };
        }
        let completed = fired.clone();
        let values = Values::new(chance).texts();
        for (fired, quark) in fired.iter_mut().zip(&plan.quarks).filter(|(_, quark)| quark.comparison.is_some()) {
            *fired = values.contains(&quark.text);
        }
        QuarkValues { fired, completed }
    });
    (message.collect(), all)
}

fn plans() -> Vec<TextFile> {
    let plans: Vec<_> = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect();
    assert!(plans.len() >= 11, "the plans are gone");
    plans
}

fn analysis(path: &str) -> Analysis {
    let text = std::fs::read_to_string(root().join(path)).expect(path);
    let (compiled, message) = judge(&TextFile { path: path.into(), text }, None);
    analyze(&compiled.first().expect(&message).machine)
}

#[test]
fn plans_are_analysed_without_a_false_alarm() {
    for file in plans() {
        let (compiled, _) = judge(&file, None);
        for compiled in compiled {
            let analysis = analyze(&compiled.machine);
            assert_eq!(lints(&compiled.machine), [], "{}", file.path);
            assert!(analysis.atoms.iter().all(|atom| atom.reach == Reach::Runs && atom.ends), "{}", file.path);
            let never: Vec<_> = analysis.atoms.iter().filter(|atom| !atom.never_by.is_empty()).collect();
            assert_eq!(never.len(), 0, "{}", file.path);
        }
    }
}

#[test]
fn the_papers_plans_are_what_the_semantics_say_of_them() {
    // `bumper` guards these plans, so it is removed from their atoms, which end by completion only.
    for (path, laws) in
        [("first_robot", ["path lastPath", "Follow robot2"]), ("second_robot", ["Follow robot1", "Follow robot3"])]
    {
        let analysis = analysis(&format!("plans/paper/{path}.mdle"));
        for law in laws {
            let atom = analysis.atoms.iter().find(|atom| atom.law == law).expect(law);
            assert_eq!(atom.ended_by, ["completed"], "{law}");
        }
        assert_eq!(analysis.scopes[0].ended_by, ["bumper"]);
    }
    // `wait inf` never fires: `align` ends when it completes, and `goAvoid` with a module ends only with the plan.
    let aligned = analysis("plans/paper/lab2_to_lab1.mdle");
    let align: Vec<_> = aligned.atoms.iter().filter(|atom| atom.law.starts_with("align")).collect();
    assert!(align.len() == 2 && align.iter().all(|atom| atom.ended_by == ["completed"]));
    let sound = analysis("plans/paper/sound_following.mdle");
    assert!(sound.atoms[0].ended_by.is_empty() && sound.atoms[0].ends);
    assert_eq!((sound.shortest, sound.longest.seconds), (Some(0.0), None));
}

#[test]
fn an_analysis_is_printed_for_people_and_for_programs() {
    let folder = folder("analyze");
    let plan = "{ Outing (wait 20s OR bumper)\n  (Atom (bumper AND r0 < 1m OR wait 15s) (go 20 0))\n  \
                ((Atom (null) turn 90) (Atom (wait 6s) stop))^2\n  (Atom (wait 9s) stop)\n}\n";
    std::fs::write(folder.join("plan.mdle"), plan).unwrap();
    let message = |arguments: &[&str]| {
        let output = run_mdlec(&folder, &[&["analyze", "plan.mdle"], arguments].concat());
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        format!(
            "$ mdlec analyze plan.mdle {}\n{err}{out}exit status {}\n",
            arguments.join(" "),
            output.status.code().unwrap()
        )
    };
    insta::assert_snapshot!(
        [message(&[]), message(&["--json"]), message(&["--deny-warnings"]), message(&["--plan", "P"])].join("\n")
    );
}

/// Asserts that the sizes in the analysis of a plan are those of its compiled Rust.
fn assert_bytes<P: mdle_runtime::Plan>(path: &str, plan: &P) {
    let bytes = analysis(path).bytes;
    let cursor = size_of::<Cursor<P::Entered, P::Left>>();
    assert_eq!(bytes.state as usize, cursor + size_of::<Frame>(), "{path}");
    assert_eq!(size_of::<Machine<P>>(), bytes.state as usize + size_of::<P>(), "{path}: the rest is the law that runs");
    let fsm = plan.fsm();
    assert_eq!(bytes.machine as usize, size_of_val(fsm.brackets) + size_of_val(fsm.atoms), "{path}");
    let atoms = (0..u32::try_from(fsm.atoms.len()).unwrap()).map(|atom| plan.law(atom));
    let scopes =
        (0..u32::try_from(fsm.brackets.len()).unwrap()).flat_map(|scope| [plan.condition(scope), plan.name(scope)]);
    let texts: Vec<&str> = atoms.chain(scopes).collect();
    let different: BTreeSet<&str> = texts.iter().copied().collect();
    let size = size_of_val(texts.as_slice()) + different.iter().map(|text| text.len()).sum::<usize>();
    assert_eq!(bytes.texts as usize, size, "{path}");
}

#[test]
fn bytes_are_those_of_the_compiled_machine() {
    assert_bytes("plans/lab_tour.mdle", &recorded::lab_tour::LabTour::new());
    assert_bytes("plans/patrol.mdle", &recorded::patrol::Patrol::new());
    // The memories of a plan are an array in its Rust.
    let branching = include_str!("snapshots/machine__golden__rust-branching.snap.rs");
    let memories = analysis("plans/branching.mdle").bytes.memories;
    assert!(memories > 0 && branching.contains(&format!("[false; {memories}]")), "{memories}");
}
