//! The entries of scopes of a loaded plan: times only, unless the plan needs odometer and heading.

use mdle_runtime::{Entries, Here, Nanometers, Nanos, Output, Radians, Stamp, Stamps};

use crate::fsm::Machine;

/// Storage for the entries of scopes.
#[derive(Debug, Clone, PartialEq)]
pub enum Entered {
    /// Times only.
    Times(Box<[Nanos]>),
    /// Odometer, heading and progress as well, for a plan with `way`, `FRAME here` or `stuck`.
    Stamps(Stamps<Box<[Stamp]>, Box<[Option<Here>]>>),
}

impl Entered {
    /// Returns the storage that a machine needs.
    pub(super) fn of(machine: &Machine) -> Self {
        let levels = machine.sizes().levels;
        if machine.sizes().stamps {
            return Self::Stamps(Stamps::new(vec![Stamp::START; levels].into(), machine.frames().into()));
        }
        Self::Times(vec![Nanos::ZERO; levels].into())
    }
}

impl Entries for Entered {
    #[inline(always)]
    fn is_empty(&self) -> bool {
        match self {
            Self::Times(times) => Entries::is_empty(times),
            Self::Stamps(stamps) => stamps.is_empty(),
        }
    }

    #[inline(always)]
    fn time(&self, level: u16) -> Option<Nanos> {
        match self {
            Self::Times(times) => times.time(level),
            Self::Stamps(stamps) => stamps.time(level),
        }
    }

    #[inline(always)]
    fn note(&mut self, level: u16, t: Nanos) {
        match self {
            Self::Times(times) => times.note(level, t),
            Self::Stamps(stamps) => stamps.note(level, t),
        }
    }

    #[inline(always)]
    fn observe<Y: Output>(&mut self, y: &Y, stalled: Option<Nanos>) {
        match self {
            Self::Times(_) => {}
            Self::Stamps(stamps) => stamps.observe(y, stalled),
        }
    }

    #[inline(always)]
    fn stalled(&self) -> Option<Nanos> {
        match self {
            Self::Times(_) => None,
            Self::Stamps(stamps) => stamps.stalled(),
        }
    }

    fn resume<Y: Output>(&mut self, y: &Y) {
        match self {
            Self::Times(_) => {}
            Self::Stamps(stamps) => stamps.resume(y),
        }
    }

    #[inline(always)]
    fn way(&self, level: u16) -> Nanometers {
        match self {
            Self::Times(times) => times.way(level),
            Self::Stamps(stamps) => stamps.way(level),
        }
    }

    #[inline(always)]
    fn here(&self, atom: u32) -> Option<Here> {
        match self {
            Self::Times(_) => None,
            Self::Stamps(stamps) => stamps.here(atom),
        }
    }

    #[inline(always)]
    fn heading(&self, level: u16) -> Radians {
        match self {
            Self::Times(times) => times.heading(level),
            Self::Stamps(stamps) => stamps.heading(level),
        }
    }
}
