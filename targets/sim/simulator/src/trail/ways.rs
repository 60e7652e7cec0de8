//! Stores the path of a robot, divided by atoms. The number of stored positions is limited, and each pass of an atom
//! has its own part of the path.

use std::collections::BTreeMap;

use mdle_runtime::Nanos;

use crate::point::Point;

/// Minimum distance between two stored positions, in metres; a smaller distance is less than a pixel.
const APART: f64 = 0.01;
/// Maximum number of stored positions of the path; above it, every second position is removed.
const PLACES_MOST: usize = 100_000;
/// Maximum number of passes whose paths are stored separately, and of atoms that are counted.
const MARKS_MOST: usize = 10_000;

/// The path of a robot, and the atoms that drove it.
#[derive(Debug, Clone)]
pub(crate) struct Ways {
    /// Path before the first atom began.
    pub(crate) before: Vec<Point>,
    /// Passes of atoms, in order.
    pub(crate) marks: Vec<Mark>,
    /// Atoms of the plan's text, in the order in which they first began.
    pub(crate) atoms: Vec<TrailAtom>,
    /// Number of times that an atom outside `atoms` began.
    pub(crate) uncounted: usize,
    /// Index in `atoms` by number and law. Numbers alone are ambiguous, because plans that replace each other may use
    /// the same numbers.
    by_number: BTreeMap<(u64, String), usize>,
    /// Index of the running atom, and the time up to which its total time has been counted; `None` while none of the
    /// atoms in `atoms` runs.
    running: Option<(usize, Nanos)>,
    /// Number of stored positions.
    count: usize,
    /// Current minimum distance between two stored positions, in metres.
    apart: f64,
}

/// An atom of the plan's text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TrailAtom {
    /// Number of the atom's state in the first pass of the enclosing loops.
    pub(crate) number: u64,
    pub(crate) law: String,
    /// Position where the atom first began.
    pub(crate) place: Point,
    /// Number of times that the atom began.
    pub(crate) times: u64,
    /// Total time for which the atom ran.
    pub(crate) total: Nanos,
}

/// A pass of an atom, with its path.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mark {
    /// Index of the atom in [`Ways::atoms`]; `None` for the mark that combines all passes beyond the maximum number.
    pub(crate) atom: Option<usize>,
    pub(crate) t: Nanos,
    /// Path, from the position where the pass began.
    pub(crate) way: Vec<Point>,
}

impl Ways {
    /// Returns a path that begins at `place`.
    pub(super) fn from(place: Point) -> Self {
        Self {
            before: vec![place],
            marks: Vec::new(),
            atoms: Vec::new(),
            uncounted: 0,
            by_number: BTreeMap::new(),
            running: None,
            count: 1,
            apart: APART,
        }
    }

    /// Records that the robot is at `place`.
    pub(super) fn went(&mut self, place: Point) {
        let apart = self.apart;
        let way = self.last();
        if way.last().is_none_or(|last| libm::hypot(last.x - place.x, last.y - place.y) >= apart) {
            way.push(place);
            self.count += 1;
        }
        if self.count > PLACES_MOST {
            self.thin();
        }
    }

    /// Adds the path that a robot of a fleet has driven, up to the time `until`.
    pub(crate) fn drove(&mut self, number: u64, name: &str, way: &[Point], until: Nanos) {
        let Some(place) = way.first().copied() else { return };
        self.marks.push(Mark { atom: Some(self.atoms.len()), t: Nanos::ZERO, way: way.to_vec() });
        self.atoms.push(TrailAtom { number, law: name.to_owned(), place, times: 1, total: until });
    }

    /// Returns the path of the current pass.
    fn last(&mut self) -> &mut Vec<Point> {
        self.marks.last_mut().map_or(&mut self.before, |mark| &mut mark.way)
    }

    /// Removes every second position, except positions where an atom began or ended.
    fn thin(&mut self) {
        self.apart *= 2.0;
        self.count = 0;
        for way in std::iter::once(&mut self.before).chain(self.marks.iter_mut().map(|mark| &mut mark.way)) {
            let last = way.len().saturating_sub(1);
            let mut number = 0;
            way.retain(|_| {
                number += 1;
                number % 2 == 1 || number > last
            });
            self.count += way.len();
        }
    }

    /// Records that an atom begins at `place`.
    pub(super) fn began(&mut self, number: u64, law: &str, t: Nanos, place: Point) {
        self.passed(t);
        let atom = self.atom(number, law, place);
        self.running = atom.map(|atom| (atom, t));
        match atom.and_then(|atom| self.atoms.get_mut(atom)) {
            Some(atom) => atom.times = atom.times.saturating_add(1),
            None => self.uncounted = self.uncounted.saturating_add(1),
        }
        // The last mark contains the path of all passes beyond the maximum number.
        if self.marks.len() > MARKS_MOST {
            return;
        }
        let atom = atom.filter(|_| self.marks.len() < MARKS_MOST);
        let way = self.last();
        if way.last() != Some(&place) {
            way.push(place);
            self.count += 1;
        }
        self.count += 1;
        self.marks.push(Mark { atom, t, way: vec![place] });
    }

    /// Returns the index of an atom in `atoms`, and appends the atom if it is new; `None` if the list is full.
    fn atom(&mut self, number: u64, law: &str, place: Point) -> Option<usize> {
        let next = self.atoms.len();
        let key = (number, law.to_owned());
        let found = self.by_number.get(&key).copied();
        found.or_else(|| {
            (next < MARKS_MOST).then(|| {
                self.by_number.insert(key, next);
                self.atoms.push(TrailAtom { number, law: law.to_owned(), place, times: 0, total: Nanos::ZERO });
                next
            })
        })
    }

    /// Adds the time up to `t` to the total of the running atom.
    pub(crate) fn passed(&mut self, t: Nanos) {
        if let Some((atom, since)) = &mut self.running
            && let Some(atom) = self.atoms.get_mut(*atom)
        {
            atom.total = Nanos(atom.total.0.saturating_add(t.since(*since).0));
            *since = t;
        }
    }

    /// Records that the plan has ended at time `t`.
    pub(super) fn ended(&mut self, t: Nanos) {
        self.passed(t);
        self.running = None;
    }

    /// Returns all recorded positions.
    pub(super) fn places(&self) -> impl Iterator<Item = Point> {
        self.before.iter().chain(self.marks.iter().flat_map(|mark| &mark.way)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(seconds: u64) -> Nanos {
        Nanos(seconds * 1_000_000_000)
    }

    #[test]
    fn passes_of_an_atom_are_counted_and_timed_together() {
        let mut ways = Ways::from(Point { x: 0.0, y: 0.0 });
        for pass in 0..3 {
            let place = Point { x: pass as f64, y: 0.0 };
            ways.began(1, "go 20 0", seconds(10 * pass), place);
            ways.began(2, "turn 90", seconds(10 * pass + 7), place);
            ways.passed(seconds(10 * pass + 8));
        }
        ways.ended(seconds(30));
        ways.passed(seconds(40));
        let counted: Vec<_> = ways.atoms.iter().map(|atom| (atom.number, atom.times, atom.total.seconds())).collect();
        assert_eq!(counted, [(1, 3, 21.0), (2, 3, 9.0)]);
        assert_eq!((ways.atoms[1].place, ways.marks.len()), (Point { x: 0.0, y: 0.0 }, 6));
    }

    #[test]
    fn a_long_way_is_thinned_and_keeps_its_ends() {
        let mut ways = Ways::from(Point { x: 0.0, y: 0.0 });
        for metre in 0..20_000_u32 {
            let place = |x: f64| Point { x, y: 0.0 };
            ways.began(u64::from(metre % 3), "go 20 0", seconds(u64::from(metre)), place(f64::from(metre)));
            (0..50).for_each(|cm| ways.went(place(f64::from(metre) + f64::from(cm) / 50.0)));
        }
        let kept = ways.places().count();
        assert!((PLACES_MOST / 3..=PLACES_MOST + 1).contains(&kept), "{kept}");
        assert_eq!((ways.marks.len(), ways.uncounted), (MARKS_MOST + 1, 0));
        assert_eq!(ways.atoms.iter().map(|atom| atom.times).sum::<u64>(), 20_000);
        assert_eq!(ways.before.first(), Some(&Point { x: 0.0, y: 0.0 }));
        assert!(ways.places().last().is_some_and(|last| 19_999.98 - last.x < ways.apart), "{:?}", ways.places().last());
        // The mark that combines the last passes does not belong to an atom.
        assert!(ways.marks.last().is_some_and(|mark| mark.atom.is_none()));
    }
}
