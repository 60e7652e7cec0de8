//! Tests that the errors of the bearing of a source are as small as the book promises, for many bearings, places and
//! sounds.
#![allow(clippy::print_stdout, clippy::expect_used, reason = "a test prints its table, and fails by panicking")]

use mdle_sound::{
    EarPose, Ears, Estimator, RADIUS, RatioGate, SoundKind, SoundRoom, SoundSource, SphericalHead, WINDOW,
};

/// Floor of the room, in metres.
const FLOOR: (f64, f64) = (7.0, 6.0);
/// Places of the head in the room, in metres.
const PLACES: [(f64, f64); 3] = [(2.6, 2.3), (3.0, 3.2), (4.1, 3.4)];
/// Number of windows for each bearing and place, after a first window in which the room fills with sound.
const WINDOWS: usize = 20;

/// A room, the distance of the source, the kind of its sound, and the level of the sound relative to the noise in dB.
#[derive(Debug, Clone, Copy)]
struct Case {
    t60: f64,
    distance: f64,
    kind: SoundKind,
    level: f64,
}

/// Returns the root mean square error of the estimates that are kept, in degrees, and the part of the windows whose
/// estimates are kept.
fn judged(case: Case, places: &[(f64, f64)]) -> (f64, f64) {
    let (head, estimator) = (SphericalHead::new(RADIUS), Estimator::new(RADIUS));
    let room = if case.t60 > 0.0 { SoundRoom::new((0.0, 0.0), FLOOR, case.t60) } else { SoundRoom::open() };
    let (mut squares, mut kept, mut all) = (0.0, 0, 0);
    for (seed, place) in (1_u32..).zip(places) {
        for bearing in (-80_i32..=80).step_by(20) {
            let angle = f64::from(bearing).to_radians();
            let heading = 0.3 * f64::from(seed);
            let (sin, cos) = libm::sincos(heading + angle);
            let at = (place.0 + case.distance * cos, place.1 + case.distance * sin);
            assert!((0.0..FLOOR.0).contains(&at.0) && (0.0..FLOOR.1).contains(&at.1), "{at:?}");
            let source = SoundSource { at, kind: case.kind, level: 0.0 };
            let ears = Ears::new(head.clone(), room, &[source], u64::from(seed * 1000 + bearing.unsigned_abs()));
            let here = EarPose { at: *place, heading };
            let mut gate = RatioGate::default();
            for window in noisy(ears, &head, &here, case.level).chunks(WINDOW).skip(1) {
                all += 1;
                let estimate = estimator.estimate(window).expect("a sound");
                if gate.keeps(&estimate, 0.1) {
                    kept += 1;
                    let error = (estimate.angle - angle).to_degrees();
                    squares += error * error;
                }
            }
        }
    }
    ((squares / f64::from(kept)).sqrt(), f64::from(kept) / f64::from(all))
}

/// Returns the signals of both ears at this pose, with noise that is quieter than their sound by `level` dB.
fn noisy(ears: Ears, head: &SphericalHead, here: &EarPose, level: f64) -> Vec<[f32; 2]> {
    let (mut samples, mut noise) = (Vec::new(), Vec::new());
    ears.with_noise(0.0).hear(here, (WINDOWS + 1) * WINDOW, &mut samples);
    Ears::new(head.clone(), SoundRoom::open(), &[], 7).hear(here, samples.len(), &mut noise);
    let square: f32 = samples.iter().map(|[left, right]| left * left + right * right).sum();
    let loudness = (square / (2 * samples.len()) as f32).sqrt() * libm::powf(10.0, -level as f32 / 20.0);
    samples.iter().zip(&noise).map(|(one, noise)| [0, 1].map(|ear| one[ear] + loudness * noise[ear])).collect()
}

/// Prints the error and the part that is kept, and asserts that the error is at most `degrees` and the part at least
/// `part`.
fn errs_at_most(case: Case, degrees: f64, part: f64) {
    let (error, kept) = judged(case, &PLACES);
    println!("{case:?}: {error:.1}°, {:.0} % kept", 100.0 * kept);
    assert!(error <= degrees && kept >= part, "{case:?}: {error}° of {kept}");
}

#[test]
fn bearings_err_by_five_degrees_at_most() {
    for t60 in [0.24, 0.34] {
        for kind in [SoundKind::White, SoundKind::Speech] {
            errs_at_most(Case { t60, distance: 2.0, kind, level: 10.0 }, 5.0, 0.3);
        }
    }
}

#[test]
fn bearings_in_open_air_err_less() {
    for level in [0.0, 10.0] {
        errs_at_most(Case { t60: 0.0, distance: 2.0, kind: SoundKind::Speech, level }, 2.0, 0.6);
    }
}

#[test]
fn noise_as_loud_as_speech_costs_estimates_in_a_room() {
    errs_at_most(Case { t60: 0.24, distance: 2.0, kind: SoundKind::Speech, level: 0.0 }, 7.0, 0.1);
}

/// Returns the mean error of the estimates for a source at this bearing in open air without noise, in degrees.
fn bias(radius: f64, kind: SoundKind, bearing: i32) -> f64 {
    let (sin, cos) = libm::sincos(f64::from(bearing).to_radians());
    let source = SoundSource { at: (2.0 * cos, 2.0 * sin), kind, level: 0.0 };
    let ears = Ears::new(SphericalHead::new(radius), SoundRoom::open(), &[source], 5);
    let mut samples = Vec::new();
    ears.with_noise(0.0).hear(&EarPose { at: (0.0, 0.0), heading: 0.0 }, WINDOWS * WINDOW, &mut samples);
    let estimator = Estimator::new(radius);
    let estimates = samples.chunks(WINDOW).skip(1).filter_map(|window| estimator.estimate(window));
    let angles: Vec<f64> = estimates.filter(|estimate| estimate.ratio > 5.0).map(|estimate| estimate.angle).collect();
    assert!(!angles.is_empty(), "{radius} {kind:?} {bearing}");
    (angles.iter().sum::<f64>() / angles.len() as f64).to_degrees() - f64::from(bearing)
}

#[test]
fn equation_7_fits_heads_of_many_radii() {
    for radius in [0.07, RADIUS, 0.12, 0.15, 0.2, 0.3] {
        for kind in [SoundKind::White, SoundKind::Speech] {
            let biases = [10, 20, 40, 60, 80].map(|bearing| bias(radius, kind, bearing));
            println!("{radius} m, {kind:?}: {biases:.1?}");
            assert!(
                biases.iter().zip([0.3, 0.6, 1.0, 1.3, 3.0]).all(|(bias, limit)| bias.abs() <= limit),
                "{biases:?}"
            );
        }
    }
}
