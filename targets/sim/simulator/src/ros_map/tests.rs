//! Tests maps as mapping robots save them, and invalid maps.

use mdle_runtime::{Meters, Radians};

use super::*;
use crate::footprint::Form;
use crate::start;
use crate::walls::Walls;

const HEADER: &str = "image: map.pgm\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\n\
                      occupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn header(text: &str) -> Header {
    Header::parse("map.yaml", text).expect("a good header")
}

/// Returns a map of this size in pixels: black where `stands` is true, grey in the first column, otherwise white.
fn map(width: usize, height: usize, stands: impl Fn(usize, usize) -> bool) -> Vec<u8> {
    let mut bytes = format!("P5\n# CREATOR: map_saver.cpp 0.050 m/pix\n{width} {height}\n255\n").into_bytes();
    let grey = |row, column| {
        if stands(column, row) {
            0
        } else if column == 0 {
            205
        } else {
            254
        }
    };
    bytes.extend(
        (0..height).flat_map(|row| (0..width).map(move |column| (row, column))).map(|(row, column)| grey(row, column)),
    );
    bytes
}

#[test]
fn what_is_black_stands_where_the_header_says() {
    // A closed room of 5 m by 4 m with a wall two pixels thick.
    let room = |column, row| !(2..98).contains(&column) || !(2..78).contains(&row);
    let world = header(HEADER).world("map.pgm", &map(100, 80, room)).expect("a good map");
    let corners: Vec<_> = world.outlines.iter().map(|outline| outline.points.len()).collect();
    assert_eq!(corners, [5, 5], "one line outside and one inside");
    let walls = Walls::of(&world);
    let ray = |degrees: f64| walls.ray(Point { x: 0.0, y: 0.0 }, Radians::from_degrees(degrees), 10.0).expect("a wall");
    let near = |one: f64, other: f64| (one - other).abs() < 1e-9;
    assert!(near(ray(0.0), 3.9) && near(ray(90.0), 1.9) && near(ray(180.0), 0.9) && near(ray(270.0), 1.9));
    let start = |x, y| {
        start::check(&Pose { x: Meters(x), y: Meters(y), ..Pose::ORIGIN }, Form::Disc { radius: 0.2 }, &world, &walls)
    };
    assert_eq!(start(0.0, 0.0), Ok(()));
    assert!(start(3.8, 0.0).is_err() && start(3.95, 0.0).is_err() && start(9.0, 0.0).is_err());
}

#[test]
fn the_inside_of_what_stands_is_no_start() {
    let block = |column: usize, row: usize| (20..60).contains(&column) && (20..60).contains(&row);
    let world = header(HEADER).world("map.pgm", &map(100, 80, block)).expect("a good map");
    let middle = Pose { x: Meters(1.0), y: Meters(0.0), ..Pose::ORIGIN };
    assert!(start::check(&middle, Form::Disc { radius: 0.2 }, &world, &Walls::of(&world)).is_err());
}

#[test]
fn a_slanted_wall_has_no_steps() {
    let slanted = |column: usize, row: usize| (row * 10).abs_diff(column * 3 + 100) < 20;
    let world = header(HEADER).world("map.pgm", &map(200, 200, slanted)).expect("a good map");
    let sides: usize = world.outlines.iter().map(|outline| outline.points.len() - 1).sum();
    assert!(sides <= 8, "{sides} sides");
}

#[test]
fn text_two_bytes_and_turned_maps_are_read() {
    let text = "P2 3 2 100\n0 100 100\n100 100 100\n";
    let world = header(HEADER).world("map.pgm", text.as_bytes()).expect("a good map");
    assert_eq!(world.outlines.len(), 1);
    let wide = [&b"P5 2 1 65535\n"[..], &[0x00, 0x10, 0xff, 0xff]].concat();
    assert_eq!(header(HEADER).world("map.pgm", &wide).expect("a good map").outlines.len(), 1);
    let turned = HEADER.replace("0.0]", "1.5707963267948966]");
    let world = header(&turned).world("map.pgm", text.as_bytes()).expect("a good map");
    let (x, y) =
        world.outlines[0].points.iter().fold((0.0_f64, 9.0_f64), |(x, y), point| (x.min(point.x), y.min(point.y)));
    assert!((x + 1.1).abs() < 1e-9 && (y + 2.0).abs() < 1e-9, "{x} {y}");
    let rows = "image: \"map.pgm\" # quoted\nresolution: 5e-2\norigin:\n- -1.0\n- -2.0\n- 0.0\n";
    assert_eq!(header(rows), Header { occupied: 0.65, ..header(HEADER) });
}

#[test]
fn faults_have_their_place() {
    let wrong = |text: &str| Header::parse("map.yaml", text).expect_err("a bad header").to_string();
    let image = |bytes: &[u8]| header(HEADER).world("map.pgm", bytes).expect_err("a bad image").to_string();
    let faults = [
        wrong("resolution: 0.05\n"),
        wrong("image: map.pgm\norigin: [0, 0, 0]\n"),
        wrong("image: map.pgm\nresolution: five\n"),
        wrong("image: map.pgm\nresolution: NaN\n"),
        wrong("image: map.pgm\nresolution: 0\n"),
        wrong("image: map.pgm\nresolution: 1\norigin: [0, x, 0]\n"),
        wrong("image: map.pgm\nresolution: 1\norigin: [0, 0]\n"),
        image(b""),
        image(b"\x89PNG\r\n"),
        image(b"P5 0 10 255\n"),
        image(b"P5 10 10 255\nabc"),
        image(b"P5 4000000000 4000000000 255\n"),
        image(b"P5 1 1 70000\n"),
        image(b"P2 2 1 9\n1 x\n"),
    ];
    insta::assert_snapshot!(faults.join("\n"), @r#"
    map.yaml: no `image`: expected as in `image: map.pgm`
    map.yaml: a map without scale: expected the metres of a pixel, as in `resolution: 0.05`
    map.yaml:2:13: "five" is no number
    map.yaml:2:13: "NaN" is no number
    map.yaml:2:13: a pixel of 0 m; expected 0.0001 to 100
    map.yaml:3:13: "x" is no number
    map.yaml:3:10: an origin is three numbers, as in `origin: [-10.0, -10.0, 0.0]`
    map.pgm: that is no portable grey map (PGM); `convert map.png map.pgm` makes one of another image
    map.pgm: that is no portable grey map (PGM); `convert map.png map.pgm` makes one of another image
    map.pgm: the image's width, height and white must be whole numbers above 0
    map.pgm: the image ends after 3 of its 100 pixels
    map.pgm: 4000000000 by 4000000000 pixels are too many; expected 100 million
    map.pgm: a white of 70000; expected at most 65535
    map.pgm: the image ends after 1 of its 2 pixels
    "#);
}

#[test]
fn a_long_comb_has_its_corners_and_no_more() {
    // One contour with three million sides: every tooth and every gap is one pixel wide.
    let (width, height) = (3000, 1000);
    let comb = |column: usize, row: usize| {
        row == 0
            || row + 1 == height
            || column + 1 == width
            || (column.is_multiple_of(2) && (row + 2 < height || column == 0))
    };
    let world = header(HEADER).world("map.pgm", &map(width, height, comb)).expect("a good map");
    let corners: usize = world.outlines.iter().map(|outline| outline.points.len()).sum();
    assert!((3000..6100).contains(&corners), "{corners} corners");
    assert!(Walls::of_any(&world).is_ok());
}

#[test]
fn a_map_of_too_many_sides_is_refused() {
    let fault = |pixels: usize| {
        let dots = map(2 * pixels, 2 * pixels, |column, row| column % 2 == 1 && row % 2 == 1);
        header(HEADER).world("map.pgm", &dots).expect_err("too many").to_string()
    };
    let message = "map.pgm: what stands has more than 4000000 sides of pixels; a map of walls has fewer";
    assert!(fault(1010).starts_with(message), "{}", fault(1010));
    let message = "map.pgm: 1280000 walls and sides are too many; expected at most 1000000";
    assert_eq!(fault(800), message);
}
