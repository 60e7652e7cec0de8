//! Tests of the map of the obstacles around the robot.

use super::*;
use crate::trial::{Sensed, sized};

const AHEAD: SonarId = SonarId::new(0);

/// Updates the map with the newest pings, of all sonars.
fn take(map: &mut Map, y: &Sensed) {
    (0..THIRDS).for_each(|_| map.take(y, y.pose));
}

/// Returns a map that has been updated with pings straight ahead, 0.1 s apart, and the last output.
fn heard(ranges: &[Option<f64>], confirmation: usize) -> (Map, Sensed) {
    let (mut y, mut map) = (Sensed { confirmation, ..Sensed::default() }, Map::EMPTY);
    for range in ranges {
        y.now = Nanos(y.now.0 + 100_000_000);
        y.ping_at(AHEAD, *range, y.now);
        take(&mut map, &y);
    }
    (map, y)
}

/// Returns `true` if an object is at this distance ahead of the origin.
fn is_ahead(map: &Map, distance: f64) -> bool {
    map.is_occupied(Cell::of(distance, 0.0))
}

#[test]
fn an_echo_comes_from_its_arc_and_what_is_before_is_free() {
    let (map, _) = heard(&[Some(0.8)], 3);
    assert!(is_ahead(&map, 0.99) && !is_ahead(&map, 0.9) && !is_ahead(&map, 1.1));
    assert!(map.is_occupied(Cell::of(0.19 + 0.8 * 0.98, 0.8 * 0.18)));
    assert!(!is_unknown(map.evidence(Cell::of(0.6, 0.0))) && is_unknown(map.evidence(Cell::of(1.2, 0.0))));
}

#[test]
fn pings_that_pass_clear_a_cell_but_not_one_missed_echo() {
    assert!(is_ahead(&heard(&[Some(0.8), None], 3).0, 0.99));
    assert!(!is_ahead(&heard(&[Some(0.8), Some(1.2)], 3).0, 0.99));
    assert!(!is_ahead(&heard(&[Some(0.8), None, None], 3).0, 0.99));
    let often = [Some(0.8); 4];
    let (map, mut y) = heard(&often, 3);
    let mut map = map;
    y.now = Nanos(y.now.0 + 1);
    y.ping_at(AHEAD, Some(1.2), y.now);
    take(&mut map, &y);
    assert!(is_ahead(&map, 0.99), "one ping against four");
}

/// Beside the body, a sonar that points at a jamb may miss it.
#[test]
fn an_object_that_was_heard_often_is_kept_for_two_pings_that_miss_it() {
    let is_kept = |misses: usize| {
        let (echo, miss) = (Some(0.8), Some(1.2));
        let pings = [echo, echo, echo, echo, echo, echo, miss, miss, miss];
        is_ahead(&heard(pings.get(..6 + misses).expect("at most nine pings"), 2).0, 0.99)
    };
    assert_eq!([0, 1, 2, 3].map(is_kept), [true, true, true, false]);
}

#[test]
fn an_echo_that_something_known_explains_adds_nothing_else() {
    let (mut map, mut y) = heard(&[], 3);
    map.occupy((0.97, 0.15), (0.97, 0.15));
    y.now = Nanos(1);
    y.ping_at(AHEAD, Some(0.8), y.now);
    take(&mut map, &y);
    assert!(!is_ahead(&map, 0.99));
}

/// The jamb beside a robot in a doorway is nearer than the least range, and the map has it a cell further back.
#[test]
fn an_object_beside_the_cone_explains_no_echo() {
    let (mut map, mut y) = heard(&[], 2);
    map.occupy((0.375, 0.075), (0.375, 0.075));
    y.now = Nanos(1);
    y.ping_at(AHEAD, Some(0.1524), y.now);
    take(&mut map, &y);
    assert!(is_ahead(&map, 0.19 + INSTEAD));
}

#[test]
fn a_saturated_echo_of_a_wide_body_comes_from_its_whole_arc() {
    let hides = |range: f64| {
        let (mut y, mut map) = (Sensed { confirmation: 2, ..sized(0.315, 0.27) }, Map::EMPTY);
        map.occupy((0.19 + range, 0.02), (0.19 + range, 0.02));
        y.now = Nanos(1);
        y.ping_at(AHEAD, Some(range), y.now);
        take(&mut map, &y);
        !map.is_occupied(Cell::of(0.19 + range, -0.02))
    };
    assert!(!hides(0.15));
    assert!(hides(0.2), "the range shows which cell the echo came from");
}

#[test]
fn an_echo_at_the_least_range_may_be_nearer() {
    let (map, _) = heard(&[Some(0.1524)], 2);
    assert!(is_ahead(&map, 0.19 + INSTEAD) && !is_ahead(&map, 0.19 + 0.1524));
    let (map, _) = heard(&[Some(0.1524)], 3);
    assert!(is_ahead(&map, 0.19 + 0.1524), "full rings hear how near it is");
}

#[test]
fn the_map_moves_with_the_robot_and_forgets_what_is_far() {
    let (mut map, mut y) = heard(&[Some(0.8)], 3);
    y.pose.x = Meters(1.0);
    take(&mut map, &y);
    assert!(is_ahead(&map, 0.99));
    for x in [9.0, 0.0] {
        y.pose.x = Meters(x);
        take(&mut map, &y);
    }
    assert!(!is_ahead(&map, 0.99));
    assert_eq!(map.around(y.pose, Meters(1.2)).count(), 0);
}

/// Returns the cell at the right end of the arc of the front sonar's echo with this range.
fn right_end(range: f64) -> Cell {
    Cell::of(0.19 + range * 0.987, -range * 0.156)
}

/// Returns a map that has been updated with pings of the front sonar, 1 s apart, each given by the robot's heading, in
/// degrees, and by its range.
fn heard_in_turn(halves: [f64; 2], pings: &[(f64, f64)]) -> Map {
    let (mut y, mut map) = (Sensed { confirmation: 2, halves, ..Sensed::default() }, Map::EMPTY);
    for (second, (degrees, range)) in (1..).zip(pings) {
        (y.now, y.pose.theta) = (Nanos(1_000_000_000 * second), Radians::from_degrees(*degrees));
        y.ping_at(AHEAD, Some(*range), y.now);
        take(&mut map, &y);
    }
    map
}

/// Returns `true` if the cell at the right end of an echo's arc is occupied after the echo, which has this range, and
/// more pings.
fn is_end_occupied(halves: [f64; 2], range: f64, pings: &[(f64, f64)]) -> bool {
    let map = heard_in_turn(halves, &[&[(0.0, range)], pings].concat());
    assert!(is_ahead(&map, 0.19 + range));
    map.is_occupied(right_end(range))
}

const SCOUT: [f64; 2] = [0.205; 2];
const ATRV: [f64; 2] = [0.315, 0.27];

#[test]
fn an_echo_of_a_scout_does_not_restore_cells_that_a_ping_passed() {
    let pings = [(-16.0, 1.4), (0.0, 0.4)];
    assert!(!is_end_occupied(SCOUT, 0.4, &pings) && is_end_occupied(ATRV, 0.4, &pings));
}

#[test]
fn a_ping_of_a_scout_passes_near_cells_only_at_the_edge_of_its_cone() {
    let is_kept = |halves, range| is_end_occupied(halves, range, &[(-16.0, 1.4)]);
    assert!(!is_kept(SCOUT, 0.4) && is_kept(SCOUT, 0.8) && !is_kept(ATRV, 0.8));
}

/// Otherwise the echo of a jamb would close the doorway, which pings have passed.
#[test]
fn an_echo_comes_from_cells_that_at_most_one_ping_passed() {
    let is_occupied = |passes: usize| {
        let pings = [(-16.0, 1.4), (-16.0, 1.4), (0.0, 0.4)];
        let map = heard_in_turn(SCOUT, pings.get(2 - passes..).expect("two pings that pass"));
        assert!(is_ahead(&map, 0.59));
        map.is_occupied(right_end(0.4))
    };
    assert_eq!([0, 1, 2].map(is_occupied), [true, true, false]);
    let everywhere = [-16.0, -12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0, 16.0].map(|degrees| (degrees, 1.4));
    let map = heard_in_turn(SCOUT, &[everywhere.as_slice(), &[(0.0, 0.4)]].concat());
    assert!(is_ahead(&map, 0.59), "if pings have passed the whole arc, it comes from all of it");
}
