//! Finds the contours of the occupied pixels in a map, and smooths the pixel steps of slanted lines.

/// Maximum distance, in pixels, between a line and the pixel corners that it replaces. The steps of a slanted line
/// deviate by up to 1 pixel, and by a little more if the line begins at an unfavourable corner.
const TOLERANCE: f64 = 1.25;
/// Maximum number of pixel sides between occupied and free pixels. At 5 cm per pixel, this corresponds to 200 km of
/// walls.
const SIDES_MOST: usize = 4_000_000;
/// Maximum number of corners that are smoothed together. The limit is needed because the computing time grows with the
/// square of this number.
const TOGETHER: usize = 1024;

/// A corner of a pixel: the column and the row of the pixel whose upper left corner it is.
type Corner = (i32, i32);

/// Possible steps from a corner, in the order of the bits of [`Sides::steps`]. If a line can continue with either of
/// two steps from its first corner, it takes the one that is earlier in this list and belongs to the upper pixel.
const STEPS: [Corner; 4] = [(0, -1), (1, 0), (0, 1), (-1, 0)];

/// Returns closed lines around the occupied pixels. Each line ends where it began; the order of the lines depends only
/// on the image.
///
/// # Errors
/// Fails if the image has more sides than `SIDES_MOST`.
pub(super) fn contours(
    width: usize,
    height: usize,
    stands: impl Fn(usize, usize) -> bool,
) -> Result<Vec<Vec<Corner>>, String> {
    let mut sides = Sides::of(width, height, stands)?;
    let mut loops = Vec::new();
    while let Some(from) = sides.first() {
        let mut line = vec![from];
        let (mut here, mut came) = (from, (0, 0));
        while let Some(step) = sides.taken(here, came) {
            let next = (here.0 + step.0, here.1 + step.1);
            if step == came {
                // Inner corners of a straight line are not needed.
                line.pop();
            }
            (came, here) = (step, next);
            line.push(here);
            if here == from {
                break;
            }
        }
        loops.push(smoothed(&line));
    }
    Ok(loops)
}

/// Pixel sides with an occupied pixel on their left and a free one on their right, stored as steps from each corner.
struct Sides {
    /// Possible steps from each corner, one bit for each step. The corners are stored column by column.
    steps: Vec<u8>,
    rows: usize,
    /// Index of a corner; all corners before it have no steps left.
    next: usize,
}

impl Sides {
    fn of(width: usize, height: usize, stands: impl Fn(usize, usize) -> bool) -> Result<Self, String> {
        let rows = height + 1;
        let mut steps = vec![0_u8; (width + 1) * rows];
        let mut count = 0_usize;
        for row in 0..height {
            for column in (0..width).filter(|column| stands(*column, row)) {
                let mut leave = |column: usize, row: usize, step: u8| {
                    steps[column * rows + row] |= 1 << step;
                    count += 1;
                };
                if row == 0 || !stands(column, row - 1) {
                    leave(column + 1, row, 3);
                }
                if row + 1 == height || !stands(column, row + 1) {
                    leave(column, row + 1, 1);
                }
                if column == 0 || !stands(column - 1, row) {
                    leave(column, row, 2);
                }
                if column + 1 == width || !stands(column + 1, row) {
                    leave(column + 1, row + 1, 0);
                }
            }
            if count > SIDES_MOST {
                return Err(format!(
                    "what stands has more than {SIDES_MOST} sides of pixels; a map of walls has fewer, and `occupied_thresh` \
                     says how dark a pixel of them is"
                ));
            }
        }
        Ok(Self { steps, rows, next: 0 })
    }

    /// Returns the first corner that has steps left, ordered by columns and then by rows; `None` if no steps are left.
    fn first(&mut self) -> Option<Corner> {
        let ahead = self.steps.get(self.next..)?.iter().position(|steps| *steps != 0)?;
        self.next += ahead;
        // There are at most 100 million pixels.
        Some(((self.next / self.rows) as i32, (self.next % self.rows) as i32))
    }

    /// Removes and returns the step that continues from `here`; `None` if there is no step. Where two pixels touch at a
    /// corner, the step continues along the same pixel.
    fn taken(&mut self, here: Corner, came: Corner) -> Option<Corner> {
        let steps = self.steps.get_mut(here.0 as usize * self.rows + here.1 as usize)?;
        let turns = |step: Corner| came.0 * step.1 - came.1 * step.0;
        let open = STEPS.iter().enumerate().filter(|(bit, _)| *steps >> bit & 1 == 1);
        let (bit, step) = open.min_by_key(|(_, step)| turns(**step))?;
        *steps &= !(1 << bit);
        Some(*step)
    }
}

/// Returns a simplified line. No omitted corner is further from the new line than the tolerance.
fn smoothed(line: &[Corner]) -> Vec<Corner> {
    let far = |from: Corner| {
        let distance = |to: &Corner| i64::from(to.0 - from.0).pow(2) + i64::from(to.1 - from.1).pow(2);
        (0..line.len()).max_by_key(|number| line.get(*number).map_or(0, distance)).unwrap_or(0)
    };
    let Some(first) = line.first() else { return Vec::new() };
    // A closed line is split at the corner furthest from its beginning, and at intervals if it is long.
    let split = far(*first);
    let mut kept = vec![false; line.len()];
    for (from, to) in [(0, split), (split, line.len() - 1)] {
        let mut begin = from;
        loop {
            let end = to.min(begin + TOGETHER);
            keep(line, begin, end, &mut kept);
            if end == to {
                break;
            }
            begin = end;
        }
    }
    // A shape thinner than the tolerance becomes a line there and back, that is, a wall without thickness.
    line.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(corner, _)| *corner).collect()
}

/// Marks the corners between the corners `from` and `to` of a line that the simplified line needs (algorithm of Douglas
/// and Peucker, 1973).
fn keep(line: &[Corner], from: usize, to: usize, kept: &mut [bool]) {
    let mut open = vec![(from, to)];
    while let Some((from, to)) = open.pop() {
        kept[from] = true;
        kept[to] = true;
        let off = distance(line[from], line[to]);
        let mut worst = (0.0, None);
        for (number, corner) in line.iter().enumerate().take(to).skip(from + 1) {
            let off = off(*corner);
            if off >= worst.0 {
                worst = (off, Some(number));
            }
        }
        if let (off, Some(worst)) = worst
            && off > TOLERANCE
        {
            open.extend([(from, worst), (worst, to)]);
        }
    }
}

/// Returns a function that computes the distance of a corner from the line through `from` and `to`.
fn distance(from: Corner, to: Corner) -> impl Fn(Corner) -> f64 {
    let number = |value: i32| f64::from(value);
    let (dx, dy) = (number(to.0 - from.0), number(to.1 - from.1));
    let length = libm::hypot(dx, dy);
    move |at| {
        let (x, y) = (number(at.0 - from.0), number(at.1 - from.1));
        if length == 0.0 { libm::hypot(x, y) } else { (x * dy - y * dx).abs() / length }
    }
}
