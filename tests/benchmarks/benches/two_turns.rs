//! Draws the picture of two turns on two cores in docs/src/engine.md, from a run with five modules at 500 Hz. `cargo
//! bench -p mdle-benchmarks --bench two_turns` prints it.
#![allow(clippy::print_stdout, reason = "this is what a benchmark is for")]
#![allow(clippy::expect_used, reason = "a benchmark fails by panicking")]

use std::fmt::Write as _;
use std::hint::spin_loop;
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use mdle_engine::{Candidate, Declare, Fault, Module, Modules, Out, Service, Threads, Turn};
use mdle_host::claim_for_worker;
use mdle_runtime::Nanos;
use rustix::thread::sched_getcpu;

const PERIOD: Duration = Duration::from_millis(2);
/// Number of turns of the run.
const TURNS: u64 = 2000;
/// Modules, each with its name, its work per turn in microseconds, and its priority. The plan is a module, and runs
/// first.
const MODULES: [(&str, u64, i32); 5] =
    [("plan", 180, i32::MAX), ("ears", 90, 0), ("heading", 120, 0), ("map", 400, 0), ("recorder", 200, 0)];
/// Name of the turn break between two turns, which the control thread runs.
const BREAK: &str = "break";

/// Part of a turn that ran on a core.
#[derive(Debug, Clone)]
struct Part {
    turn: u64,
    name: &'static str,
    core: usize,
    begun: Instant,
    ended: Instant,
}

/// A module that is busy for a certain time, and records when and on which core it runs.
struct Busy {
    name: &'static str,
    work: Duration,
    out: Out<f64>,
    notes: Sender<Part>,
}

impl Module<()> for Busy {
    fn turn(&mut self, turn: &mut Turn<'_, ()>) -> Result<(), Fault> {
        let begun = Instant::now();
        while begun.elapsed() < self.work {
            spin_loop();
        }
        turn.publish(self.out, turn.number as f64);
        let part = Part { turn: turn.number, name: self.name, core: sched_getcpu(), begun, ended: Instant::now() };
        self.notes.send(part).map_err(|_| Fault("nobody takes notes".to_owned()))
    }
}

fn main() {
    let parts = run();
    // Of all pairs of consecutive turns on two cores, takes the pair with the median working time.
    let pairs = (TURNS / 2..TURNS - 2).map(|turn| {
        let pair: Vec<_> = parts.iter().filter(|part| part.turn == turn || part.turn == turn + 1).cloned().collect();
        let busy: Duration = pair.iter().map(|part| part.ended - part.begun).sum();
        (busy, pair)
    });
    let has_two_cores = |(_, pair): &(Duration, Vec<Part>)| {
        let mut cores: Vec<_> = pair.iter().map(|part| part.core).collect();
        cores.sort_unstable();
        cores.dedup();
        cores.len() == 2 && pair.len() == 2 * (MODULES.len() + 1)
    };
    let mut pairs: Vec<_> = pairs.filter(has_two_cores).collect();
    pairs.sort_by_key(|(busy, _)| *busy);
    let (_, pair) = pairs.get(pairs.len() / 2).expect("two turns on two cores");
    print!("{}", drawn(pair));
}

/// Runs the turns, and returns their parts.
fn run() -> Vec<Part> {
    let mut modules = Modules::new(Threads::Workers(2, claim_for_worker), Service::WhenReady).expect("threads");
    let (notes, parts) = channel();
    for (name, work, priority) in MODULES {
        let make = |declare: &mut Declare| {
            declare.priority(priority);
            let (out, notes) = (declare.publishes("turns"), notes.clone());
            Busy { name, work: Duration::from_micros(work), out, notes }
        };
        modules.load(Candidate::registered(name, make).expect("a module")).expect("loaded");
    }
    modules.prepare();
    claim_for_worker();
    let origin = Instant::now();
    for number in 0..TURNS {
        let next = origin + PERIOD * u32::try_from(number).expect("a number of turns");
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
        let now = Nanos(number * PERIOD.as_nanos() as u64);
        modules.turn((), number, now, Some(Instant::now() + PERIOD));
        let begun = Instant::now();
        modules.settle();
        modules.prepare();
        let part = Part { turn: number, name: BREAK, core: sched_getcpu(), begun, ended: Instant::now() };
        notes.send(part).expect("the notes");
    }
    parts.try_iter().collect()
}

/// Returns an SVG picture of two turns, given their parts.
fn drawn(parts: &[Part]) -> String {
    let zero = parts.iter().map(|part| part.begun).min().expect("a part");
    let micros = |at: Instant| (at - zero).as_secs_f64() * 1e6;
    // The time between the two turns is cut out.
    let first = parts.iter().filter(|part| part.turn == parts[0].turn);
    let end = first.clone().map(|part| micros(part.ended)).fold(0.0, f64::max);
    let second = parts.iter().filter(|part| part.turn != parts[0].turn);
    let next = second.map(|part| micros(part.begun)).fold(f64::INFINITY, f64::min);
    let gap = next - end - 60.0;
    let across = |at: Instant| 70.0 + 0.42 * if micros(at) >= next { micros(at) - gap } else { micros(at) };
    let mut cores: Vec<_> = parts.iter().map(|part| part.core).collect();
    cores.sort_unstable();
    cores.dedup();
    let wide = parts.iter().map(|part| across(part.ended)).fold(0.0, f64::max) + 40.0;
    let mut picture = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide:.0} 150\" width=\"{wide:.0}\" height=\"150\">\n\
         <title>Two turns of five modules on two cores</title>\n\
         <style>text {{ font: 12px system-ui, sans-serif; fill: #1b1f24; }} rect {{ fill: #e9f4ee; stroke: #3f8f6b; }}\n\
         rect.break {{ fill: #c2410c; stroke: #c2410c; }} rect.paper {{ fill: #fff; stroke: none; }}\n\
         @media (prefers-color-scheme: dark) {{ text {{ fill: #e6e9ee; }} rect {{ fill: #17352a; stroke: #5cc19a; }}\n\
         rect.break {{ fill: #ffa97a; stroke: #ffa97a; }} rect.paper {{ fill: #15191e; }} }}</style>\n\
         <rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n"
    );
    for (row, _) in cores.iter().enumerate() {
        let y = 40 + 45 * row;
        let _ = writeln!(picture, "<text x=\"8\" y=\"{}\">core {}</text>", y + 19, row + 1);
    }
    for part in parts {
        let row = cores.iter().position(|core| *core == part.core).unwrap_or_default();
        let (x, y) = (across(part.begun), 40 + 45 * row);
        let width = (across(part.ended) - x).max(1.5);
        let class = if part.name == BREAK { " class=\"break\"" } else { "" };
        let _ = writeln!(picture, "<rect{class} x=\"{x:.1}\" y=\"{y}\" width=\"{width:.1}\" height=\"30\"/>");
        let above = if part.name == BREAK { y - 5 } else { y + 19 };
        let _ = writeln!(picture, "<text x=\"{:.1}\" y=\"{above}\">{}</text>", x + 3.0, part.name);
    }
    for (turn, at) in [(1, zero), (2, zero + Duration::from_secs_f64(next / 1e6))] {
        let _ = writeln!(picture, "<text x=\"{:.1}\" y=\"15\">turn {turn}</text>", across(at));
    }
    let _ = writeln!(
        picture,
        "<text x=\"70\" y=\"142\">busy for {:.0} µs and {:.0} µs of 2000 µs each; the rest of the first period is cut out</text>",
        end,
        parts.iter().map(|part| micros(part.ended)).fold(0.0, f64::max) - next
    );
    picture + "</svg>\n"
}
