//! Draws the sonar model: the fraction of pings that hear a wall or a column, by angle, and the errors of the ranges.

use svg::Document;
use svg::node::element::{Group, Line, Path, Rectangle, Text, Title};

use crate::heard::{COLUMN, WALL, heard};
use crate::{MANY, PINGS};

const INK: &str = "#262b33";
const GRID: &str = "#dfe3e9";
const CURVES: [(&str, &str, &str, f64); 3] = [
    ("wall at 1 m", "#0072b2", WALL, 1.0),
    ("wall at 5 m", "#56b4e9", WALL, 5.0),
    ("column at 1 m", "#c44e00", COLUMN, 1.0),
];
/// Size and position of a chart, in pixels.
const WIDTH: f64 = 360.0;
const HEIGHT: f64 = 220.0;
const TOP: f64 = 40.0;
const LEFT: [f64; 2] = [60.0, 500.0];
/// Width of the first chart, in degrees.
const DEGREES: f64 = 60.0;
const EACH: usize = 3;
/// Maximum error in the second chart, in centimetres to either side, with a bar for each centimetre.
const CENTIMETRES: i32 = 8;

pub(crate) fn svg() -> String {
    let document = Document::new().set("viewBox", (0, 0, 900, 340)).set("width", 900).set("height", 340);
    let document = document.set("font-family", "sans-serif").set("font-size", 13).set("fill", INK);
    let document = document.add(Title::new("How often a simulated Scout's sonar hears something, and how far off"));
    let ground = Rectangle::new().set("width", 900).set("height", 340).set("fill", "#ffffff");
    format!("{}\n", document.add(ground).add(shares()).add(errors()))
}

/// Draws the fraction of pings that are heard against the angle between the axis and the surface's normal.
fn shares() -> Group {
    let at = |degrees: f64, share: f64| (LEFT[0] + degrees / DEGREES * WIDTH, TOP + HEIGHT * (1.0 - share));
    let mut group = frame(LEFT[0], "pings heard, %", "angle off the normal, degrees");
    for share in [0.0, 0.5, 1.0] {
        let (x, y) = at(0.0, share);
        group = group.add(rule(y, LEFT[0])).add(label(&format!("{}", share * 100.0), (x - 8.0, y), "end"));
    }
    for degrees in [0.0, 15.0, 30.0, 45.0, 60.0] {
        group = group.add(label(&degrees.to_string(), (at(degrees, 0.0).0, TOP + HEIGHT + 14.0), "middle"));
    }
    for (number, (name, colour, what, distance)) in CURVES.iter().enumerate() {
        let points = (0..=DEGREES as usize).step_by(EACH).map(|degrees| {
            let (x, y) = at(degrees as f64, heard(what, *distance, degrees as f64, PINGS).share());
            format!("{x:.1},{y:.1}")
        });
        let data = format!("M{}", points.collect::<Vec<_>>().join("L"));
        let path = Path::new().set("d", data).set("fill", "none").set("stroke", *colour).set("stroke-width", 2.5);
        let y = TOP + 20.0 + 18.0 * number as f64;
        group = group.add(path).add(label(name, (LEFT[0] + WIDTH - 8.0, y), "end").set("fill", *colour));
    }
    group
}

/// Draws a histogram of the range errors for a wall that faces the sonar.
fn errors() -> Group {
    let heard = heard(WALL, 1.0, 0.0, MANY);
    let bars = 2 * CENTIMETRES;
    let wide = WIDTH / f64::from(bars);
    let mut group = frame(LEFT[1], "pings, %", "range too long by, cm");
    for percent in [0.0, 40.0, 80.0] {
        let y = TOP + HEIGHT * (1.0 - percent / 80.0);
        group = group.add(rule(y, LEFT[1])).add(label(&percent.to_string(), (LEFT[1] - 8.0, y), "end"));
    }
    for bar in 0..bars {
        let from = f64::from(bar - CENTIMETRES) / 100.0;
        let count = heard.errors.iter().filter(|error| (from..from + 0.01).contains(*error)).count();
        let tall = HEIGHT * (count as f64 / MANY as f64) / 0.8;
        let x = LEFT[1] + f64::from(bar) * wide;
        let rectangle = Rectangle::new().set("x", format!("{:.1}", x + 1.0)).set("width", format!("{:.1}", wide - 2.0));
        let rectangle = rectangle.set("y", format!("{:.1}", TOP + HEIGHT - tall)).set("height", format!("{tall:.1}"));
        group = group.add(rectangle.set("fill", "#0072b2"));
        if (bar - CENTIMETRES) % 4 == 0 {
            group = group.add(label(&(bar - CENTIMETRES).to_string(), (x, TOP + HEIGHT + 14.0), "middle"));
        }
    }
    let strays = heard.errors.iter().filter(|error| error.abs() >= 0.08).count();
    let percent = |count: usize| format!("{:.1} %", 100.0 * count as f64 / MANY as f64);
    let message = [format!("no echo: {}", percent(heard.silent)), format!("anything else: {}", percent(strays))];
    for (number, line) in message.iter().enumerate() {
        group = group.add(label(line, (LEFT[1] + WIDTH - 8.0, TOP + 20.0 + 18.0 * number as f64), "end"));
    }
    group
}

/// Draws the labels of a chart.
fn frame(left: f64, up: &str, along: &str) -> Group {
    let group = Group::new().add(label(up, (left, TOP - 16.0), "start"));
    group.add(label(along, (left + WIDTH / 2.0, TOP + HEIGHT + 38.0), "middle"))
}

fn rule(y: f64, left: f64) -> Line {
    Line::new().set("x1", left).set("x2", left + WIDTH).set("y1", y).set("y2", y).set("stroke", GRID)
}

fn label(content: &str, (x, y): (f64, f64), anchor: &str) -> Text {
    let text = Text::new(content).set("x", format!("{x:.1}")).set("y", format!("{y:.1}")).set("dy", "0.35em");
    text.set("text-anchor", anchor)
}
