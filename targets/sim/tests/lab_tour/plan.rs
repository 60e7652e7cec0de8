//! The handwritten lab tour, as `mdlec` would emit it: `Tour { Lab2ToLab1Plan FRAME 180deg Lab1ToOfficePlan }`.

use mdle_runtime::fsm::{Atom, Bracket, Kind};
use mdle_runtime::{
    Begin, Bits, Cause, Completes, Control, Cursor, Ending, Fsm, Interrupt, Law, Meters, MetersPerSecond, Nanos, Plan,
    Radians, RadiansPerSecond, SonarId,
};
use mdle_sim::alphabet::{Align, AtIsection, Bumper, Go, GoAvoid, Input, Output, Rotate};

/// Interrupt of an atom itself.
enum Until {
    At([u8; 4]),
    Seconds(u64),
    Null,
}

/// Law of an atom; angles are in degrees and speeds in cm/s.
enum Does {
    GoAvoid(f64),
    Go,
    Align(u8, u8),
    Rotate(f64),
}

/// Atoms of the two plans.
const ATOMS: [(Until, Does); 13] = [
    (Until::At([0, 1, 0, 0]), Does::GoAvoid(90.0)),
    (Until::At([0, 0, 1, 0]), Does::Go),
    (Until::Null, Does::Align(7, 9)),
    (Until::At([1, 0, 0, 0]), Does::GoAvoid(0.0)),
    (Until::At([0, 1, 0, 0]), Does::Go),
    (Until::Null, Does::Align(3, 5)),
    (Until::Seconds(7), Does::GoAvoid(270.0)),
    (Until::At([1, 0, 0, 0]), Does::GoAvoid(270.0)),
    (Until::At([1, 0, 0, 1]), Does::GoAvoid(90.0)),
    (Until::At([0, 0, 1, 1]), Does::Go),
    (Until::Null, Does::Align(11, 13)),
    (Until::At([0, 1, 0, 0]), Does::GoAvoid(180.0)),
    (Until::Seconds(10), Does::Rotate(90.0)),
];
/// Number of the first atom of the second plan, whose frame is turned.
const SECOND: u32 = 8;

/// The running law.
#[allow(clippy::large_enum_variant, reason = "one runs at a time, and goAvoid remembers what it heard")]
enum Running {
    GoAvoid(<GoAvoid as Control<Output>>::Law),
    Go(<Go as Control<Output>>::Law),
    Align(<Align as Control<Output>>::Law),
    Rotate(<Rotate as Control<Output>>::Law),
}

/// The plan of the tour.
pub(crate) struct Tour {
    brackets: Vec<Bracket>,
    atoms: Vec<Atom>,
    running: Option<Running>,
}

impl Tour {
    pub(crate) fn new() -> Self {
        let scope = |level, first, last, parent| Bracket { kind: Kind::Scope { level }, first, last, parent };
        let mut brackets = vec![scope(0, 0, 12, 0)];
        let mut atoms = Vec::new();
        for (first, last) in [(0, SECOND - 1), (SECOND, 12)] {
            let plan = brackets.len() as u32;
            brackets.push(scope(1, first, last, 0));
            for atom in first..=last {
                atoms.push(Atom { scope: brackets.len() as u32, state: u64::from(atom) + 1 });
                brackets.push(scope(2, atom, atom, plan));
            }
        }
        Self { brackets, atoms, running: None }
    }
}

impl Plan for Tour {
    type Output = Output;
    type Input = Input;
    type Entered = [Nanos; 3];
    type Left = [u64; 0];

    fn fsm(&self) -> Fsm<'_> {
        Fsm { brackets: &self.brackets, atoms: &self.atoms, termination: 14 }
    }

    fn slots(&self) -> (Self::Entered, Self::Left) {
        ([Nanos::ZERO; 3], [])
    }

    fn enter(&mut self, atom: u32, y: &Output, begin: Begin) {
        let turned = if atom < SECOND { 0.0 } else { 180.0 };
        let begin = Begin { frame: begin.frame.turned(Radians::from_degrees(turned)), ..begin };
        self.running = Some(match ATOMS[atom as usize].1 {
            Does::GoAvoid(bearing) => Running::GoAvoid(
                GoAvoid::new(Radians::from_degrees(bearing), Meters(40.0), MetersPerSecond(0.2)).begin(y, begin),
            ),
            Does::Go => Running::Go(Go::new(MetersPerSecond(0.0), RadiansPerSecond(0.36)).begin(y, begin)),
            Does::Align(first, second) => {
                Running::Align(Align::new(SonarId::new(first), SonarId::new(second)).begin(y, begin))
            }
            Does::Rotate(heading) => Running::Rotate(Rotate::new(Radians::from_degrees(heading)).begin(y, begin)),
        });
    }

    fn next(&self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Output, t: Nanos) -> Option<Ending> {
        if Bumper::new().fired(y) {
            return Some(Cause::Fired(1).into());
        }
        let own = match ATOMS[cursor.atom() as usize].0 {
            Until::At(bits) => AtIsection::new(Bits(bits.map(|bit| bit == 1))).fired(y),
            Until::Seconds(seconds) => cursor.since(2, t) >= Nanos(seconds * 1_000_000_000),
            Until::Null => false,
        };
        let completed = match self.running.as_ref().expect("entered") {
            Running::GoAvoid(law) => law.completed(y, t),
            Running::Go(_) => false,
            Running::Align(law) => law.completed(y, t),
            Running::Rotate(law) => law.completed(y, t),
        };
        own.then_some(Cause::Fired(2)).or(completed.then_some(Cause::Completed(2))).map(Ending::from)
    }

    fn input(&mut self, y: &Output, t: Nanos) -> Input {
        match self.running.as_mut().expect("entered") {
            Running::GoAvoid(law) => law.input(y, t),
            Running::Go(law) => Law::<Output>::input(law, y, t),
            Running::Align(law) => law.input(y, t),
            Running::Rotate(law) => law.input(y, t),
        }
    }

    fn law(&self, atom: u32) -> &str {
        match atom {
            0 => "goAvoid 90 40 20",
            3 => "goAvoid 0 40 20",
            6 | 7 => "goAvoid 270 40 20",
            8 => "goAvoid 90 40 20",
            11 => "goAvoid 180 40 20",
            2 => "align 7 9",
            5 => "align 3 5",
            10 => "align 11 13",
            12 => "rotate 90",
            _ => "go 0 0.36",
        }
    }

    fn condition(&self, scope: u32) -> &str {
        match scope {
            0 => "null",
            1 | 10 => "bumper",
            2 | 6 | 14 => "atIsection 0100",
            3 => "atIsection 0010",
            5 | 9 => "atIsection 1000",
            8 => "wait 7",
            11 => "atIsection 1001",
            12 => "atIsection 0011",
            15 => "wait 10",
            _ => "null",
        }
    }

    fn name(&self, scope: u32) -> &str {
        match scope {
            0 => "Tour",
            1 => "Lab2ToLab1Plan",
            10 => "Lab1ToOfficePlan",
            _ => "",
        }
    }
}
