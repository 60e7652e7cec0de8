//! SVG elements for the plots, with coordinates in tenths of a pixel.

use svg::node::element::{Circle, Group, Line, Path, Text};

use super::colours;

/// Position in a drawing, in pixels.
pub(super) type Pixel = (f64, f64);

/// Rounds a number to a tenth of a pixel. The result is never a negative zero.
pub(super) fn tenths(pixels: f64) -> f64 {
    libm::round(pixels * 10.0) / 10.0 + 0.0
}

pub(super) fn circle((x, y): Pixel, radius: f64) -> Circle {
    Circle::new().set("cx", tenths(x)).set("cy", tenths(y)).set("r", tenths(radius))
}

pub(super) fn line((x1, y1): Pixel, (x2, y2): Pixel) -> Line {
    Line::new().set("x1", tenths(x1)).set("y1", tenths(y1)).set("x2", tenths(x2)).set("y2", tenths(y2))
}

/// Returns a line of text that is vertically centred at this height; `anchor` is `start`, `middle` or `end`.
pub(super) fn text(content: &str, (x, y): Pixel, anchor: &str) -> Text {
    let text = Text::new(content).set("x", tenths(x)).set("y", tenths(y)).set("dy", "0.35em");
    if anchor == "start" { text } else { text.set("text-anchor", anchor) }
}

/// Returns an open line through these points.
pub(super) fn polyline<P: IntoIterator<Item = Pixel>>(pixels: P) -> Path {
    Path::new().set("d", through(pixels)).set("fill", "none")
}

/// Returns the path data of a line through these points. The data contain the start, and then relative steps.
pub(super) fn through(pixels: impl IntoIterator<Item = Pixel>) -> String {
    let mut data = String::new();
    let mut last: Option<(i64, i64)> = None;
    for pixel in pixels {
        let here = whole(pixel);
        match last {
            None => data += &format!("M{}", pair(here)),
            Some(last) if last == here => continue,
            Some(last) => data += &format!("l{}", pair((here.0 - last.0, here.1 - last.1))),
        }
        last = Some(here);
    }
    data
}

/// Returns the path data of a dot at each of these points. The dots are lines with round ends.
pub(super) fn dots(pixels: impl IntoIterator<Item = Pixel>) -> String {
    let mut data = String::new();
    let mut last = (0, 0);
    for pixel in pixels {
        let here = whole(pixel);
        data += &format!("m{}h0", pair((here.0 - last.0, here.1 - last.1)));
        last = here;
    }
    data
}

fn whole((x, y): Pixel) -> (i64, i64) {
    (libm::round(x * 10.0) as i64, libm::round(y * 10.0) as i64)
}

/// Formats two numbers, which are given in tenths. A minus sign needs no space before it.
fn pair((x, y): (i64, i64)) -> String {
    let (x, y) = (x as f64 / 10.0, y as f64 / 10.0);
    if y < 0.0 { format!("{x}{y}") } else { format!("{x} {y}") }
}

/// Maximum distance, in pixels, of an omitted point from the simplified line.
const BESIDE: f64 = 0.2;

/// Omits points that are not needed to draw a line that looks the same.
pub(super) fn simplified(pixels: impl IntoIterator<Item = Pixel>) -> Vec<Pixel> {
    let mut kept: Vec<Pixel> = Vec::new();
    // Points since the last kept point.
    let mut since: Vec<Pixel> = Vec::new();
    for pixel in pixels {
        let Some(anchor) = kept.last().copied() else {
            kept.push(pixel);
            continue;
        };
        let straight = since.len() < LONGEST && since.iter().all(|between| off(*between, anchor, pixel) <= BESIDE);
        if let Some(last) = since.last().copied().filter(|_| !straight) {
            kept.push(last);
            since.clear();
        }
        since.push(pixel);
    }
    kept.extend(since.last());
    kept
}

/// Maximum number of points that one straight line replaces. The limit is needed because the computing time grows with
/// the square of this number.
const LONGEST: usize = 500;

/// Returns the distance of a point from the line through two other points.
fn off((x, y): Pixel, (x1, y1): Pixel, (x2, y2): Pixel) -> f64 {
    let (dx, dy) = (x2 - x1, y2 - y1);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 { (((x - x1) * dx + (y - y1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(x - x1 - along * dx, y - y1 - along * dy)
}

/// Radius of a label, in pixels.
pub(super) const RADIUS: f64 = 10.0;

/// Draws the number of an atom in a disc of its colour.
pub(super) fn badge(at: Pixel, number: &str, atom: usize) -> Group {
    // Long numbers have smaller letters.
    let size = match number.len() {
        0..=2 => 12,
        3 => 9,
        _ => 7,
    };
    let disc = circle(at, RADIUS).set("class", colours::class("disc", atom));
    let text = text(number, at, "middle").set("class", colours::class("on", atom)).set("font-size", size);
    Group::new().add(disc).add(text)
}

/// Draws a cross that marks a contact.
pub(super) fn cross((x, y): Pixel) -> Path {
    let data = format!("M{} {}l8 8m0-8l-8 8", tenths(x - 4.0), tenths(y - 4.0));
    Path::new().set("d", data).set("fill", "none").set("class", "contact").set("stroke-width", 2.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_add_up_to_the_places_they_came_from() {
        let pixels = (0..500).map(|number| (f64::from(number) * 0.137, f64::from(number) * -0.261));
        let data = through(pixels.clone());
        let mut at = (0.0, 0.0);
        for step in data[1..].split('l') {
            let cut = step[1..].find(['-', ' ']).unwrap() + 1;
            let (x, y) = step.split_at(cut);
            at.0 += x.parse::<f64>().unwrap();
            at.1 += y.trim().parse::<f64>().unwrap();
        }
        let end = pixels.max_by(|one, other| one.0.total_cmp(&other.0)).unwrap();
        assert!((at.0 - end.0).abs() < 0.051 && (at.1 - end.1).abs() < 0.051, "{at:?} {end:?}");
    }

    #[test]
    fn a_simplified_line_keeps_its_ends_and_corners() {
        let square = (0..400).map(|step| {
            let along = f64::from(step % 100) / 10.0;
            [(along, 0.0), (10.0, along), (10.0 - along, 10.0), (0.0, 10.0 - along)][step as usize / 100]
        });
        let corners = simplified(square);
        assert!(corners.len() <= 9, "{corners:?}");
        for corner in [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.1)] {
            assert!(corners.iter().any(|at| libm::hypot(at.0 - corner.0, at.1 - corner.1) < 0.5), "{corner:?}");
        }
        // A line that returns to its start must keep its turning point.
        assert_eq!(simplified([(0.0, 0.0), (5.0, 0.0), (9.0, 0.0), (5.0, 0.0), (0.0, 0.0)]).len(), 3);
    }

    #[test]
    fn a_place_where_nothing_moves_is_one_place() {
        assert_eq!(through([(1.0, 2.0), (1.01, 2.0), (1.02, 1.98)]), "M1 2");
        assert_eq!(dots([(1.0, 2.0), (0.5, 2.0)]), "m1 2h0m-0.5 0h0");
    }
}
