//! The modules `pings` and `map` of a run with `--map`, which make an evidence grid while the robot drives
//! (docs/src/navigation.md).
//!
//! `pings` runs in every turn, and stores the pings of the robot's output. `map` runs in the background, and adds the
//! pings up to the last turn break to the grid (docs/src/engine.md), so its published values do not depend on the speed
//! of its thread. At the end of the run, [`MapRun::save`] adds the remaining pings.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_engine::{Background, Declare, Exchange, Fault, In, Library, Module, Offer, Out, Turn};
use mdle_runtime::{Nanos, Pose, Sensed};

use crate::evidence::{GridPing, MapFiles, MapMaker, PingOrder};
use crate::failure;

/// Name of the module that makes the map.
const MAP: &str = "map";
/// Name of the module that stores the pings for the map.
const PINGS: &str = "pings";

/// The map of a run, which the command and the modules share.
#[derive(Debug, Clone)]
pub(crate) struct MapRun {
    files: MapFiles,
    heard: Arc<Mutex<MapPings>>,
    making: Arc<Mutex<Making>>,
}

/// Pings that the module `pings` has stored.
#[derive(Debug)]
struct MapPings {
    order: PingOrder,
    /// Pings that have not been added to the map yet, with the times of their turns.
    waiting: VecDeque<(Nanos, GridPing)>,
    /// Number of pings that have been stored so far.
    count: i64,
    /// `true` once the robot has made a turn.
    has_begun: bool,
}

/// Outcome of saving the map of a whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Saved {
    /// The map has been saved.
    Map,
    /// No sonar has pinged, so there is no map.
    NoPing,
    /// The run was over before its first turn.
    NoTurn,
}

/// The map that is being made.
#[derive(Debug)]
struct Making {
    maker: MapMaker,
    /// `true` once the map of the whole run has been saved.
    is_over: bool,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl MapRun {
    /// Creates the map of a run that begins at the pose `origin`. The map will be saved to `files`.
    pub(crate) fn new(origin: Pose, files: MapFiles) -> Self {
        let making = Making { maker: MapMaker::new(), is_over: false };
        let heard = MapPings { order: PingOrder::new(origin), waiting: VecDeque::new(), count: 0, has_begun: false };
        Self { files, heard: Arc::new(Mutex::new(heard)), making: Arc::new(Mutex::new(making)) }
    }

    /// Registers the modules that make the map.
    pub(crate) fn register(&self, library: &mut Library<Sensed>) {
        let (pings, map) = (self.clone(), self.clone());
        library.registered(PINGS, move |declare| PingsModule::declare(declare, pings.clone()));
        library.background(MAP, move |declare| MapModule::declare(declare, map.clone()));
    }

    /// Adds the pings of the turns up to the time `until` to the map. Returns the locked map.
    fn take(&self, until: Nanos) -> MutexGuard<'_, Making> {
        let mut making = locked(&self.making);
        // The list of pings is locked only while a ping is removed, so that turns wait only briefly.
        let next = || locked(&self.heard).waiting.pop_front_if(|(at, _)| *at <= until);
        while let Some((_, ping)) = next() {
            making.maker.take(&ping);
        }
        making
    }

    /// Saves the map of the pings up to the time `until`, unless the run is over. Returns `false` if nothing was saved.
    fn save_until(&self, until: Nanos) -> Result<bool, String> {
        self.save_made(&self.take(until))
    }

    /// Saves the map of all pings at the end of the run.
    ///
    /// # Errors
    /// Fails with a message if a file cannot be written.
    pub(crate) fn save(&self) -> Result<Saved, String> {
        let mut making = self.take(Nanos(u64::MAX));
        let saved = self.save_made(&making);
        // The thread of the module may still run.
        making.is_over = true;
        Ok(match (saved?, locked(&self.heard).has_begun) {
            (true, _) => Saved::Map,
            (false, true) => Saved::NoPing,
            (false, false) => Saved::NoTurn,
        })
    }

    /// Saves a map. Returns `false` if nothing was saved, because the run is over or the map has no ping. The map stays
    /// locked meanwhile, so that two threads never write its files at the same time.
    fn save_made(&self, making: &Making) -> Result<bool, String> {
        if making.is_over || making.maker.pings() == 0 {
            return Ok(false);
        }
        self.files.save(&making.maker.map()).map(|()| true)
    }
}

/// The module that stores the pings of the robot.
struct PingsModule {
    run: MapRun,
    count: Out<i64>,
}

impl PingsModule {
    fn declare(declare: &mut Declare, run: MapRun) -> Self {
        let module = Self { run, count: declare.publishes("count") };
        declare.doc("Keeps the pings of the robot's sonars for the module `map`.");
        declare.describe("count", "", "Number of pings so far.");
        module
    }
}

impl Module<Sensed> for PingsModule {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let mut heard = locked(&self.run.heard);
        heard.has_begun = true;
        let new = heard.order.take(turn.y);
        heard.count = heard.count.saturating_add(i64::try_from(new.len()).unwrap_or_default());
        heard.waiting.extend(new.into_iter().map(|ping| (turn.now, ping)));
        turn.publish(self.count, heard.count);
        Ok(())
    }
}

/// The module that makes the map and saves it on command.
struct MapModule {
    run: MapRun,
    save: In<bool>,
    pings: Out<i64>,
    cells: Out<i64>,
    saved: Out<i64>,
    /// Time of the last command to save the map; `None` before the first.
    commanded: Option<Nanos>,
    times: i64,
}

impl MapModule {
    fn declare(declare: &mut Declare, run: MapRun) -> Self {
        let module = Self {
            run,
            save: declare.setting("save", false),
            pings: declare.publishes("pings"),
            cells: declare.publishes("cells"),
            saved: declare.publishes("saved"),
            commanded: None,
            times: 0,
        };
        declare.doc("Makes an evidence grid of the sonars' pings, and saves it as a map.");
        declare.describe("save", "", "Setting it to true saves the map of the pings so far, as often as it is set.");
        declare.describe("pings", "", "Number of pings in the map.");
        declare.describe("cells", "", "Number of cells of the map that pings have changed.");
        declare.describe("saved", "", "Number of commands that have saved the map.");
        module
    }

    /// Adds the pings up to the last turn break to the map, and carries out a command to save the map.
    fn turn(&mut self, offer: &mut Offer<'_>) {
        let command = offer.reading(self.save).map(|reading| reading.at);
        if offer.get(self.save) == Some(true) && command != self.commanded {
            self.commanded = command;
            match self.run.save_until(offer.now()) {
                Ok(saved) => self.times = self.times.saturating_add(i64::from(saved)),
                // The map continues to grow, and can be saved later.
                Err(sentence) => failure::warning(&format!("the map {sentence}; it can be saved again")),
            }
        }
        let making = self.run.take(offer.now());
        let (pings, cells) = (making.maker.pings(), making.maker.cells());
        drop(making);
        offer.publish(self.pings, i64::try_from(pings).unwrap_or(i64::MAX));
        offer.publish(self.cells, i64::try_from(cells).unwrap_or(i64::MAX));
        offer.publish(self.saved, self.times);
    }
}

impl Background for MapModule {
    fn run(mut self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        while exchange.exchange(|offer| self.turn(offer)).is_ok() {}
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_without_pings_has_no_map() {
        let folder = std::env::temp_dir().join(format!("mdle-no-map-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let run = MapRun::new(Pose::ORIGIN, MapFiles::new(&folder.join("none.yaml"), None).unwrap());
        assert_eq!(run.save(), Ok(Saved::NoTurn));
        locked(&run.heard).has_begun = true;
        assert_eq!((run.save_until(Nanos::ZERO), run.save()), (Ok(false), Ok(Saved::NoPing)));
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
