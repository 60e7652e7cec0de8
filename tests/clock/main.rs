//! Executables on emulated robots by the clock: signals, suspension and faults. Nothing else runs beside these tests.

mod bad_line;
mod faults;
mod groups;
mod links;
mod phases;
mod pursuits;
mod scenarios;
mod signalled;
mod stands;

/// Runs these at the same time: for most of their time they wait.
fn at_once(rules: &[fn()]) {
    std::thread::scope(|scope| rules.iter().for_each(|rule| drop(scope.spawn(rule))));
}
