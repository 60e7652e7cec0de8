//! Tests that pictures of various runs are well-formed, complete, reproducible and small.

use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS};
use svg::parser::Event;

use super::{animated, svg};
use crate::footprint::{Footprint, Form};
use crate::frames::{FilmFrame, Frames};
use crate::point::Point;
use crate::trail::Trail;
use crate::world::World;

/// Returns the trail of a run of this many turns in circles, in which an atom begins every `an_atom_every` turns.
fn run(turns: u64, an_atom_every: u64, law: &str) -> Trail {
    let mut trail = Trail::from(&Footprint { pose: Pose::ORIGIN, form: Form::SCOUT });
    trail.frames = Some(Frames::new());
    for turn in 0..turns {
        let (t, angle) = (Nanos(turn * 100_000_000), turn as f64 * 0.05);
        let (x, y) = (Meters(2.0 * libm::sin(angle)), Meters(2.0 - 2.0 * libm::cos(angle)));
        trail.went(&Pose { x, y, theta: Radians(angle).wrapped() });
        let echo = Point { x: x.0 * 1.5, y: y.0 * 1.5 };
        let mut echoes = [None; SONARS];
        echoes[0] = Some(echo);
        trail.echoes.push(echo);
        let frame = FilmFrame { t, pose: trail.here, echoes, things: Vec::new() };
        trail.frames.as_mut().unwrap().push(frame);
        if turn % an_atom_every == 0 {
            trail.began(turn / an_atom_every + 1, law, t);
        }
        if turn % 700 == 500 {
            trail.contacts.push((Point::of(&trail.here), t));
        }
    }
    trail
}

/// Returns the tags and the text of a picture, after checking that its elements are properly nested.
fn read(picture: &str) -> (Vec<String>, String) {
    let (mut open, mut tags, mut text) = (Vec::new(), Vec::new(), String::new());
    for event in svg::read(picture).unwrap() {
        match event {
            Event::Tag(name, kind, attributes) => {
                match kind {
                    svg::node::element::tag::Type::Start => open.push(name.to_owned()),
                    svg::node::element::tag::Type::End => assert_eq!(open.pop().as_deref(), Some(name)),
                    svg::node::element::tag::Type::Empty => {}
                }
                for (key, value) in attributes.iter() {
                    assert!(
                        !value.contains("NaN") && !value.contains("inf") || &**value == "indefinite",
                        "{key}={value:?}"
                    );
                }
                tags.push(name.to_owned());
            }
            Event::Text(words) => text += words,
            Event::Error(error) => panic!("{error}"),
            Event::Comment(_) | Event::Declaration(_) | Event::Instruction(_) => {}
        }
    }
    assert_eq!(open, [""; 0]);
    (tags, text)
}

#[test]
fn pictures_of_every_run_are_well_formed_and_say_what_ran() {
    let office = World::office().unwrap();
    let empty = World::parse("empty", "").unwrap();
    for (world, turns, every) in
        [(&office, 1400, 100), (&office, 1, 1), (&empty, 0, 1), (&empty, 30, 1), (&office, 90_000, 1)]
    {
        let trail = run(turns, every, "goAvoid 90 40 20 \"<&>\"");
        let (plot, record) = (svg(world, &trail), animated(world, &trail));
        for picture in [&plot, &record] {
            let (tags, text) = read(picture);
            assert_eq!(tags.first().map(String::as_str), Some("svg"));
            assert_eq!(text.contains("goAvoid 90 40 20 \"&lt;&amp;&gt;\""), turns > 0);
        }
        assert_eq!((plot, record), (svg(world, &trail), animated(world, &trail)));
    }
}

/// Returns the trail of a plan that repeats three atoms `passes` times; each atom runs for ten turns.
fn passes(passes: u64) -> Trail {
    let mut trail = run(0, 1, "");
    for turn in 0..30 * passes {
        trail.went(&Pose { x: Meters(turn as f64 * 0.02), ..Pose::ORIGIN });
        let t = Nanos(turn * 100_000_000);
        let frame = FilmFrame { t, pose: trail.here, echoes: [None; SONARS], things: Vec::new() };
        trail.frames.as_mut().unwrap().push(frame);
        trail.ways.passed(t);
        if turn % 10 == 0 {
            let law = ["go 20 0", "turn 90", "stop"][(turn / 10 % 3) as usize];
            trail.began(turn / 10 % 3 + 4, law, t);
        }
    }
    let t = Nanos(30 * passes * 100_000_000);
    trail.ended("Rounds", true, "completed (atom 6)", t);
    trail
}

#[test]
fn each_atom_of_a_loop_is_drawn_listed_and_called_out_once() {
    let picture = svg(&World::parse("empty", "").unwrap(), &passes(50));
    for number in 0..3 {
        let class = format!("way{number}");
        assert_eq!(values(&picture, "path", "class").iter().filter(|value| **value == class).count(), 1, "{class}");
        let class = format!("on{number}");
        assert_eq!(values(&picture, "text", "class").iter().filter(|value| **value == class).count(), 2, "{class}");
    }
    let (_, text) = read(&picture);
    assert_eq!(text.matches("50 ×").count(), 3);
    assert_eq!(text.matches("50.0 s").count() - text.matches("150.0 s").count(), 3, "{text}");
    assert!(text.contains("Rounds") && text.contains("over after 150.0 s: completed (atom 6)"), "{text}");
}

#[test]
fn a_record_shows_every_pass_in_the_colour_of_its_atom() {
    // With 200 passes, most atoms begin and end between two frames.
    let picture = animated(&World::parse("empty", "").unwrap(), &passes(200));
    for number in 0..3 {
        let class = format!("way{number}");
        // One path in the timeline, and one for each pass.
        let ways = values(&picture, "path", "class").into_iter().filter(|value| *value == class).count();
        assert_eq!(ways, 201, "{class}");
    }
}

#[test]
fn the_script_of_a_record_finds_what_it_asks_for() {
    let script = include_str!("film.js");
    assert!(!script.contains(['<', '>', '&']), "XML would escape it");
    let picture = animated(&World::office().unwrap(), &run(1400, 100, "stop"));
    let classes: Vec<String> =
        ["g", "path", "tspan"].into_iter().flat_map(|tag| values(&picture, tag, "class")).collect();
    let asked = script.split("find('").skip(1).filter_map(|rest| rest.split('\'').next());
    let asked: Vec<&str> = asked.collect();
    assert_eq!(asked.len(), 5);
    for class in asked {
        let found = classes.iter().filter(|classes| classes.split(' ').any(|one| one == class)).count();
        assert_eq!(found, 1, "{class}");
    }
    for name in script.split("number('").skip(1).filter_map(|rest| rest.split('\'').next()) {
        let number = values(&picture, "g", &format!("data-{name}"));
        assert!(matches!(&number[..], [number] if number.parse::<f64>().is_ok()), "{name}: {number:?}");
    }
    // Without scripts, the button is hidden, and the text shows the duration of the run.
    assert!(picture.contains("class=\"button\" cursor=\"pointer\" visibility=\"hidden\""));
    assert!(read(&picture).1.contains("139.9 s, shown 10 times as fast"));
}

#[test]
fn a_record_is_small_however_long_the_run() {
    let office = World::office().unwrap();
    for (turns, every) in [(1400, 100), (100_000, 1), (100_000, 50_000)] {
        let size = animated(&office, &run(turns, every, "goAvoid 90 40 20")).len();
        assert!(size < 1_000_000, "{turns} turns, an atom every {every}: {size} bytes");
    }
}

/// Returns the values of an attribute of all elements with this name.
fn values(picture: &str, tag: &str, attribute: &str) -> Vec<String> {
    let elements = svg::read(picture).unwrap().filter_map(|event| {
        let Event::Tag(name, _, attributes) = event else { return None };
        (name == tag).then(|| attributes.get(attribute).map(|value| value.to_string()))?
    });
    elements.collect()
}

#[test]
fn all_animations_repeat_together_and_their_times_are_in_order() {
    let picture = animated(&World::office().unwrap(), &run(1400, 100, "stop"));
    for tag in ["animate", "animateTransform"] {
        let (times, listed) = (values(&picture, tag, "keyTimes"), values(&picture, tag, "values"));
        assert!(!times.is_empty());
        assert!(values(&picture, tag, "dur").iter().all(|dur| dur == "16.49s"));
        for (times, listed) in times.iter().zip(&listed) {
            let times: Vec<f64> = times.split(';').map(|time| time.parse().unwrap()).collect();
            assert!(times.is_sorted() && times[0] == 0.0 && times[times.len() - 1] <= 1.0, "{times:?}");
            assert_eq!(times.len(), listed.split(';').count());
        }
    }
}

/// World with a door that opens, a walker who has moved 2 m at the end, and a walker who never moves.
const THINGS: &str = "[[door]]\npoints = [[0, 1], [1, 1]]\nopen = [[1, 2]]\n\
                      [[disc]]\nradius = 0.25\nschedule = [[0, 2, 0], [4, 4, 0]]\n\
                      [[box]]\nsize = [0.5, 0.5]\nschedule = [[0, -7, -3]]\n";

#[test]
fn what_moves_is_drawn_where_it_is_and_moves_in_a_record() {
    let world = World::parse("things", THINGS).unwrap();
    let mut trail = run(41, 10, "stop");
    trail.frames = Some(Frames::new());
    for turn in 0..41_u64 {
        let gone = Point { x: turn as f64 * 0.05, y: 0.0 };
        let door = (!(10..20).contains(&turn)).then_some(Point { x: 0.0, y: 0.0 });
        // The order of moving objects: boxes and discs first, doors last.
        trail.things = vec![Some(Point { x: 0.0, y: 0.0 }), Some(gone), door];
        let things = trail.things.clone();
        let frame = FilmFrame { t: Nanos(turn * 100_000_000), pose: trail.here, echoes: [None; SONARS], things };
        trail.frames.as_mut().unwrap().push(frame);
    }
    let (plot, record) = (svg(&world, &trail), animated(&world, &trail));
    for picture in [&plot, &record] {
        let (_, text) = read(picture);
        assert!(text.contains("door") && text.contains("moves"), "{text}");
    }
    // Hidden from 1 s to 2 s; the film lasts 4 s, plus a pause of 2.5 s.
    let doors = values(&record, "animate", "values").into_iter().zip(values(&record, "animate", "keyTimes"));
    let door = doors.filter(|(values, _)| values == "visible;hidden;visible").map(|(_, times)| times);
    assert_eq!(door.collect::<Vec<_>>(), ["0;0.15385;0.30769"]);
    let ways = values(&record, "animateTransform", "values");
    let still = ways.iter().filter(|way| way.split(';').all(|at| at == "0 0")).count();
    assert_eq!(still, 1, "{ways:?}");
    let scale = super::layout::Layout::of(&world, &trail).scale;
    let end = format!("{} 0", super::shapes::tenths(2.0 * scale));
    assert!(ways.iter().any(|way| way.starts_with("0 0;") && way.ends_with(&end)), "{ways:?}");
}
