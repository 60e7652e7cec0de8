//! The drawing itself, as SVG: the floor, the way coloured by atom, where each atom began, and what it was.

use std::fmt::Display;

use mdle_runtime::Pose;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::labels::{self, Pixel};
use super::layout::{BELOW, LEFT, LETTERS, LINE, Layout, MARGIN, MARKS_MOST};
use crate::body::RADIUS;
use crate::trail::Trail;
use crate::world::{Place, World};

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

const INK: RGBColor = RGBColor(38, 43, 51);
const FAINT: RGBColor = RGBColor(130, 138, 150);
const GRID: RGBColor = RGBColor(236, 238, 242);
const BOX: RGBColor = RGBColor(205, 209, 216);
/// The colours of the atoms, over and over; dark enough for white numbers.
const COLOURS: [RGBColor; 8] = [
    RGBColor(31, 98, 190),
    RGBColor(204, 72, 22),
    RGBColor(20, 128, 94),
    RGBColor(148, 62, 170),
    RGBColor(168, 112, 0),
    RGBColor(200, 40, 96),
    RGBColor(0, 124, 150),
    RGBColor(112, 84, 66),
];

/// The plot of a trail on the floor of `world`; an error says what the drawing library did not like.
pub(crate) fn svg(world: &World, trail: &Trail) -> Result<String, String> {
    let layout = Layout::of(world, trail);
    let mut svg = String::new();
    drawn(&mut svg, &layout, world, trail).map_err(|error| error.to_string())?;
    svg.push('\n');
    Ok(svg)
}

fn drawn<'a>(svg: &'a mut String, layout: &Layout, world: &World, trail: &Trail) -> Result<(), impl Display + use<>> {
    let backend = SVGBackend::with_string(svg, (layout.chart + layout.legend, layout.height));
    let root: Area<'a> = backend.into_drawing_area();
    root.fill(&WHITE)?;
    let (left, _) = root.split_horizontally(layout.chart);
    let mut chart = ChartBuilder::on(&left)
        .margin(MARGIN)
        .x_label_area_size(BELOW)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(layout.x.0..layout.x.1, layout.y.0..layout.y.1)?;
    axes(&mut chart, layout)?;
    floor(&chart, world)?;
    way(&chart, layout, trail)?;
    let dots: Vec<Pixel> = trail
        .marks
        .iter()
        .take(MARKS_MOST)
        .filter_map(|mark| mark.way.first().map(|place| chart.backend_coord(&point(place))))
        .collect();
    marks(&root, layout, &dots)?;
    legend(&root, layout)?;
    root.present()
}

type Drawn = Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

fn axes(chart: &mut Chart<'_>, layout: &Layout) -> Drawn {
    let labels = |(least, most): (f64, f64)| ((most - least) * layout.scale / 60.0) as usize + 1;
    chart
        .configure_mesh()
        .x_labels(labels(layout.x))
        .y_labels(labels(layout.y))
        .max_light_lines(0)
        .bold_line_style(GRID)
        .axis_style(FAINT)
        .label_style(("sans-serif", 12).with_color(INK))
        .axis_desc_style(("sans-serif", 13).with_color(INK))
        .x_label_formatter(&metres)
        .y_label_formatter(&metres)
        .x_desc("x in m")
        .y_desc("y in m")
        .draw()
}

/// A number of an axis, without zeros that say nothing.
fn metres(value: &f64) -> String {
    let rounded = libm::round(value * 1000.0) / 1000.0;
    // Adding zero makes a negative zero positive.
    format!("{}", rounded + 0.0)
}

fn floor(chart: &Chart<'_>, world: &World) -> Drawn {
    let area = chart.plotting_area();
    for outline in &world.outlines {
        let line: Vec<(f64, f64)> = outline.points.iter().map(point).collect();
        if outline.solid {
            area.draw(&Polygon::new(line.clone(), BOX.filled()))?;
        }
        area.draw(&PathElement::new(line, INK.stroke_width(3)))?;
    }
    Ok(())
}

/// The way, and the body where it started and where it is now.
fn way(chart: &Chart<'_>, layout: &Layout, trail: &Trail) -> Drawn {
    let area = chart.plotting_area();
    for (pose, colour) in [(&trail.start, FAINT), (&trail.here, INK)] {
        let size = libm::round(RADIUS * layout.scale) as i32;
        area.draw(&Circle::new(point(&Place::of(pose)), size, colour.stroke_width(1)))?;
        area.draw(&PathElement::new(heading(pose), colour.stroke_width(1)))?;
    }
    area.draw(&PathElement::new(line(&trail.before), FAINT.stroke_width(2)))?;
    for (number, mark) in trail.marks.iter().enumerate() {
        area.draw(&PathElement::new(line(&mark.way), colour(number).stroke_width(2)))?;
    }
    Ok(())
}

/// The line from the centre of the body to its front.
fn heading(pose: &Pose) -> Vec<(f64, f64)> {
    let front = pose.towards(pose.theta, mdle_runtime::Meters(RADIUS));
    vec![point(&Place::of(pose)), point(&Place::of(&front))]
}

fn marks(root: &Area<'_>, layout: &Layout, dots: &[Pixel]) -> Drawn {
    let bounds = (layout.chart as i32, layout.height as i32);
    let labels = labels::placed(dots, bounds);
    for (dot, label) in dots.iter().zip(&labels) {
        root.draw(&PathElement::new(vec![*dot, *label], FAINT.stroke_width(1)))?;
    }
    for (number, (dot, label)) in dots.iter().zip(&labels).enumerate() {
        root.draw(&Circle::new(*dot, labels::DOT, colour(number).filled()))?;
        let text = layout.lines.get(number).map_or("", |(state, _, _)| state);
        badge(root, *label, text, colour(number))?;
    }
    Ok(())
}

fn legend(root: &Area<'_>, layout: &Layout) -> Drawn {
    let left = layout.chart as i32;
    let right = left + layout.legend as i32 - MARGIN as i32;
    let letters = |horizontal| {
        ("sans-serif", LETTERS).with_color(INK).into_text_style(root).pos(Pos::new(horizontal, VPos::Center))
    };
    for (number, (state, law, t)) in layout.lines.iter().enumerate() {
        let y = (MARGIN + LINE) as i32 + (LINE as i32) * (number as i32);
        if !state.is_empty() {
            badge(root, (left + labels::RADIUS, y), state, colour(number))?;
        }
        root.draw(&Text::new(law.as_str(), (left + 2 * labels::RADIUS + 10, y), letters(HPos::Left)))?;
        root.draw(&Text::new(t.as_str(), (right, y), letters(HPos::Right)))?;
    }
    Ok(())
}

/// A number in a disc.
fn badge(root: &Area<'_>, at: Pixel, text: &str, colour: RGBColor) -> Drawn {
    root.draw(&Circle::new(at, labels::RADIUS, colour.filled()))?;
    // Long numbers in smaller letters.
    let size = match text.len() {
        0..=2 => 12,
        3 => 9,
        _ => 7,
    };
    let style = ("sans-serif", size).with_color(WHITE).into_text_style(root).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new(text, at, style))
}

fn colour(number: usize) -> RGBColor {
    COLOURS[number % COLOURS.len()]
}

fn line(places: &[Place]) -> Vec<(f64, f64)> {
    places.iter().map(point).collect()
}

fn point(place: &Place) -> (f64, f64) {
    (place.x, place.y)
}
