//! Executables on emulated robots by the clock: signals, suspension and faults. No other program of tests runs beside
//! them, as they mostly wait.

mod bad_line;
mod faults;
mod groups;
mod links;
mod phases;
mod pursuits;
mod scenarios;
mod sent_plans;
mod signalled;
mod stands;

/// The rules for robots whose executables are built, which takes long where none was built before: in one test, so that
/// the others do not wait for that.
#[test]
fn a_built_robot_stands_after_faults() {
    at_once(&[
        faults::each_fault_stops_the_robot_or_is_borne,
        faults::by_the_clock_a_fault_ends_the_program_in_time,
        stands::robots_stand_at_every_end_of_a_run,
    ]);
}

/// Runs these at the same time: for most of their time they wait.
fn at_once(rules: &[fn()]) {
    std::thread::scope(|scope| rules.iter().for_each(|rule| drop(scope.spawn(rule))));
}
