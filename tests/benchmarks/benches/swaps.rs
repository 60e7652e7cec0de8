//! Measures the swap of plans of 10,000 atoms, which are compiled and swapped in four times per second in an engine at
//! 1 kHz on two workers: the duration of a turn in which a new plan begins, compared with all other turns, and the time
//! from a request to the first turn of its plan.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::load::{self, Loaded};
use mdle_engine::{CompiledPlans, Engine, Library, PlanEvent, PlanFacts, PlanSource, StoredPlan, When};
use mdle_host::{Microphones, Pilot as _, PilotTurn, RunTerms, StopRequest, Time, Transitions, claim_for_worker};
use mdle_runtime::{Nanos, Robot as _, Twist};
use mdle_sim::alphabet::Alphabet;
use mdle_sim::{Simulated, World};
use mdle_tests::golden;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

const PERIOD: Duration = Duration::from_millis(1);
/// Number of atoms of a plan.
const ATOMS: usize = 10_000;
/// Number of turns from one request to the next.
const EACH: u64 = 250;
/// Number of requests to swap in a plan.
const SWAPS: u64 = 80;

fn main() {
    let first = loaded("{ First (bumper) (Atom (null) stop) }").expect("a plan").plan();
    let terms = RunTerms {
        time: Time::Wall,
        period: PERIOD,
        request: StopRequest::default(),
        microphones: Microphones::default(),
    };
    let mut engine = Engine::<Alphabet>::new(first, &Library::new(), &terms).expect("an engine");
    engine.plans_mut().compile_with(Box::new(compiled)).expect("a thread");
    engine.plans_mut().set_trial(Nanos(50_000_000));
    // Texts are made in advance, because they come from another thread in a session.
    let texts: Vec<_> = (0..SWAPS).map(text).collect();
    claim_for_worker();
    let [mut swaps, mut others, mut waits] = turns(&mut engine, texts);
    println!("{:<36}{:>8}{:>10}{:>10}{:>10}", "", "count", "p50", "p99", "most");
    let [swap, other, wait] = [&mut swaps, &mut others, &mut waits].map(|nanos| quantiles(nanos));
    let rows = [("turn with a swap, µs", swaps.len(), swap), ("any other turn, µs", others.len(), other)];
    for (name, count, [middle, high, most]) in rows {
        println!("{name:<36}{count:>8}{:>10.1}{:>10.1}{:>10.1}", middle / 1e3, high / 1e3, most / 1e3);
    }
    let [middle, high, most] = wait.map(|nanos| nanos / 1e6);
    println!("{:<36}{:>8}{middle:>10.1}{high:>10.1}{most:>10.1}", "text to first turn, ms", waits.len());
    // A request that is not yet compiled when the next request arrives is superseded.
    println!("{:<36}{:>8}", "superseded requests", SWAPS - swaps.len() as u64);
    println!("p99 of a turn with a swap: {:.2} times that of any other", swap[1] / other[1]);
}

/// Runs the turns, with a request every [`EACH`] turns. Returns, in nanoseconds, the durations of turns in which a new
/// plan begins, the durations of all other turns, and the times from each request to the first turn of its plan.
fn turns(engine: &mut Engine<Alphabet>, texts: Vec<String>) -> [Vec<u64>; 3] {
    let world = World::named("hall").expect("a world").expect("a good world");
    let mut robot = Simulated::new(&world, world.start, Some(1), PERIOD).expect("a robot");
    let y = robot.exchange(&Twist::default()).expect("an output");
    let [mut swaps, mut others, mut waits] = [(); 3].map(|()| Vec::with_capacity(100_000));
    let (mut transitions, mut texts) = (Transitions::default(), texts.into_iter());
    let mut asked = Vec::with_capacity(texts.len());
    let mut deadline = clock_gettime(ClockId::Monotonic);
    // After the last request, the turns continue until its plan takes over and its trial ends.
    for number in 0..(SWAPS + 2) * EACH {
        let begun = Instant::now();
        let t = Nanos(number * PERIOD.as_nanos() as u64);
        engine.turn(PilotTurn { y: &y, t, number }, &mut transitions).expect("a turn");
        let nanos = begun.elapsed().as_nanos() as u64;
        let mut begins = None;
        for event in engine.plans_mut().take_events() {
            if let PlanEvent::Refused(_, sentence) = &event {
                panic!("{sentence}");
            }
            if let PlanEvent::Began(number) = event {
                begins = Some(number);
            }
        }
        match asked.iter().find(|(number, _)| Some(*number) == begins) {
            Some((_, asked)) => {
                swaps.push(nanos);
                waits.push(Instant::elapsed(asked).as_nanos() as u64);
            }
            None => others.push(nanos),
        }
        if number % EACH == EACH - 1
            && let Some(text) = texts.next()
        {
            let now = Instant::now();
            asked.push((engine.plans_mut().swap(PlanSource::Text(text), When::Now), now));
        }
        let nanos = deadline.tv_nsec + PERIOD.as_nanos() as i64;
        deadline = Timespec { tv_sec: deadline.tv_sec + nanos / 1_000_000_000, tv_nsec: nanos % 1_000_000_000 };
        clock_nanosleep_absolute(ClockId::Monotonic, &deadline).expect("sleep");
    }
    assert!(!swaps.is_empty(), "no plan took over");
    [swaps, others, waits]
}

/// Returns the text of a plan of [`ATOMS`] atoms, which differs for each `number`.
fn text(number: u64) -> String {
    let mut text = String::from("{ Swapped (bumper)\n");
    for atom in 0..ATOMS {
        writeln!(text, "  (Atom (wait {}s AND NOT (x > 1000m)) (go 30 0))", 1000 + number + atom as u64)
            .expect("a text");
    }
    text + "}\n"
}

fn compiled(source: &PlanSource) -> Result<CompiledPlans<Alphabet>, String> {
    let PlanSource::Text(text) = source else { return Err("a text is expected".to_owned()) };
    let plan = StoredPlan {
        name: "Swapped".into(),
        files: [("swapped".to_owned(), text.clone())].into(),
        loaded: loaded(text)?,
        facts: PlanFacts::default(),
    };
    Ok(CompiledPlans { plans: vec![plan], warnings: String::new() })
}

fn loaded(text: &str) -> Result<Arc<Loaded<Alphabet>>, String> {
    let alphabet = golden::alphabet(Some("sim"));
    let mut sources = Sources::default();
    let (mut plans, found) = mdle_compiler::compile(sources.add("plan.mdle", text), text, &alphabet, None);
    let plan = plans.pop().ok_or_else(|| format!("{found:?}"))?;
    load::load(&plan.machine, &sources, &alphabet).map(Arc::new).map_err(|error| error.to_string())
}

/// Returns the median, the 99th percentile and the maximum, or zeros if there are no measurements.
fn quantiles(nanos: &mut [u64]) -> [f64; 3] {
    nanos.sort_unstable();
    let at = |place: usize| nanos.get(place).map_or(0.0, |nanos| *nanos as f64);
    [at(nanos.len() / 2), at(nanos.len() * 99 / 100), at(nanos.len().saturating_sub(1))]
}
