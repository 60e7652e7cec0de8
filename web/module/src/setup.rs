//! The setup of a run, with the same settings as the options of the target `sim`.

use mdle_runtime::{Nanos, Pose};
use mdle_simulator::{Body, Goal, Make, PARTS, Simulated, Start, StartNoise, Walls, World, alphabet, check};
use serde::Deserialize;
use std::time::Duration;

use crate::draft::PageFiles;

/// Maximum duration of a run, in seconds of simulated time.
const LONGEST: f64 = 3600.0;

/// A plan, and the world, the robot and the start of a run.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(crate) struct PageSetup {
    /// Files of the plan.
    #[serde(flatten)]
    pub(crate) draft: PageFiles,
    /// Name of the plan to run; `None` for the only plan.
    pub(crate) plan: Option<String>,
    /// World as TOML.
    pub(crate) world: String,
    /// Name of the world in titles.
    pub(crate) world_name: String,
    /// Body of the robot: `ideal`, `scout` or `atrv`; empty for `ideal`.
    pub(crate) body: String,
    /// Names of the parts of the body's model that are omitted, separated by commas.
    pub(crate) without: String,
    /// Start pose as `x,y,deg`; empty for the start pose of the world.
    pub(crate) start: String,
    /// Maximum random offset of the start pose as `m,deg`; empty for no offset.
    pub(crate) start_noise: String,
    /// Random seed; `None` for a run without random errors.
    pub(crate) seed: Option<u64>,
    /// Charge of the battery at the start, in percent.
    pub(crate) battery: Option<u64>,
    /// Zone in which the robot should end, as `x,y,radius`; empty for the goal of the world.
    pub(crate) goal: String,
    /// Time at which the run ends, in seconds.
    pub(crate) limit: Option<f64>,
}

/// The world, the body and the start pose of a run, after they have been checked.
pub(crate) struct ReadyRun {
    pub(crate) world: World,
    pub(crate) make: Make,
    /// Start pose, which includes the random offset.
    pub(crate) begins: Pose,
    /// Charge of the battery, from 0 to 1.
    charge: f64,
    pub(crate) goal: Option<Goal>,
    pub(crate) limit: Nanos,
}

/// The period of a turn.
pub(crate) const PERIOD: Nanos = alphabet::PERIOD;

impl PageSetup {
    /// Reads and checks the world, the body and the start pose.
    ///
    /// # Errors
    /// Fails if a field is invalid; the message names the field.
    pub(crate) fn ready(&self) -> Result<ReadyRun, String> {
        let make = self.make()?;
        let world = World::parse("world", &self.world).map_err(|error| error.to_string())?;
        let walls = Walls::of_any(&world).map_err(|what| format!("world: {what}"))?;
        let start = if self.start.trim().is_empty() {
            world.start
        } else {
            let Start(pose) = self.start.parse().map_err(|error| format!("start: {error}"))?;
            pose
        };
        check(&start, make.form(), &world, &walls).map_err(|error| format!("start: {error}"))?;
        let begins = match (self.start_noise.trim(), self.seed) {
            ("", _) => start,
            (_, None) => return Err("start noise: it needs a seed".to_owned()),
            (noise, Some(seed)) => {
                let noise = StartNoise::read(noise).map_err(|error| format!("start noise: {error}"))?;
                let pose = noise.pose(&start, seed, make.form(), &world, &walls);
                pose.map_err(|error| format!("start noise: no random start pose is free: {error}"))?
            }
        };
        let battery = self.battery.unwrap_or(100);
        if battery > 100 {
            return Err("battery: expected a percentage from 0 to 100".to_owned());
        }
        let goal = match self.goal.trim() {
            "" | "world" => world.goal,
            text => Some(Goal::read(text).map_err(|error| format!("goal: {error}"))?),
        };
        let limit = self.limit.unwrap_or(LONGEST);
        if !(limit > 0.0 && limit <= LONGEST) {
            return Err(format!("time limit: expected more than 0 s and at most {LONGEST} s"));
        }
        let limit = Nanos((limit * 1e9) as u64);
        Ok(ReadyRun { world, make, begins, charge: battery as f64 / 100.0, goal, limit })
    }

    fn make(&self) -> Result<Make, String> {
        let bodies = [Body::Ideal, Body::Scout, Body::Atrv];
        let body = match self.body.as_str() {
            "" => Body::Ideal,
            name => {
                let known = bodies.into_iter().find(|body| body.to_string() == name);
                known.ok_or_else(|| format!("body: expected `ideal`, `scout` or `atrv`, found {name:?}"))?
            }
        };
        let names = self.without.split(',').map(str::trim).filter(|name| !name.is_empty());
        let part = |name: &str| PARTS.iter().find(|(known, _)| *known == name).map(|(_, part)| *part);
        let without = names.map(|name| part(name).ok_or_else(|| format!("without: {name:?} is no part of a body")));
        Ok(Make { body, without: without.collect::<Result<_, _>>()?, seed: self.seed })
    }

    /// Returns a description of the world, the body and the seed, as in the titles of the pictures of `mdle run
    /// --plot`.
    pub(crate) fn in_words(&self, make: &Make) -> String {
        let parts = make.without.iter().filter_map(|part| PARTS.iter().find(|(_, known)| known == part));
        let names: Vec<&str> = parts.map(|(name, _)| *name).collect();
        let without = if names.is_empty() { String::new() } else { format!(" without {}", names.join(", ")) };
        let seed = make.seed.map_or("no seed".to_owned(), |seed| format!("seed {seed}"));
        format!("world {}, body {}{without}, {seed}", self.world_name, make.body)
    }
}

impl ReadyRun {
    /// Returns the robot at its start.
    ///
    /// # Errors
    /// Fails if the robot cannot start there; the message gives the reason.
    pub(crate) fn robot(&self) -> Result<Simulated, String> {
        let period = Duration::from_nanos(PERIOD.0);
        let robot = Simulated::with(&self.make, &self.world, self.begins, period);
        robot.map(|robot| robot.charged(self.charge)).map_err(|error| format!("start: {error}"))
    }
}
