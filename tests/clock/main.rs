//! Tests of executables on emulated robots by the clock: signals, suspension and faults. No other test program runs at
//! the same time; most of the time these tests wait.

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicU16, Ordering};
use std::thread;

mod bad_line;
mod faults;
mod groups;
mod links;
mod phases;
mod pursuits;
mod scenarios;
mod sent_plans;
mod sessions;
mod signalled;
mod stands;

/// Tests of robots whose executables must be built first, which can take long. They form a single test, so that other
/// tests do not wait for the build.
#[test]
fn a_built_robot_stands_after_faults() {
    at_once(&[
        faults::each_fault_stops_the_robot_or_is_borne,
        faults::by_the_clock_a_fault_ends_the_program_in_time,
        stands::robots_stand_at_every_end_of_a_run,
    ]);
}

/// Tests of robots whose programs are linked. They form a single test, because each of them waits most of the time.
#[test]
fn linked_robots_go_by_the_clock() {
    at_once(&[
        groups::each_program_runs_the_part_of_its_link,
        links::three_processes_meet_and_go_on_when_one_is_killed,
        links::a_robot_with_another_key_is_no_peer,
        pursuits::simulated_robots_learn_over_a_bad_line,
        pursuits::the_commands_of_the_book_begin_a_pursuit,
        pursuits::scouts_in_one_world_learn_over_tcp,
        pursuits::a_program_that_dies_leaves_no_scout_waiting,
        sent_plans::a_plan_reads_a_module_of_another_process,
        sent_plans::a_plan_takes_over_in_another_process,
        sent_plans::a_plan_with_another_key_is_refused,
        sent_plans::a_plan_of_a_stranger_is_refused,
        sent_plans::a_plan_for_a_stranger_is_not_sent,
        sent_plans::a_plan_that_the_other_robot_cannot_run_is_refused,
    ]);
}

/// Runs these tests at the same time, because each of them waits most of the time.
fn at_once(rules: &[fn()]) {
    thread::scope(|scope| rules.iter().for_each(|rule| drop(scope.spawn(rule))));
}

/// Returns addresses at which no program listens. Each call uses a different host, because another test could otherwise
/// take one of these free ports before the robots use it.
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
fn addresses<const COUNT: usize>() -> [SocketAddr; COUNT] {
    static HOST: AtomicU16 = AtomicU16::new(2);
    let [high, low] = HOST.fetch_add(1, Ordering::Relaxed).to_be_bytes();
    let host = Ipv4Addr::new(127, 0, high, low);
    let listeners = [(); COUNT].map(|()| TcpListener::bind((host, 0)).unwrap());
    listeners.map(|listener| listener.local_addr().unwrap())
}
