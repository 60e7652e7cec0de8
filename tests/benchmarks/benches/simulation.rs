//! Measures the speed of the simulator: of rays, compared with a bare traversal of grid cells, and of a whole robot.
#![allow(clippy::expect_used, reason = "a benchmark of a world that is not there fails by panicking")]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mdle_runtime::{RadiansPerSecond, Robot, Twist};
use mdle_sim::{Body, Make, ModelPart, Point, Simulated, Walls, World};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Maximum range of a Scout's sonars, in metres.
const REACH: f64 = 6.477;
/// Number of rays of one measurement.
const RAYS: usize = 10_000;

fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns a world of walls, 0.5 to 2 m long and scattered over a square with the side `side`, and random rays in this
/// world.
fn scattered(walls: usize, side: f64) -> (World, Vec<(Point, Point)>) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut text = String::new();
    for _ in 0..walls {
        let (x, y) = (side * uniform(&mut random), side * uniform(&mut random));
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * uniform(&mut random));
        let length = 0.5 + 1.5 * uniform(&mut random);
        text += &format!("[[wall]]\npoints = [[{x}, {y}], [{}, {}]]\n", x + length * cos, y + length * sin);
    }
    let rays = (0..RAYS).map(|_| {
        let from = Point { x: side * uniform(&mut random), y: side * uniform(&mut random) };
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * uniform(&mut random));
        (from, Point { x: cos, y: sin })
    });
    let rays = rays.collect();
    (World::parse("scattered", &text).expect("a good world"), rays)
}

/// A grid that measures the minimum work of any search in a grid: a ray steps from cell to cell until it reaches an
/// occupied cell.
struct Cells {
    taken: Vec<bool>,
    count: usize,
    cell: f64,
}

impl Cells {
    fn of(world: &World, side: f64, cell: f64) -> Self {
        let count = (side / cell) as usize + 1;
        let mut taken = vec![false; count * count];
        for outline in &world.outlines {
            for (from, to) in outline.points.iter().zip(outline.points.iter().skip(1)) {
                for part in 0..=100 {
                    let part = f64::from(part) / 100.0;
                    let (x, y) = (from.x + part * (to.x - from.x), from.y + part * (to.y - from.y));
                    let (column, row) = ((x / cell) as usize, (y / cell) as usize);
                    if column < count && row < count {
                        taken[row * count + column] = true;
                    }
                }
            }
        }
        Self { taken, count, cell }
    }

    fn ray(&self, from: Point, way: Point, most: f64) -> Option<f64> {
        let (mut column, mut row) = ((from.x / self.cell) as usize, (from.y / self.cell) as usize);
        let next = |from: f64, way: f64, cell: usize| {
            let border = (cell + usize::from(way > 0.0)) as f64 * self.cell;
            if way == 0.0 { f64::INFINITY } else { (border - from) / way }
        };
        let (mut across, mut up) = (next(from.x, way.x, column), next(from.y, way.y, row));
        let (wide, high) = ((self.cell / way.x).abs(), (self.cell / way.y).abs());
        let mut range = 0.0;
        while range < most && column < self.count && row < self.count {
            if self.taken[row * self.count + column] {
                return Some(range);
            }
            if across < up {
                range = across;
                across += wide;
                column = if way.x > 0.0 { column + 1 } else { column.wrapping_sub(1) };
            } else {
                range = up;
                up += high;
                row = if way.y > 0.0 { row + 1 } else { row.wrapping_sub(1) };
            }
        }
        None
    }
}

fn rays(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rays");
    group.throughput(Throughput::Elements(RAYS as u64));
    for (walls, side) in [(200, 20.0), (10_000, 140.0)] {
        let (world, rays) = scattered(walls, side);
        let ready = Walls::of(&world);
        let cells = Cells::of(&world, side, 0.1);
        group.bench_function(BenchmarkId::new("bare cells of 10 cm", walls), |bencher| {
            bencher
                .iter(|| rays.iter().filter_map(|(from, way)| cells.ray(*from, *way, black_box(REACH))).sum::<f64>());
        });
        group.bench_function(BenchmarkId::new("walls", walls), |bencher| {
            bencher
                .iter(|| rays.iter().filter_map(|(from, way)| ready.cast(*from, *way, black_box(REACH))).sum::<f64>());
        });
    }
    group.finish();
}

/// Measures a second of simulated time, which is ten turns, of a robot that turns on the spot in hallway A of the
/// office.
fn robot(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("robot, one second");
    let world = World::office().expect("our own floor");
    let every_turn = vec![ModelPart::Order];
    for (name, body, without) in
        [("ideal", Body::Ideal, vec![]), ("scout", Body::Scout, vec![]), ("scout, full rings", Body::Scout, every_turn)]
    {
        let make = Make { body, without, seed: Some(1) };
        let period = std::time::Duration::from_millis(100);
        let mut robot = Simulated::with(&make, &world, world.start, period).expect("a start on the floor");
        let input = Twist { omega: RadiansPerSecond(0.36), ..Twist::default() };
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                (0..10).map(|_| robot.exchange(black_box(&input)).map(|y| y.switches)).sum::<Result<u32, _>>()
            });
        });
    }
    group.finish();
}

/// Measures the start: from the text of a world to a robot in this world.
fn start(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("start");
    group.sample_size(10);
    let period = std::time::Duration::from_millis(100);
    group.bench_function("office", |bencher| {
        bencher.iter(|| {
            let world = World::office().expect("our own floor");
            Simulated::with(&Make::default(), &world, world.start, period).expect("a start on the floor")
        });
    });
    group.finish();
}

criterion_group!(benches, rays, robot, start);
criterion_main!(benches);
