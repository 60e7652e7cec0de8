//! Finds an order of a machine's states in which all interrupts lead forwards or, if there is no such order, in which
//! most interrupts do.

use super::{Machine, State};

/// Returns the states in an order whose last state is the termination state. If the machine has no cycle, all
/// interrupts lead forwards in this order. If there are several such orders, the start state and the order in the file
/// determine the result.
pub(super) fn forwards(machine: &Machine) -> Vec<State> {
    let first = machine.start().unwrap_or(State(0));
    let mut seen = vec![false; machine.states().len()];
    let mut left = Vec::with_capacity(seen.len());
    // Reverse postorder: the state that is left last comes first.
    for root in machine.atoms().rev().filter(|root| *root != first).chain([first]) {
        leave(machine, root, &mut seen, &mut left);
    }
    left.retain(|state| *state != machine.end());
    left.reverse();
    left.push(machine.end());
    left
}

/// Visits all unvisited states that can be reached from `root`, and appends each to `left` after its successors.
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

/// Returns the position in `order` of each state, indexed by the state's index in the file.
pub(super) fn places(order: &[State]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    for (place, state) in order.iter().enumerate() {
        places[state.0 as usize] = place;
    }
    places
}

/// Returns `true` if every interrupt leads to a later state. If the result is `false` for the order of [`forwards`], it
/// is `false` for every order.
pub(super) fn leads_forwards(machine: &Machine, order: &[State]) -> bool {
    let places = places(order);
    let place = |state: State| places[state.0 as usize];
    order.iter().all(|state| machine.exits(*state).iter().all(|exit| place(*state) < place(exit.to)))
}
