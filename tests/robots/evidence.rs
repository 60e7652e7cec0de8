//! Tests the maps that `mdle map` makes of a Scout's drive at each landmark: the walls that they show, and the errors
//! that they contain (docs/src/navigation.md).
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test tells")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use mdle_sim::{Point, Walls, World};
use mdle_tests::chance::sized;
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;

/// Number of cells of a map along each axis, and the edge of a cell in metres.
const CELLS: usize = 150;
const CELL: f64 = 0.0254;
/// Range, in metres, within which a place on the floor counts as seen.
const SIGHT: f64 = 2.5;
/// Landmarks with the start of the drive: the place, in metres, and the heading, in degrees.
const LANDMARKS: [(&str, [f64; 3]); 3] =
    [("lab2", [0.0, 0.0, 0.0]), ("lab1", [7.45, 0.3, 180.0]), ("office", [11.5, 0.0, 270.0])];
/// Distance of the start from the middle of the doorway, which is the origin of the map, in metres.
const BEFORE_DOOR: f64 = 0.75;

/// A cell by its column and row.
type Cell = [usize; 2];

/// The floor around a landmark.
struct Floor {
    walls: Walls,
    /// Middle of the doorway, and sine and cosine of the direction through it.
    origin: Point,
    direction: (f64, f64),
    /// Cells on walls, each with a point of the wall.
    on_walls: Vec<(Cell, Point)>,
}

impl Floor {
    fn at([x, y, degrees]: [f64; 3]) -> Self {
        let (world, direction) = (World::office().unwrap(), libm::sincos(degrees.to_radians()));
        let origin = Point { x: x + BEFORE_DOOR * direction.1, y: y + BEFORE_DOOR * direction.0 };
        let mut floor = Self { walls: Walls::of(&world), origin, direction, on_walls: Vec::new() };
        for (_, from, to) in world.segments() {
            let steps = (libm::hypot(to.x - from.x, to.y - from.y) / CELL).ceil() as u32;
            let parts = (0..=steps).map(|step| f64::from(step) / f64::from(steps));
            let points =
                parts.map(|part| Point { x: from.x + part * (to.x - from.x), y: from.y + part * (to.y - from.y) });
            let cells: Vec<_> = points.filter_map(|point| Some((floor.cell(point)?, point))).collect();
            floor.on_walls.extend(cells);
        }
        floor
    }

    /// Returns the cell that contains a point of the floor; `None` outside the map.
    fn cell(&self, point: Point) -> Option<Cell> {
        let ((sin, cos), x, y) = (self.direction, point.x - self.origin.x, point.y - self.origin.y);
        let cells = [x * cos + y * sin, y * cos - x * sin].map(|at| (at / CELL + CELLS as f64 / 2.0).floor());
        cells.iter().all(|cell| (0.0..CELLS as f64).contains(cell)).then(|| cells.map(|cell| cell as usize))
    }

    /// Returns the middle of a cell.
    fn middle(&self, cell: Cell) -> Point {
        let [x, y] = cell.map(|cell| (cell as f64 + 0.5 - CELLS as f64 / 2.0) * CELL);
        let (sin, cos) = self.direction;
        Point { x: self.origin.x + x * cos - y * sin, y: self.origin.y + x * sin + y * cos }
    }

    /// Returns `true` if nothing stands between the point and one of the robot's places.
    fn is_seen(&self, point: Point, places: &[Point]) -> bool {
        places.iter().any(|from| {
            let (x, y) = (point.x - from.x, point.y - from.y);
            let range = libm::hypot(x, y);
            let way = Point { x: x / range, y: y / range };
            // The point may be on a wall.
            range < SIGHT && self.walls.cast(*from, way, range - CELL / 2.0).is_none()
        })
    }
}

/// Returns `true` if one of the cells within `reach` cells of `cell` along both axes is marked.
fn has_near(marked: &[bool], cell: Cell, reach: usize) -> bool {
    let [columns, rows] = cell.map(|at| at.saturating_sub(reach)..=(at + reach).min(CELLS - 1));
    rows.into_iter().any(|row| columns.clone().any(|column| marked[row * CELLS + column]))
}

/// Fractions that describe a map.
#[derive(Debug, Default)]
struct Quality {
    /// Fraction of the seen wall cells with an occupied cell within three cells.
    recall: f64,
    /// Fraction of the occupied cells with a wall within four cells.
    precision: f64,
    /// Fractions of the seen cells off walls that are free, and that are occupied.
    free: f64,
    wrong: f64,
}

fn share(cells: impl Iterator<Item = bool>) -> f64 {
    let (mut count, mut all) = (0.0, 0.0);
    cells.for_each(|counts| (count, all) = (count + f64::from(u8::from(counts)), all + 1.0));
    count / all
}

/// Returns the quality of a map, given as grey values row by row from the top, of a drive along these places.
fn quality(floor: &Floor, greys: &[u8], places: &[Point]) -> Quality {
    let of_row = |row: usize| &greys[(CELLS - 1 - row) * CELLS..(CELLS - row) * CELLS];
    let probabilities: Vec<f64> = (0..CELLS).flat_map(of_row).map(|grey| 1.0 - f64::from(*grey) / 255.0).collect();
    let occupied: Vec<bool> = probabilities.iter().map(|p| *p > 0.65).collect();
    let mut walls = vec![false; CELLS * CELLS];
    floor.on_walls.iter().for_each(|([column, row], _)| walls[row * CELLS + column] = true);
    let cells = || (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| [column, row]));
    let of = |[column, row]: Cell| row * CELLS + column;
    let seen_walls = floor.on_walls.iter().filter(|(_, point)| floor.is_seen(*point, places));
    let off_walls: Vec<f64> = cells()
        .filter(|cell| !has_near(&walls, *cell, 4) && floor.is_seen(floor.middle(*cell), places))
        .map(|cell| probabilities[of(cell)])
        .collect();
    Quality {
        recall: share(seen_walls.map(|(cell, _)| has_near(&occupied, *cell, 3))),
        precision: share(cells().filter(|cell| occupied[of(*cell)]).map(|cell| has_near(&walls, cell, 4))),
        free: share(off_walls.iter().map(|p| *p < 0.35)),
        wrong: share(off_walls.iter().map(|p| *p > 0.65)),
    }
}

/// Returns the quality of the map of a drive by this body.
fn mapped(folder: &Path, start: [f64; 3], body: &str, seed: u64) -> Quality {
    let drive = root().join("plans/navigation/map.mdle");
    let [x, y, degrees] = start;
    let run = |words: &str| {
        let output = Command::new(mdle()).args(words.split(' ')).current_dir(folder).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    };
    for file in ["drive.mcap", "drive.csv", "map.yaml", "map.pgm"] {
        let _ = fs::remove_file(folder.join(file));
    }
    let target = format!("--target sim --speed max --body {body} --seed {seed} --start {x},{y},{degrees}");
    run(&format!("run {} {target} --log drive.mcap --trail drive.csv", drive.display()));
    run(&format!("map drive.mcap map.yaml --at -{BEFORE_DOOR},0,0"));
    let mut places = BTreeMap::new();
    for line in fs::read_to_string(folder.join("drive.csv")).unwrap().lines().skip(1) {
        let [x, y] = [1, 2].map(|column| line.split(',').nth(column).unwrap().parse::<f64>().unwrap());
        // One place for each decimetre is enough.
        places.insert([x, y].map(|at| (at * 10.0).round() as i64), Point { x, y });
    }
    let map = fs::read(folder.join("map.pgm")).unwrap();
    let places: Vec<Point> = places.into_values().collect();
    quality(&Floor::at(start), &map[map.len() - CELLS * CELLS..], &places)
}

/// Asserts that the mean quality of the maps at each landmark is at least as good as `least`.
fn assert_good(test: &str, body: &str, seeds: u64, least: &Quality) {
    let folder = folder(test);
    for (name, start) in LANDMARKS {
        let all: Vec<Quality> = (0..seeds).map(|seed| mapped(&folder, start, body, 9_700_000 + seed)).collect();
        let mean = |of: fn(&Quality) -> f64| all.iter().map(of).sum::<f64>() / seeds as f64;
        let [recall, precision] = [mean(|map| map.recall), mean(|map| map.precision)];
        let [free, wrong] = [mean(|map| map.free), mean(|map| map.wrong)];
        let mean = Quality { recall, precision, free, wrong };
        println!("{name}, {body}: {mean:.2?}, of {:.2?}", all.iter().map(|map| map.recall).collect::<Vec<_>>());
        assert!(mean.recall >= least.recall && mean.precision >= least.precision, "{name}: {mean:?}");
        assert!(mean.free >= least.free && mean.wrong <= least.wrong, "{name}: {mean:?}");
    }
}

#[test]
fn maps_of_a_scout_show_the_walls() {
    let least = Quality { recall: 0.65, precision: 0.6, free: 0.9, wrong: 0.04 };
    assert_good("evidence_scout", "scout", sized(3, 12), &least);
}

#[test]
fn maps_of_an_ideal_body_show_all_walls() {
    let least = Quality { recall: 0.95, precision: 0.7, free: 0.9, wrong: 0.05 };
    assert_good("evidence_ideal", "ideal", sized(1, 3), &least);
}
