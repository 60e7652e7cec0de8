//! Stores the entry of each scope of a loaded plan: the time and, if the plan needs them, the odometer reading and the
//! heading.

use mdle_runtime::{Entries, Here, Nanometers, Nanos, Output, Radians, Stamp, Stamps};

use crate::fsm::Machine;

/// Storage for the entry of the scope at each level.
#[derive(Debug, Clone, PartialEq)]
pub struct Entered {
    /// Time at which the scope of each level was entered.
    times: Box<[Nanos]>,
    /// Odometer reading and heading at each entry, and the progress of the law; `None` if the plan needs only times.
    stamps: Option<Box<LevelStamps>>,
}

type LevelStamps = Stamps<Box<[Stamp]>, Box<[Option<Here>]>>;

impl Entered {
    /// Returns the storage that the plan of a machine needs.
    pub(super) fn of(machine: &Machine) -> Self {
        let sizes = machine.sizes();
        Self::new(sizes.levels, sizes.stamps.then_some(machine))
    }

    /// Returns storage for an observed plan. It stores all data of all levels, including levels without timers.
    pub(super) fn observed(machine: &Machine) -> Self {
        Self::new(machine.depth(), Some(machine))
    }

    fn new(levels: usize, has_stamps: Option<&Machine>) -> Self {
        let stamps = |machine: &Machine| Stamps::new(vec![Stamp::START; levels].into(), machine.frames().into());
        Self { times: vec![Nanos::ZERO; levels].into(), stamps: has_stamps.map(stamps).map(Box::new) }
    }

    /// Returns `true` if odometer readings, headings and progress are stored.
    pub(super) fn has_stamps(&self) -> bool {
        self.stamps.is_some()
    }
}

impl Entries for Entered {
    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    #[inline(always)]
    fn time(&self, level: u16) -> Option<Nanos> {
        self.times.time(level)
    }

    #[inline(always)]
    fn note(&mut self, level: u16, t: Nanos) {
        self.times.note(level, t);
        if let Some(stamps) = &mut self.stamps {
            stamps.note(level, t);
        }
    }

    #[inline(always)]
    fn observe<Y: Output>(&mut self, y: &Y, stalled: Option<Nanos>) {
        if let Some(stamps) = &mut self.stamps {
            stamps.observe(y, stalled);
        }
    }

    #[inline(always)]
    fn stalled(&self) -> Option<Nanos> {
        self.stamps.as_ref().and_then(|stamps| stamps.stalled())
    }

    fn resume<Y: Output>(&mut self, y: &Y) {
        if let Some(stamps) = &mut self.stamps {
            stamps.resume(y);
        }
    }

    #[inline(always)]
    fn way(&self, level: u16) -> Nanometers {
        self.stamps.as_ref().map_or(Nanometers::ZERO, |stamps| stamps.way(level))
    }

    #[inline(always)]
    fn here(&self, atom: u32) -> Option<Here> {
        self.stamps.as_ref().and_then(|stamps| stamps.here(atom))
    }

    #[inline(always)]
    fn heading(&self, level: u16) -> Radians {
        self.stamps.as_ref().map_or(Radians(0.0), |stamps| stamps.heading(level))
    }
}
