//! Handwritten plans whose interrupts fire according to the toy robot's script.

use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Begin, Cause, Cursor, Ending, Fsm, Nanos, Plan};

use super::toy::Sensed;

/// A handwritten plan. The input of atom `a`, numbered as written from 0, is `a + 1`.
#[derive(Debug, Clone)]
pub(super) struct ToyPlan {
    brackets: Vec<Bracket>,
    atoms: Vec<Atom>,
    laws: Vec<&'static str>,
    conditions: Vec<&'static str>,
    names: Vec<&'static str>,
    /// `true` if the current atom's interrupt always fires.
    restless: bool,
    paths: Vec<&'static str>,
    running: u32,
}

impl ToyPlan {
    /// Returns `{ Lab (bumper) (Atom (atIsection 0100) go 20 0) { Turn (wait 10) (Atom (wait inf) rotate 90) (Atom (r3
    /// < r5) stop) } (Atom (heard "stop") null) }`, where `rotate` completes.
    pub(super) fn lab() -> Self {
        Self {
            brackets: vec![
                Bracket::scope(0, 0, 3, 0),
                Bracket::scope(1, 0, 0, 0),
                Bracket::scope(1, 1, 2, 0),
                Bracket::scope(2, 1, 1, 2),
                Bracket::scope(2, 2, 2, 2),
                Bracket::scope(1, 3, 3, 0),
            ],
            atoms: [1, 3, 4, 5].into_iter().zip(1..).map(|(scope, state)| Atom::new(scope, state)).collect(),
            laws: vec!["go 20 0", "rotate 90", "stop", "null"],
            conditions: vec!["bumper", "atIsection 0100", "wait 10", "wait inf", "r3 < r5", "heard \"stop\""],
            names: vec!["Lab", "", "Turn", "", "", ""],
            restless: false,
            paths: Vec::new(),
            running: 0,
        }
    }

    /// Returns this plan with a path to replay.
    pub(super) fn replaying(self) -> Self {
        Self { paths: vec!["hall"], ..self }
    }

    /// Returns `{ Spin (bumper) ((Atom (always) go 20 0))^inf }`: each turn is cut by the limit of transitions.
    pub(super) fn restless() -> Self {
        Self {
            brackets: vec![Bracket::scope(0, 0, 0, 0), Bracket::repeat(0, 0, 0, 0, 0, 0), Bracket::scope(1, 0, 0, 1)],
            atoms: vec![Atom::new(2, 1)],
            laws: vec!["go 20 0"],
            conditions: vec!["bumper", "", "always"],
            names: vec!["Spin", "", ""],
            restless: true,
            paths: Vec::new(),
            running: 0,
        }
    }
}

impl Plan for ToyPlan {
    type Output = Sensed;
    type Input = u32;
    type Entered = Vec<Nanos>;
    type Left = Vec<u64>;

    fn fsm(&self) -> Fsm<'_> {
        Fsm { brackets: &self.brackets, atoms: &self.atoms, termination: self.atoms.len() as u64 + 1 }
    }

    fn slots(&self) -> (Vec<Nanos>, Vec<u64>) {
        (vec![Nanos::ZERO; 3], vec![0; 1])
    }

    fn enter(&mut self, atom: u32, _: &Sensed, _: Begin) {
        self.running = atom;
    }

    fn next(&self, cursor: &Cursor<Vec<Nanos>, Vec<u64>>, y: &Sensed, _: Nanos) -> Option<Ending> {
        let scripted = y.0.iter().find(|(atom, _)| *atom == cursor.atom()).map(|(_, cause)| *cause);
        scripted.or(self.restless.then_some(Cause::Fired(1))).map(Ending::from)
    }

    fn input(&mut self, _: &Sensed, _: Nanos) -> u32 {
        self.running + 1
    }

    fn law(&self, atom: u32) -> &str {
        self.laws[atom as usize]
    }

    fn condition(&self, scope: u32) -> &str {
        self.conditions[scope as usize]
    }

    fn name(&self, scope: u32) -> &str {
        self.names[scope as usize]
    }
    fn paths(&self) -> &[&'static str] {
        &self.paths
    }
}
