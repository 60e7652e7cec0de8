//! Applies Theorem 1 to machines without loops (R1 to R3). Only one order of the states is possible, and it determines
//! the states that each interrupt encloses.

use std::cmp::Reverse;

use super::order::places;
use super::{Broken, InterruptId, Machine, ScopeRun, State, Stretch};

/// Returns the scopes of all interrupts. In `order`, all interrupts must lead forwards.
///
/// No other order is possible: each state leads to the next one, and in any other order an interrupt would lead back.
///
/// # Errors
/// Returns all conditions that the machine breaks.
pub(super) fn runs(machine: &Machine, order: &[State]) -> Result<Vec<ScopeRun>, Vec<Broken>> {
    let mut broken = Vec::new();
    if let (Some(start), [first, ..]) = (machine.start(), order)
        && start != *first
    {
        broken.push(Broken::StartNotFirst { start, first: *first });
    }
    let (mut runs, skips) = cut(machine, order);
    broken.extend(atoms(machine, order, &runs));
    broken.extend(skips);
    runs.sort_by_key(|run| (run.first, Reverse(run.last), run.interrupt));
    broken.extend(crossings(order, &runs));
    if broken.is_empty() { Ok(runs) } else { Err(broken) }
}

/// Combines the transitions of an interrupt from consecutive positions to the same destination into runs (R2). Returns
/// the runs that end just before their destination, and the conditions that all other runs break.
pub(super) fn cut(machine: &Machine, order: &[State]) -> (Vec<ScopeRun>, Vec<Broken>) {
    let places = places(order);
    let (mut runs, mut skips) = (Vec::new(), Vec::new());
    for ([interrupt, to], listed) in by_destination(machine, order) {
        let (interrupt, to) = (InterruptId(interrupt), State(to));
        let behind = places[to.0 as usize];
        for part in listed.chunk_by(|one, next| one + 1 == *next) {
            let (Some(first), Some(last)) = (part.first(), part.last()) else { continue };
            let run = ScopeRun { interrupt, first: *first, last: *last, to: behind };
            end(machine, order, run, &mut runs, &mut skips);
        }
    }
    (runs, skips)
}

/// Appends `run` to `runs` if its destination is the state directly after its last state. Otherwise, the interrupt of
/// `run` leads past a state, and the condition that is broken is appended to `skips`.
fn end(machine: &Machine, order: &[State], run: ScopeRun, runs: &mut Vec<ScopeRun>, skips: &mut Vec<Broken>) {
    if run.last + 1 == run.to {
        runs.push(run);
        return;
    }
    let past = order[run.last + 1];
    skips.push(Broken::Skips {
        interrupt: run.interrupt,
        from: order[run.last],
        to: order[run.to],
        past,
        other: machine.destination(past, run.interrupt),
    });
}

/// Returns, for each interrupt and destination, the ascending positions in `order` of the states from which the
/// interrupt leads to the destination.
fn by_destination(machine: &Machine, order: &[State]) -> Vec<([u32; 2], Vec<usize>)> {
    let mut moves: Vec<([u32; 2], usize)> = Vec::new();
    for (place, state) in order.iter().enumerate() {
        moves.extend(machine.exits(*state).iter().map(|exit| ([exit.interrupt.0, exit.to.0], place)));
    }
    moves.sort_unstable();
    let groups = moves.chunk_by(|(one, _), (other, _)| one == other);
    groups.filter_map(|group| Some((group.first()?.0, group.iter().map(|(_, place)| *place).collect()))).collect()
}

/// Returns the broken conditions of the states that have no interrupt of their own (R1).
fn atoms(machine: &Machine, order: &[State], runs: &[ScopeRun]) -> Vec<Broken> {
    let mut has_own = vec![false; order.len()];
    for run in runs.iter().filter(|run| run.first == run.last) {
        has_own[run.first] = true;
    }
    let lacking = (0..order.len() - 1).filter(|place| !has_own[*place]);
    let why = |place: usize| {
        let (state, next) = (order[place], order[place + 1]);
        let leads_there = machine.exits(state).iter().find(|exit| exit.to == next);
        let Some(exit) = leads_there else { return Broken::SideBySide(state, next) };
        let before = place.checked_sub(1).map(|place| order[place]);
        let before = before.filter(|before| machine.destination(*before, exit.interrupt) == Some(next));
        Broken::NoOwnInterrupt { state, next, shared: before.map(|before| (exit.interrupt, before)) }
    };
    lacking.map(why).collect()
}

/// Returns the broken conditions of pairs of runs that overlap although neither contains the other (R3). `runs` are
/// sorted by their first position, longest first.
pub(super) fn crossings(order: &[State], runs: &[ScopeRun]) -> Vec<Broken> {
    let mut open: Vec<ScopeRun> = Vec::new();
    let mut broken = Vec::new();
    for run in runs {
        while open.last().is_some_and(|around| around.last < run.first) {
            open.pop();
        }
        match open.last() {
            Some(around) if around.last < run.last => broken.push(Broken::Crosses {
                interrupt: around.interrupt,
                around: Stretch { first: order[around.first], last: order[around.last] },
                other: run.interrupt,
                begins: order[run.first],
                goes_on: order[run.last],
            }),
            Some(_) | None => open.push(*run),
        }
    }
    broken
}
