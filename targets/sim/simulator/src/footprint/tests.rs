//! Tests distances, contacts and rays of discs and rectangles.

use mdle_runtime::Meters;

use super::*;

const HERE: Point = Point { x: 0.0, y: 0.0 };
const DISC: Footprint = Footprint { pose: pose(2.0, 0.0), form: Form::Disc { radius: 0.5 } };
/// Rectangle that is 1 m long and 0.6 m wide.
const FORM: Form = Form::Rectangle { half_length: 0.5, half_width: 0.3 };

const fn pose(x: f64, y: f64) -> Pose {
    Pose { x: Meters(x), y: Meters(y), theta: Radians(0.0) }
}

fn rectangle(x: f64, degrees: f64) -> Footprint {
    Footprint { pose: Pose { theta: Radians::from_degrees(degrees), ..pose(x, 0.0) }, form: FORM }
}

fn place(x: f64, y: f64) -> Point {
    Point { x, y }
}

fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-12
}

#[test]
fn a_ray_meets_a_disc_and_nothing_behind_or_beside() {
    let range = |x: f64, y: f64, most: f64| DISC.found(HERE, place(x, y), most).map(|found| found.range);
    assert_eq!(range(1.0, 0.0, 10.0), Some(1.5));
    assert_eq!([range(1.0, 0.0, 1.5), range(-1.0, 0.0, 10.0), range(0.8, 0.6, 10.0)], [None; 3]);
    assert_eq!(DISC.found(HERE, place(1.0, 0.0), 10.0).map(|found| found.normal), Some(place(-1.0, 0.0)));
}

#[test]
fn a_ray_meets_the_side_of_a_rectangle_that_faces_it() {
    let found = |degrees: f64| rectangle(2.0, degrees).found(HERE, place(1.0, 0.0), 10.0).expect("a surface");
    assert!(is_near(found(0.0).range, 1.5) && is_near(found(90.0).range, 1.7), "{:?}", found(90.0));
    assert!(is_near(found(0.0).normal.x, -1.0) && is_near(found(0.0).edge, 0.3), "{:?}", found(0.0));
    assert!(rectangle(2.0, 0.0).found(HERE, place(0.8, 0.6), 10.0).is_none());
}

#[test]
fn two_bodies_overlap_or_touch_alike_from_both_sides() {
    for (x, overlaps) in [(1.0, false), (1.3, true), (2.0, true), (2.75, false)] {
        let other = Footprint { pose: pose(x, 0.0), form: Form::Disc { radius: 0.25 } };
        assert_eq!([DISC.overlaps(&other), other.overlaps(&DISC)], [overlaps; 2], "{x}");
    }
    for (x, degrees, gap) in [(0.9, 0.0, 0.1), (0.9, 90.0, 0.3), (3.0, 0.0, 0.0), (4.0, 90.0, 1.2)] {
        let other = rectangle(x, degrees);
        let gaps = [DISC.gap(&other), other.gap(&DISC)];
        assert!(gaps.iter().all(|found| is_near(*found, gap)), "{x} {degrees}: {gaps:?}");
    }
}

#[test]
fn two_rectangles_are_as_far_apart_as_their_sides() {
    let gap = |x: f64, degrees: f64| rectangle(0.0, 0.0).gap(&rectangle(x, degrees));
    assert!(is_near(gap(1.5, 0.0), 0.5) && is_near(gap(1.5, 90.0), 0.7));
    let corner = libm::hypot(0.5, 0.3);
    assert!(is_near(gap(3.0, libm::atan2(0.3, 0.5).to_degrees()), 2.5 - corner), "by a corner");
    for (x, degrees) in [(0.0, 0.0), (0.9, 0.0), (0.0, 45.0), (0.7, 90.0)] {
        assert!(gap(x, degrees) < 0.0, "{x} {degrees}");
    }
}

#[test]
fn a_rectangle_touches_a_wall_by_side_or_by_corner() {
    let wall = Segment::between(place(1.0, -2.0), place(1.0, 2.0));
    let contact = |degrees: f64| rectangle(0.0, degrees).contact(&wall);
    assert!(is_near(contact(0.0).gap, 0.5) && is_near(contact(90.0).gap, 0.7));
    let corner = contact(libm::atan2(-0.3, 0.5).to_degrees());
    assert!(is_near(corner.gap, 1.0 - libm::hypot(0.5, 0.3)) && is_near(corner.body.y, 0.0), "{corner:?}");
    let end = Segment::between(place(0.7, 0.1), place(3.0, 0.1));
    assert!(is_near(rectangle(0.0, 0.0).contact(&end).gap, 0.2));
    for (from, to) in [(place(0.1, 0.1), place(0.2, 0.1)), (place(-2.0, 0.0), place(2.0, 0.1)), (HERE, place(0.0, 9.0))]
    {
        assert!(rectangle(0.0, 30.0).contact(&Segment::between(from, to)).gap < 0.0, "{from} {to}");
    }
}

#[test]
fn the_distance_of_a_place_is_negative_inside() {
    let body = rectangle(0.0, 0.0);
    for (at, distance) in [(place(0.8, 0.7), 0.5), (place(0.0, 0.5), 0.2), (HERE, -0.3), (place(0.4, 0.0), -0.1)] {
        assert!(is_near(body.distance(at), distance), "{at}: {}", body.distance(at));
    }
}
