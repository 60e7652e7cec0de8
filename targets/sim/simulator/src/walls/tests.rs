//! Compares rays and distances with brute force, and tests moving objects.

#[cfg(parry)]
mod parry;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::*;
use crate::surfaces::SegmentEnd;
use mdle_runtime::{Meters, Pose};

fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns a world with walls scattered over 10 m × 10 m, some of which form boxes.
fn scene(random: &mut ChaCha8Rng, walls: usize) -> World {
    let mut number = || 10.0 * uniform(random);
    let mut text = String::new();
    for wall in 0..walls {
        let (x, y, across) = (number(), number(), number());
        text += &match wall % 3 {
            0 => format!("[[wall]]\npoints = [[{x}, {y}], [{x}, {across}], [{across}, {across}]]\n"),
            1 => format!("[[wall]]\npoints = [[{x}, {y}], [{}, {across}]]\n", number()),
            _ => format!("[[box]]\ncentre = [{x}, {y}]\nsize = [{}, 0.3]\n", 0.1 + across / 10.0),
        };
    }
    World::parse("scene", &text).expect("a good scene")
}

/// Returns a body of size zero.
fn point(at: Point) -> Footprint {
    let pose = Pose { x: Meters(at.x), y: Meters(at.y), ..Pose::ORIGIN };
    Footprint { pose, form: Form::Disc { radius: 0.0 } }
}

/// Returns a random position in or near a scene, and a random direction. Every third direction is along an axis, like
/// most walls.
fn look(random: &mut ChaCha8Rng) -> (Point, Radians) {
    let mut number = || uniform(random);
    let from = Point { x: 14.0 * number() - 2.0, y: 14.0 * number() - 2.0 };
    let turn = number();
    let turn = if turn < 0.33 { libm::floor(turn * 12.0) / 4.0 } else { turn };
    (from, Radians(turn * std::f64::consts::TAU))
}

#[test]
fn a_ray_meets_the_nearest_of_all_walls() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for count in [1, 2, 3, 10, 40, 200] {
        let world = scene(&mut random, count);
        let walls = Walls::of(&world);
        let every: Vec<_> = world.segments().map(|(_, from, to)| Segment::between(from, to)).collect();
        for _ in 0..500 {
            let (from, direction) = look(&mut random);
            let (sin, cos) = libm::sincos(direction.0);
            let way = Point { x: cos, y: sin };
            let expected = every.iter().filter_map(|segment| segment.met(from, way, 6.0)).reduce(f64::min);
            assert_eq!(walls.cast(from, way, 6.0), expected, "from {from} along {direction:?}");
        }
    }
}

#[test]
fn a_ray_meets_nothing_where_no_wall_is_in_reach() {
    let (mut random, mut far) = (ChaCha8Rng::seed_from_u64(6), 0);
    for count in [1, 3, 40] {
        let world = scene(&mut random, count);
        let walls = Walls::of(&world);
        for _ in 0..500 {
            let (from, direction) = look(&mut random);
            let reach = 3.0 * uniform(&mut random);
            let is_in_reach = walls.stand_in_reach(from, reach);
            assert!(is_in_reach || walls.ray(from, direction, reach).is_none(), "{reach} m from {from}");
            far += u32::from(!is_in_reach);
        }
    }
    assert!(far > 100, "{far} of 1500");
}

#[test]
fn a_ray_that_lies_in_borders_of_cells_meets_what_is_there() {
    // Walls on a raster that coincides with borders of cells, and rays between points of the raster.
    let mut text = String::new();
    for x in 0..20 {
        text += &format!("[[box]]\nmin = [{x}, {}]\nmax = [{}.5, {}.5]\n", x % 5, x, x % 5);
    }
    let world = World::parse("raster", &text).expect("good");
    let walls = Walls::of(&world);
    let every: Vec<_> = world.segments().map(|(_, from, to)| Segment::between(from, to)).collect();
    for from in (0..40).flat_map(|x| (0..12).map(move |y| Point { x: f64::from(x) / 2.0, y: f64::from(y) / 2.0 })) {
        for eighth in 0..8 {
            let (sin, cos) = libm::sincos(f64::from(eighth) * std::f64::consts::FRAC_PI_4);
            let way = Point { x: cos, y: sin };
            let expected = every.iter().filter_map(|segment| segment.met(from, way, 30.0)).reduce(f64::min);
            assert_eq!(walls.cast(from, way, 30.0), expected, "from {from}, eighth {eighth}");
        }
    }
}

#[test]
fn a_world_without_walls_is_endless() {
    let walls = Walls::of(&World::parse("empty", "").expect("an empty world"));
    assert_eq!(walls.ray(Point { x: 0.0, y: 0.0 }, Radians(0.3), 1e6), None);
    assert_eq!(walls.clearance(Point { x: 0.0, y: 0.0 }, 5.0), 5.0);
}

#[test]
fn the_nearest_wall_is_named() {
    let world = World::office().expect("our own floor");
    let name = |x, y| nearest(&world, &point(Point { x, y })).map(|outline| outline.name.as_str());
    assert_eq!(name(3.6, 4.6), Some("obstacle"));
    assert_eq!(name(-0.5, 2.0), Some("A west"));
}

#[test]
fn edges_are_where_a_surface_ends_or_turns_away() {
    // A box, and a wall that ends at the box's left side and turns at a corner.
    let text = "[[box]]\nmin = [2, -1]\nmax = [4, 1]\n[[wall]]\npoints = [[2, 0], [0, 0], [0, 3], [0, 6]]";
    let walls = Walls::of(&World::parse("edges", text).expect("good"));
    let edge = |x, y, degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        walls.found_among(walls.all(), Point { x, y }, Point { x: cos, y: sin }, 9.0).expect("a wall").edge
    };
    // A ray from below to the box: its corners are edges, since their sides turn away.
    assert!((edge(2.25, -3.0, 90.0) - 0.25).abs() < 1e-9);
    // A ray to the box's left side, near the end of the wall: they form a corner, not an edge, and the box's own edge
    // is 0.9 m away.
    assert!((edge(1.0, 0.1, 0.0) - 0.9).abs() < 1e-9);
    // Rays to the wall's corner, from inside and from outside.
    assert!((edge(1.0, 0.5, 180.0)).is_infinite() || edge(1.0, 0.5, 180.0) > 5.0);
    assert!((edge(-1.0, 0.5, 0.0) - 0.5).abs() < 1e-9);
    // A straight continuation of the wall is not an edge.
    assert!((edge(1.0, 3.1, 180.0) - 2.9).abs() < 1e-9);
}

/// Returns a world with parallel walls, 200 km long and a millimetre apart.
fn bundle(count: usize) -> World {
    let outline = |number: usize| {
        let x = 5.0 + number as f64 / 1000.0;
        let points = [-1e5, 1e5].map(|y| Point { x, y }).to_vec();
        Outline { name: format!("wall {number}"), points, solid: false, rough: 0.0 }
    };
    World { outlines: (0..count).map(outline).collect(), ..World::parse("empty", "").expect("a good world") }
}

#[test]
fn long_walls_side_by_side_are_ready_or_refused() {
    let walls = Walls::of_any(&bundle(1000)).expect("few enough");
    let ray = walls.ray(Point { x: 0.0, y: 0.0 }, Radians(0.0), 10.0);
    assert!(ray.is_some_and(|range| (range - 5.0).abs() < 1e-9), "{ray:?}");
    let fault = Walls::of_any(&bundle(8000)).expect_err("too many");
    assert!(fault.starts_with("8000 walls and sides lie too close together"), "{fault}");
}

#[test]
fn walls_that_meet_in_one_point_cover_each_other() {
    let spoke = |number: u32| {
        let (sin, cos) = libm::sincos(f64::from(number));
        let points = vec![Point { x: 5.0, y: 5.0 }, Point { x: 5.0 + 3.0 * cos, y: 5.0 + 3.0 * sin }];
        Outline { name: String::new(), points, solid: false, rough: 0.0 }
    };
    let world = World { outlines: (0..2000).map(spoke).collect(), ..World::parse("empty", "").expect("a good world") };
    let walls = Walls::of_any(&world).expect("few enough");
    assert!(walls.standing.ends.iter().all(|[middle, _]| *middle == SegmentEnd::Covered));
}

#[test]
fn a_cone_leaves_out_no_robot_that_its_rays_meet() {
    let mut noise = crate::noise::Noise::of(4, crate::noise::Purpose::Start);
    let mut within = |most: f64| most * (2.0 * noise.uniform() - 1.0);
    let mut walls = Walls::of(&World::parse("empty", "").expect("a good world"));
    let (mut met, mut left_out) = (0, 0);
    for number in 0..400 {
        let form = if number % 2 == 0 { Form::SCOUT } else { Form::Rectangle { half_length: 0.3, half_width: 0.2 } };
        let pose = Pose { x: Meters(within(3.0)), y: Meters(within(3.0)), theta: Radians(within(3.0)) };
        walls.put_others(&[Footprint { pose, form }]);
        let (axis, from) = (Radians(within(3.0)), Point { x: within(0.5), y: within(0.5) });
        let half_cone = Radians::from_degrees(21.0);
        let near = walls.others_in(from, axis, half_cone);
        let reached = Reached { others: &near, standing: true };
        let aimed = libm::atan2(pose.y.0 - from.y, pose.x.0 - from.x);
        let spread = (0..41).map(|ray| axis.0 + half_cone.0 * (f64::from(ray) / 20.0 - 1.0));
        let is_aimed = Radians(aimed - axis.0).wrapped().0.abs() < half_cone.0;
        for direction in spread.chain(is_aimed.then_some(aimed)) {
            let (sin, cos) = libm::sincos(direction);
            let way = Point { x: cos, y: sin };
            met += u32::from(walls.cast(from, way, 9.0).is_some());
            assert_eq!(walls.cast(from, way, 9.0), walls.cast_among(reached, from, way, 9.0), "{number}");
        }
        left_out += u32::from(near.is_empty());
    }
    assert!(met > 500 && left_out > 200, "{met}, {left_out}");
}

#[test]
fn a_ray_meets_the_nearest_of_robots_and_walls() {
    let text = "rough = 0.5\n[[wall]]\npoints = [[3, -9], [3, 9]]\nrough = 0.25\n";
    let mut walls = Walls::of(&World::parse("wall", text).expect("a good world"));
    let at = |x: f64| Footprint { pose: Pose { x: Meters(x), ..Pose::ORIGIN }, form: Form::SCOUT };
    let met = |walls: &Walls| {
        let (from, way) = (Point { x: 0.0, y: 0.0 }, Point { x: 1.0, y: 0.0 });
        let surface = walls.found_among(walls.all(), from, way, 9.0).expect("a surface");
        assert_eq!(walls.cast(from, way, 9.0), Some(surface.range));
        (libm::round(surface.range * 1000.0), surface.rough)
    };
    for (others, expected) in [
        (vec![], (3000.0, 0.25)),
        (vec![at(4.0)], (3000.0, 0.25)),
        (vec![at(2.5), at(1.5), at(2.0)], (1295.0, 0.5)),
        (vec![at(-1.5), at(4.0), at(2.0)], (1795.0, 0.5)),
    ] {
        walls.put_others(&others);
        assert_eq!(met(&walls), expected, "{others:?}");
    }
}
