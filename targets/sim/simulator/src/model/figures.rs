//! Numerical values in the models of bodies, with their sources.

use mdle_runtime::{Nanos, Radians, SonarId};

use crate::battery::Pack;
use crate::footprint::Form;

use super::{Drive, FiringOrder, HALF_CONE, Hearing, Model, Slip, Transducer};

const INCH: f64 = 0.0254;
/// Usual firing order of a Scout's sonars.
const SCOUT_ORDER: [usize; 16] = [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8];
/// Radius of a Scout's ring of sonars, in metres.
const RING_RADIUS: f64 = 0.19;
/// Distance of an ATRV-mini's sonars from its centre, as laws assume it, in metres.
const ATRV_RING_RADIUS: f64 = 0.28;

pub(super) fn ideal() -> Model {
    let transducers = (0..16).map(|number| {
        let sonar = SonarId::new(number);
        let (sin, cos) = libm::sincos(sonar.bearing().0);
        Transducer::at((RING_RADIUS * cos, RING_RADIUS * sin), sonar.bearing(), sonar, RING_RADIUS)
    });
    Model {
        drive: Drive {
            form: Form::SCOUT,
            wheel_base: 0.34519,
            fastest: 1.0,
            acceleration: 1.0,
            // A tenth of an inch per second.
            unit: 0.1 * INCH,
            slip: None,
        },
        hearing: Hearing {
            transducers: transducers.collect(),
            ring_radius: RING_RADIUS,
            beside_apart: None,
            half_cone: HALF_CONE,
            lobe: None,
            facing: None,
            least: 0.0,
            most: 6.477,
            step: 0.0,
            spread: 0.015,
            scale: 0.0,
            fading: 0.0,
            misses: 0.01,
            outliers: 0.0,
            order: None,
        },
        switches: 6,
        pack: Pack::SCOUT,
    }
}

/// Returns the model of a Scout. In measurements (Cao and Borenstein, 2002), a Polaroid module detected a flat wall up
/// to 42° off the wall's normal. It detected an object that faces the module up to about half of this angle off the
/// axis, and a thin cylinder less far. Both limits lie on an ellipse: 21² + 35² = 41². Ranges have errors of at most 3
/// cm, so the standard deviation is a third of that; their absolute error is at most 1 %.
pub(super) fn scout() -> Model {
    let ideal = ideal();
    Model {
        drive: Drive {
            // Two degrees and 2 % on a tour of 25 m.
            slip: Some(Slip { way: 0.01, turn: 0.005, bend: 0.0015, wander: 0.006 }),
            ..ideal.drive
        },
        hearing: Hearing {
            half_cone: Radians::from_degrees(21.0),
            lobe: Some(Radians::from_degrees(21.0)),
            facing: Some(Radians::from_degrees(35.0)),
            least: 6.0 * INCH,
            most: 255.0 * INCH,
            step: INCH,
            spread: 0.01,
            scale: 0.01,
            fading: 0.1,
            misses: 0.01,
            outliers: 0.005,
            order: Some(FiringOrder {
                groups: SCOUT_ORDER.iter().map(|number| vec![*number]).collect(),
                gap: Nanos(60_000_000),
            }),
            ..ideal.hearing
        },
        switches: 6,
        pack: Pack::SCOUT,
    }
}

/// Positions in millimetres, and axes in degrees, of the first twelve of the 24 sonars of the ATRV-mini of the
/// University of Massachusetts, each with the sonar of the paper to which it belongs. The other twelve sonars are
/// mirror images of these.
const ATRV_LEFT: [(f64, f64, f64, u8); 12] = [
    (258.17, 114.70, 0.0, 0),
    (252.24, 152.17, 18.0, 1),
    (235.01, 185.98, 36.0, 2),
    (208.19, 212.81, 54.0, 2),
    (174.38, 230.03, 72.0, 3),
    (136.91, 235.97, 90.0, 4),
    (-258.17, 114.70, 180.0, 8),
    (-252.24, 152.17, 162.0, 7),
    (-235.01, 185.98, 144.0, 6),
    (-208.19, 212.81, 126.0, 6),
    (-174.38, 230.03, 108.0, 5),
    (-136.91, 235.97, 90.0, 4),
];

pub(super) fn atrv() -> Model {
    let scout = scout();
    let left = ATRV_LEFT.map(|(x, y, degrees, sonar)| {
        let place = (x / 1000.0, y / 1000.0);
        Transducer::at(place, Radians::from_degrees(degrees), SonarId::new(sonar), ATRV_RING_RADIUS)
    });
    let right = left.map(|Transducer { x, y, bearing, sonar, .. }| {
        let sonar = SonarId::new(16 - sonar.number() as u8);
        Transducer::at((x, -y), Radians(-bearing.0), sonar, ATRV_RING_RADIUS)
    });
    Model {
        drive: Drive {
            form: Form::Rectangle { half_length: 0.315, half_width: 0.27 },
            wheel_base: 0.4,
            fastest: 1.2,
            acceleration: 1.0,
            unit: 1e-4,
            // Four wheels that skid in every turn.
            slip: Some(Slip { way: 0.01, turn: 0.02, bend: 0.003, wander: 0.01 }),
        },
        hearing: Hearing {
            transducers: left.into_iter().chain(right).collect(),
            ring_radius: ATRV_RING_RADIUS,
            // Points heard by the two sonars at 18° from the wall's normal; these sonars are 35 cm apart.
            beside_apart: Some(0.33),
            most: 4.0,
            // One count of the controller's clock.
            step: 1.0 / 1550.0,
            // All four boards ping at once; each board fires its six sonars one after another, 30 ms apart.
            order: Some(FiringOrder {
                groups: (0..6).map(|channel| vec![channel, channel + 6, channel + 12, channel + 18]).collect(),
                gap: Nanos(30_000_000),
            }),
            ..scout.hearing
        },
        switches: 2,
        pack: Pack::ATRV,
    }
}
