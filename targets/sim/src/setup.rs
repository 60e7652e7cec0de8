//! Creates a single run, or a batch of runs with different seeds, from options that are checked before anything moves.

use std::f64::consts::FRAC_PI_2;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Duration;

use mdle_host::clap::ArgMatches;
use mdle_host::{Batch, Watch, WholeFile};
use mdle_runtime::{Meters, Pose, Radians};
use mdle_simulator::{Footprint, Form, Goal, Make, PARTS, Simulated, Start, StartError, StartNoise, Walls, World};

use crate::observed::{Observed, Sounds};
use crate::options;

/// Number of seeds of a batch whose random starts are found before the first run.
const STARTS_BEFORE: usize = 1000;

/// Distance from obstacles, in metres, of a start pose that is proposed, if there is such a pose.
const MARGIN: f64 = 0.2;

/// A world, the robot to simulate in it, and the robot's start pose.
struct Setup {
    world: Arc<World>,
    walls: Walls,
    make: Make,
    start: Pose,
    noise: Option<StartNoise>,
    /// Goal that decides whether a run succeeds; `None` if the option `--goal` is absent.
    goal: Option<Goal>,
    /// Charge of the battery at the start, from 0 to 1.
    charge: f64,
    period: Duration,
}

/// Returns the robot that the options describe. All errors in the options are reported here, before anything moves.
pub(crate) fn robot(matches: &ArgMatches, period: Duration) -> Result<Observed, String> {
    let setup = Setup::of(matches, period)?;
    let robot = setup.robot(setup.make.seed)?;
    let file = |option| options::file(matches, option).map(|path| WholeFile::at(option, path)).transpose();
    let watch = Watch::of(matches, &setup.world)?;
    let robot = robot.written_down(file("trail")?).watched(watch);
    Ok(robot.drawn((file("plot")?, file("record")?), &setup.world, setup.in_words(&options::world_name(matches))))
}

/// Returns the batch of runs that the options request; `None` if the option `--runs` is absent.
pub(crate) fn batch(matches: &ArgMatches, period: Duration) -> Result<Option<Batch<Observed>>, String> {
    let Some(runs) = options::runs(matches) else { return Ok(None) };
    options::agree(matches)?;
    let setup = Setup::of(matches, period)?;
    let first = setup.make.seed.unwrap_or(1);
    if first.checked_add(runs.get() - 1).is_none() {
        return Err(format!("--seed {first}: there are not so many seeds; the last is {}", u64::MAX));
    }
    // A batch is refused as its run alone is, and before the runs of the other seeds.
    (first..).zip(0..runs.get()).take(STARTS_BEFORE).try_for_each(|(seed, _)| setup.placed(Some(seed)).map(drop))?;
    let given = options::given(matches);
    Ok(Some(Batch {
        first,
        runs,
        jobs: options::jobs(matches).or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN),
        json: matches.get_flag("json"),
        robot: Box::new(move |seed| setup.robot(Some(seed))),
        alone: Box::new(move |seed| {
            let seed = ["--seed".to_owned(), seed.to_string(), "--speed".to_owned(), "max".to_owned()];
            given.iter().cloned().chain(seed).collect()
        }),
    }))
}

impl Setup {
    fn of(matches: &ArgMatches, period: Duration) -> Result<Self, String> {
        let make = options::make(matches)?;
        let mut world = options::world(matches)?;
        let goal = options::goal(matches, &world)?;
        // Pictures show the goal that decides.
        world.goal = goal.or(world.goal);
        let walls = Walls::of_any(&world).map_err(|what| format!("--world: {what}"))?;
        let given = options::start(matches)?;
        let Start(start) = given.map_or(Start(world.start), |(_, start)| start);
        let with_option = |error: StartError| {
            let hint = hint(&world, &start, make.form(), &walls);
            match given {
                Some((text, _)) => format!("--start {text}: {error}; {hint}"),
                None => {
                    format!("{}: {error}; {hint}", world.start_at.as_deref().unwrap_or("the world's own start pose"))
                }
            }
        };
        mdle_simulator::check(&start, make.form(), &world, &walls).map_err(with_option)?;
        let noise = options::start_noise(matches)?;
        let charge = options::battery(matches);
        let world = Arc::new(world);
        Ok(Self { world, walls, make, start, noise, goal, charge, period })
    }

    /// Describes the world, the body and the seed, for titles.
    fn in_words(&self, world: &str) -> String {
        let Make { body, without, seed } = &self.make;
        let names =
            without.iter().map(|part| PARTS.iter().find(|(_, known)| known == part).map_or("", |(name, _)| name));
        let names: Vec<&str> = names.collect();
        let without = if names.is_empty() { String::new() } else { format!(" without {}", names.join(", ")) };
        let seed = seed.map_or("no seed".to_owned(), |seed| format!("seed {seed}"));
        format!("world {world}, body {body}{without}, {seed}")
    }

    /// Returns the start pose of the run with this seed.
    fn placed(&self, seed: Option<u64>) -> Result<Pose, String> {
        let Some(noise) = self.noise else { return Ok(self.start) };
        let seed = seed.ok_or("--start-noise: by which chance? Give a seed, as in `--seed 1`")?;
        noise.pose(&self.start, seed, self.make.form(), &self.world, &self.walls).map_err(|error| {
            format!("--start-noise: no random start has room; the last one tried: {error}; give less, as in `0.1,5`")
        })
    }

    /// Returns the robot for the run with this seed, which determines the errors and the start pose.
    fn robot(&self, seed: Option<u64>) -> Result<Observed, String> {
        let make = Make { seed, ..self.make.clone() };
        let start = self.placed(seed)?;
        let robot = Simulated::with(&make, &self.world, start, self.period).map_err(|error| error.to_string())?;
        let sounds = Sounds { world: Arc::clone(&self.world), seed: seed.unwrap_or_default() };
        Ok(Observed::from(robot.charged(self.charge)).judged_by(self.goal).among(sounds))
    }
}

/// Returns a hint for error messages: an option with a pose near `start` at which a robot of this form can start or, if
/// there is none, with the world's own start pose.
fn hint(world: &World, start: &Pose, form: Form, walls: &Walls) -> String {
    let fits = |pose: &Pose| mdle_simulator::check(pose, form, world, walls).is_ok();
    let option = |Pose { x, y, theta }: Pose| {
        // Degrees that were read from a file may have a rounding error in their last digit.
        let degrees = libm::round(theta.degrees() * 1e6) / 1e6;
        format!("`--start {},{},{degrees}`", x.0, y.0)
    };
    // A place with some room is better than the nearest one, from which the robot can hardly turn.
    let is_clear = |pose: &Pose| walls.gap(&Footprint { pose: *pose, form }, MARGIN) >= MARGIN;
    let clear = around(start).find(|pose| is_clear(pose) && fits(pose));
    match clear.or_else(|| around(start).find(fits)) {
        Some(pose) => format!("there is room at {}", option(pose)),
        None if fits(&world.start) => format!("the world's own start is {}", option(world.start)),
        None => "no place with room was found within 2 m of this start".to_owned(),
    }
}

/// Returns poses in steps of 10 cm up to 2 m from `start` along both axes, the nearest first; each with the heading of
/// `start` and at a right angle to it.
fn around(start: &Pose) -> impl Iterator<Item = Pose> {
    let steps = (-20..=20).flat_map(|right: i32| (-20..=20).map(move |up: i32| (right, up)));
    let mut steps: Vec<_> = steps.collect();
    steps.sort_by_key(|(right, up)| right * right + up * up);
    let moved = |from: Meters, step: i32| Meters(libm::round(100.0 * from.0 + 10.0 * f64::from(step)) / 100.0);
    let Pose { x, y, theta } = *start;
    let headings = [theta, Radians(theta.0 + FRAC_PI_2).wrapped()];
    let at = move |(right, up)| headings.map(|theta| Pose { x: moved(x, right), y: moved(y, up), theta });
    steps.into_iter().flat_map(at)
}
