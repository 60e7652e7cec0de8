//! Tests the echoes that ideal sonars and a Scout's sonars hear.

use mdle_runtime::SonarId;

use super::*;
use crate::model::{Body, Model, ModelPart};
use crate::world::World;

/// Duration of a turn.
const PERIOD: Nanos = Nanos(100_000_000);

fn walls(text: &str) -> Walls {
    Walls::of(&World::parse("walls", text).expect("good walls"))
}

/// Returns a ring without errors that has pinged at the origin, once or in its firing order.
fn pinged(body: Body, without: &[ModelPart], text: &str) -> Ring {
    let mut ring = Ring::new(Model::of(body, without).hearing, None, PERIOD);
    let walls = walls(text);
    match ring.due() {
        Some(_) => ring.warm_up(&Pose::ORIGIN, Pose::ORIGIN, &walls),
        None => ring.ping(&Pose::ORIGIN, Pose::ORIGIN, Nanos::ZERO, &walls),
    }
    ring
}

fn range(ring: &Ring, sonar: u8) -> Option<f64> {
    ring.pings()[SonarId::new(sonar).number()].nearest(1).map(|range| range.0)
}

/// Returns the range of an ideal sonar that points ahead; `None` without an echo.
fn ahead(text: &str) -> Option<f64> {
    range(&pinged(Body::Ideal, &[], text), 0)
}

/// Returns the text of a wall at this distance along the first axis, turned by this many degrees around its point on
/// the axis.
fn turned(distance: f64, degrees: f64) -> String {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let (x, y) = (9.0 * sin, 9.0 * cos);
    format!("[[wall]]\npoints = [[{}, {y}], [{}, {}]]", distance - x, distance + x, -y)
}

#[test]
fn a_range_begins_at_the_transducer() {
    let front = ahead("[[wall]]\npoints = [[2, -1], [2, 1]]").expect("a wall ahead");
    assert!((front - 1.81).abs() < 1e-12, "{front}");
}

#[test]
fn sonars_count_counter_clockwise_from_the_front() {
    let ring = pinged(Body::Ideal, &[], "[[wall]]\npoints = [[-1, 2], [1, 2]]");
    let heard: Vec<u8> = (0..16).filter(|sonar| range(&ring, *sonar).is_some()).collect();
    assert_eq!(heard, [3, 4, 5]);
}

#[test]
fn a_cone_sees_what_its_axis_does_not() {
    // A post 2 m away, at 11° and at 14° off the axis of the cone.
    let post = |degrees: f64| {
        let at = Pose::ORIGIN.towards(Radians(0.0), Meters(0.19)).towards(Radians::from_degrees(degrees), Meters(2.0));
        ahead(&format!("[[box]]\ncentre = [{}, {}]\nsize = [0.1, 0.1]", at.x.0, at.y.0))
    };
    assert!(post(11.0).is_some_and(|range| (1.9..2.0).contains(&range)));
    assert!(post(-11.0).is_some());
    assert_eq!(post(14.5), None);
}

#[test]
fn nothing_within_range_is_no_echo() {
    assert_eq!(ahead("[[wall]]\npoints = [[6.68, -9], [6.68, 9]]"), None);
    assert!(ahead("[[wall]]\npoints = [[6.66, -9], [6.66, 9]]").is_some());
}

#[test]
fn a_seed_makes_the_noise_that_it_says_it_does() {
    let hearing = Model::of(Body::Ideal, &[]).hearing;
    let mut ring = Ring::new(hearing.clone(), Some(5), PERIOD);
    let (mut errors, mut missed) = (Vec::new(), 0);
    for _ in 0..20_000 {
        match ring.errors.as_mut().expect("seeded").of(Some(1.81), &hearing) {
            Some(range) => errors.push(range - 1.81),
            None => missed += 1,
        }
    }
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let spread = libm::sqrt(errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / count);
    assert!(mean.abs() < 5e-4, "{mean}");
    assert!((spread - hearing.spread).abs() < 5e-4, "{spread}");
    assert!((150..250).contains(&missed), "{missed}");
}

/// Returns the maximum angle off its normal, in degrees, at which a wall `distance` metres ahead is heard.
fn last_heard(distance: f64, without: &[ModelPart]) -> u32 {
    (0..80)
        .take_while(|degrees| range(&pinged(Body::Scout, without, &turned(distance, f64::from(*degrees))), 0).is_some())
        .count() as u32
        - 1
}

#[test]
fn a_flat_wall_answers_up_to_forty_degrees_or_so() {
    assert!((39..=42).contains(&last_heard(1.0, &[])), "{}", last_heard(1.0, &[]));
    assert!((24..=30).contains(&last_heard(6.0, &[])), "{}", last_heard(6.0, &[]));
    assert!(last_heard(1.0, &[ModelPart::Specular]) > 70);
    // Both the outermost ray of the cone and the limit on the normal's angle count.
    assert!((45..=49).contains(&last_heard(1.0, &[ModelPart::Lobe])), "{}", last_heard(1.0, &[ModelPart::Lobe]));
}

/// Returns the maximum angle off its normal, in degrees, at which a wall with this roughness 1 m ahead is heard.
fn last_heard_rough(rough: f64) -> u32 {
    let heard = |degrees: &u32| {
        let wall = turned(1.0, f64::from(*degrees));
        range(&pinged(Body::Scout, &[], &format!("rough = {rough}\n{wall}")), 0).is_some()
    };
    (0..80).take_while(heard).count() as u32 - 1
}

#[test]
fn rough_walls_are_heard_at_wider_angles() {
    let angles = [0.0, 0.25, 0.5, 1.0].map(last_heard_rough);
    assert_eq!(angles[0], last_heard(1.0, &[]));
    assert!(angles.is_sorted_by(|less, more| less + 3 <= *more), "{angles:?}");
    assert!(angles[3] > 70);
}

#[test]
fn every_kind_of_obstacle_may_have_its_own_roughness() {
    let corners = "[[2, -9], [2, 9]]";
    let obstacles = [
        format!("[[wall]]\npoints = {corners}"),
        format!("[[door]]\npoints = {corners}\nopen = []"),
        "[[box]]\nmin = [2, 0.3]\nmax = [3, 9]".to_owned(),
        "[[box]]\nsize = [1, 8.7]\nschedule = [[0, 2.5, 4.65]]".to_owned(),
        "[[disc]]\ncentre = [6, 0]\nradius = 5".to_owned(),
    ];
    for obstacle in obstacles {
        let heard = |world: &str, own: &str| {
            let ring = pinged(Body::Scout, &[], &format!("{world}\n{obstacle}\n{own}"));
            (0..16).filter(|sonar| range(&ring, *sonar).is_some()).count()
        };
        let (smooth, rough) = (heard("", ""), heard("rough = 1", ""));
        assert!(smooth < rough, "{obstacle}: {smooth} {rough}");
        assert_eq!(heard("", "rough = 1"), rough, "{obstacle}");
        assert_eq!(heard("rough = 1", "rough = 0"), smooth, "{obstacle}");
        assert_eq!(heard("", "[[wall]]\nrough = 1\npoints = [[-30, -9], [-30, 9]]"), smooth, "{obstacle}");
    }
}

#[test]
fn a_wall_end_is_heard_only_near_the_axis() {
    // The end of a wall that lies along the ray, so that its face is not heard.
    let end = |degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let (x, y) = (0.19 + cos, sin);
        range(
            &pinged(
                Body::Scout,
                &[],
                &format!("[[box]]\nmin = [{x}, {}]\nmax = [{}, {}]", y - 0.03, x + 3.0, y + 0.03),
            ),
            0,
        )
    };
    assert!(end(0.0).is_some_and(|range| (0.9..1.05).contains(&range)), "{:?}", end(0.0));
    assert_eq!(end(24.0), None);
}

/// Returns the text of a wall whose one end is `distance` metres from a Scout's front transducer and `degrees` off its
/// axis. The wall is turned by `turned` degrees against the ray to this end.
fn wall_from(distance: f64, degrees: f64, turned: f64) -> String {
    let at = |far: f64, degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        [far * cos, far * sin]
    };
    let ([x, y], [along, across]) = (at(distance, degrees), at(3.0, degrees + turned));
    format!("[[wall]]\npoints = [[{}, {y}], [{}, {}]]\n", 0.19 + x, 0.19 + x + along, y + across)
}

/// Returns the range of a Scout's front sonar among these obstacles.
fn scout_ahead(obstacles: &[String]) -> Option<f64> {
    range(&pinged(Body::Scout, &[], &obstacles.concat()), 0)
}

/// Walls have no thickness, so the end of a wall along which a sonar looks is between two rays.
#[test]
fn the_end_of_a_wall_is_heard_by_a_sonar_that_looks_along_the_wall() {
    for degrees in [-12.0, -3.0, 0.0, 3.0, 12.0] {
        let heard = scout_ahead(&[wall_from(1.0, degrees, 8.0)]);
        assert!(heard.is_some_and(|range| (0.97..1.0).contains(&range)), "{degrees}: {heard:?}");
    }
    assert_eq!(scout_ahead(&[wall_from(1.0, 14.0, 8.0)]), None, "off the axis");
    assert!(scout_ahead(&[wall_from(4.6, 0.0, 8.0)]).is_some());
    assert_eq!(scout_ahead(&[wall_from(4.8, 0.0, 8.0)]), None, "too far away");
    assert_eq!(scout_ahead(&[wall_from(1.0, 0.0, 8.0), turned(0.6, 60.0)]), None, "behind a wall that reflects away");
}

/// The rays of an ideal sonar pass these walls on both sides.
#[test]
fn an_ideal_sonar_hears_the_end_of_a_wall_in_all_of_its_cone() {
    for (degrees, far) in [(-12.0, 1.0), (-3.0, 0.1), (2.0, 6.2), (2.0, 0.02), (3.0, 2.0), (12.0, 1.0)] {
        let heard = ahead(&wall_from(far, degrees, 0.4));
        assert!(heard.is_some_and(|range| (range - far).abs() < 1e-9), "{degrees}, {far}: {heard:?}");
    }
    assert_eq!(ahead(&wall_from(1.0, 13.0, 0.4)), None, "outside the cone");
}

/// These walls are slanted too much to be heard, and their ends are between two rays.
#[test]
fn no_additional_ray_is_aimed_at_an_end_that_is_seen_from_the_side_or_that_touches_a_wall() {
    let along = wall_from(2.0, 3.5, 8.0);
    assert!(scout_ahead(std::slice::from_ref(&along)).is_some());
    assert_eq!(scout_ahead(&[wall_from(2.0, 3.5, 45.0)]), None);
    assert_eq!(scout_ahead(&[along, wall_from(2.0, 3.5, -40.0)]), None);
}

#[test]
fn a_corner_is_heard_where_its_walls_are_not() {
    // A right-angled corner whose walls both lie 45° off the axis.
    let corner = "[[wall]]\npoints = [[0, -2], [2, 0], [0, 2]]";
    let heard = range(&pinged(Body::Scout, &[], corner), 0).expect("a corner ahead");
    assert!((heard - 1.81).abs() < 0.06, "{heard}");
    let wall = "[[wall]]\npoints = [[0, -2], [4, 2]]";
    assert_eq!(range(&pinged(Body::Scout, &[], wall), 0), None);
}

#[test]
fn ranges_come_in_whole_inches_from_six_on() {
    let wall = |x: f64| range(&pinged(Body::Scout, &[], &format!("[[wall]]\npoints = [[{x}, -1], [{x}, 1]]")), 0);
    assert_eq!(wall(0.19 + 0.0254 * 40.5), Some(40.0 * 0.0254));
    assert_eq!(wall(0.22), Some(6.0 * 0.0254));
    let exact =
        pinged(Body::Scout, &[ModelPart::Steps, ModelPart::Minimum], "[[wall]]\npoints = [[0.22, -1], [0.22, 1]]");
    assert!((range(&exact, 0).expect("a wall") - 0.03).abs() < 1e-9);
}

#[test]
fn a_scout_pings_in_its_order_sixty_milliseconds_apart() {
    let mut ring = Ring::new(Model::of(Body::Scout, &[]).hearing, None, PERIOD);
    let walls = walls("[[wall]]\npoints = [[-1, 2], [1, 2]]");
    let mut pinged = Vec::new();
    for ping in 0..17 {
        let at = ring.due().expect("an order");
        assert_eq!(at, Nanos(ping * 60_000_000));
        ring.ping(&Pose::ORIGIN, Pose::ORIGIN, at, &walls);
        let newest = |pings: &Pings| pings.newest_first().next().map(|ping| ping.at);
        pinged.extend((0..16).filter(|sonar| newest(&ring.pings()[*sonar]) == Some(at)));
    }
    assert_eq!(pinged, [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8, 0]);
}

#[test]
fn sonars_ping_in_the_order_that_is_asked_for() {
    let mut ring = pinged(Body::Scout, &[], "[[wall]]\npoints = [[-1, 2], [1, 2]]");
    assert_eq!(ring.order().map(|order| order.len()), Some(16));
    ring.reorder(&[4, 0]);
    assert_eq!(ring.order(), Some(vec![4, 0]));
    let before = ring.pings();
    for _ in 0..4 {
        let at = ring.due().expect("an order");
        ring.ping(&Pose::ORIGIN, Pose::ORIGIN, at, &walls("[[wall]]\npoints = [[-1, 3], [1, 3]]"));
    }
    let changed: Vec<_> = (0..16).filter(|sonar| ring.pings()[*sonar] != before[*sonar]).collect();
    assert_eq!(changed, [0, 4]);
    for body in [Body::Ideal, Body::Atrv] {
        assert_eq!(pinged(body, &[], "[[wall]]\npoints = [[-1, 2], [1, 2]]").order(), None);
    }
}

#[test]
fn an_atrv_has_all_sixteen_directions_from_its_twenty_four() {
    let around = "[[box]]\nmin = [-1.5, -1.5]\nmax = [1.5, 1.5]";
    let ring = pinged(Body::Atrv, &[ModelPart::Specular], around);
    for sonar in 0..16 {
        let heard = range(&ring, sonar).expect("a wall on every side") + 0.28;
        assert!((1.4..2.2).contains(&heard), "sonar {sonar}: {heard}");
    }
    let front = range(&ring, 0).expect("a wall ahead") + 0.28;
    assert!((front - 1.5).abs() < 0.02, "{front}");
}

#[test]
fn a_ping_lies_on_the_axis_of_its_transducer() {
    let around = "[[box]]\nmin = [-1.5, -1.2]\nmax = [1.5, 1.2]";
    let ring = pinged(Body::Atrv, &[], around);
    let mut heard = 0;
    for (number, pings) in (0..).zip(&ring.pings()) {
        let ping = pings.newest_first().next().expect("a ping");
        let Some(Meters(range)) = ping.range else { continue };
        let axis = ping.axis(SonarId::new(number));
        let place = Point::of(&axis.towards(axis.theta, Meters(0.28 + range)));
        let is_there = |(transducer, heard): (&Transducer, &Heard)| {
            let (sin, cos) = libm::sincos(transducer.bearing.0);
            let Some(Meters(range)) = heard.range.filter(|_| transducer.sonar.number() == number.into()) else {
                return false;
            };
            libm::hypot(transducer.x + range * cos - place.x, transducer.y + range * sin - place.y) < 1e-6
        };
        assert!(ring.hearing.transducers.iter().zip(&ring.heard).any(is_there), "sonar {number}: {place:?}");
        heard += 1;
    }
    assert!(heard > 6, "{heard} directions");
}
