//! Compares the sonars of the simulated Scout with measurements of real ones, and checks their picture in the book.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

mod heard;
mod picture;

use std::path::Path;

use heard::{COLUMN, Heard, WALL, heard};

/// Number of pings from which a fraction is computed.
const PINGS: usize = 100;
/// Number of pings from which a histogram is drawn.
const MANY: usize = 2000;

/// Cao and Borenstein (2002) measured echoes of a flat wall up to 42 degrees off its normal, and of a cylinder only at
/// much smaller angles.
#[test]
fn a_flat_wall_is_heard_up_to_forty_degrees_and_a_column_less() {
    let share = |what, distance, degrees| heard(what, distance, degrees, PINGS).share();
    for (what, distance, heard_at, unheard_at) in
        [(WALL, 1.0, 38.0, 44.0), (WALL, 5.0, 24.0, 34.0), (COLUMN, 1.0, 15.0, 35.0)]
    {
        let (near, far) = (share(what, distance, heard_at), share(what, distance, unheard_at));
        assert!(near > 0.6 && far < 0.4, "{what} at {distance} m: {near} at {heard_at} degrees, {far} at {unheard_at}");
    }
    assert!(share(WALL, 1.0, 30.0) > 0.95 && share(WALL, 1.0, 55.0) < 0.05);
}

/// The error of a range is at most 3 cm in a closed room, plus 1 %. Ranges are in whole inches, rounded down. One ping
/// in a hundred has no echo, and one in two hundred has a random range.
#[test]
fn ranges_err_as_much_as_was_measured() {
    for distance in [0.5, 1.0, 4.0] {
        let Heard { errors, silent } = heard(WALL, distance, 0.0, MANY);
        let near = |error: &&f64| error.abs() < 0.0254 + 0.03 + 0.01 * distance;
        let close: Vec<f64> = errors.iter().filter(near).copied().collect();
        let strays = (errors.len() - close.len()) as f64 / MANY as f64;
        let mean = close.iter().sum::<f64>() / close.len() as f64;
        assert!((0.001..0.011).contains(&strays), "{distance} m: {strays}");
        assert!((0.004..0.018).contains(&(silent as f64 / MANY as f64)), "{distance} m: {silent} of {MANY}");
        // Rounding down shortens ranges by half an inch on average.
        assert!((mean + 0.0127).abs() < 0.01, "{distance} m: {mean}");
        let within = close.iter().filter(|error| (*error + 0.0127).abs() < 0.03 + 0.01 * distance).count();
        assert!(within as f64 > 0.97 * close.len() as f64, "{distance} m: {within} of {}", close.len());
    }
}

#[test]
fn the_picture_in_the_book_is_of_these_sonars() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/sonar_model.svg");
    let drawn = picture::svg();
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &drawn).expect("the book is there");
    }
    let shown = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(shown == drawn, "INSTA_UPDATE=always writes docs/src/sonar_model.svg");
}
