//! An order of a machine's states in which all interrupts lead forwards, if there is one; else one that is near it.

use super::{Machine, State};

/// The states such that all leads forwards where nothing leads back, the termination state last. Where several orders do,
/// the first named state and the file's own order come first.
pub(super) fn forwards(machine: &Machine) -> Vec<State> {
    let first = machine.start().unwrap_or(State(0));
    let mut seen = vec![false; machine.states().len()];
    let mut left = Vec::with_capacity(seen.len());
    // Reverse postorder: what is left last comes first.
    for root in machine.atoms().rev().filter(|root| *root != first).chain([first]) {
        leave(machine, root, &mut seen, &mut left);
    }
    left.retain(|state| *state != machine.end());
    left.reverse();
    left.push(machine.end());
    left
}

/// Walks everything that can be reached from a state and was not seen, and notes it when it is left.
fn leave(machine: &Machine, root: State, seen: &mut [bool], left: &mut Vec<State>) {
    if std::mem::replace(&mut seen[root.0 as usize], true) {
        return;
    }
    let mut path = vec![(root, machine.exits(root).len())];
    while let Some((state, untried)) = path.last_mut() {
        match untried.checked_sub(1) {
            None => {
                left.push(*state);
                path.pop();
            }
            Some(place) => {
                *untried = place;
                let to = machine.exits(*state)[place].to;
                if !std::mem::replace(&mut seen[to.0 as usize], true) {
                    path.push((to, machine.exits(to).len()));
                }
            }
        }
    }
}

/// The place of each state in an order.
pub(super) fn places(order: &[State]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    for (place, state) in order.iter().enumerate() {
        places[state.0 as usize] = place;
    }
    places
}

/// Whether every interrupt leads to a later state. If not in the order of [`forwards`], then in none.
pub(super) fn leads_forwards(machine: &Machine, order: &[State]) -> bool {
    let places = places(order);
    let place = |state: State| places[state.0 as usize];
    order.iter().all(|state| machine.exits(*state).iter().all(|exit| place(*state) < place(exit.to)))
}
