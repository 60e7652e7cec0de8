//! Computes the reflections in a box-shaped room whose walls all reflect in the same way, by the method of image
//! sources (Allen and Berkley, 1979).

use crate::SPEED;

/// Height of the room, in metres.
const HEIGHT: f64 = 2.7;
/// Height of ears and sources above the floor, in metres. At a smaller height, the echo of the floor would arrive so
/// early that its delay would be as short as the delays between the ears.
const EARS: f64 = 1.2;
/// Distance of a source, in metres, below which its loudness no longer increases.
const NEAREST: f64 = 0.2;

/// Maximum number of reflections of a sound that is considered.
const ORDER: i32 = 5;

/// A room, or open air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoundRoom {
    /// Two opposite corners of the floor, in metres.
    corners: [(f64, f64); 2],
    /// Fraction of the pressure that a wall reflects.
    reflects: f64,
    /// Maximum length of the path of a sound that is considered, in metres; 0 in open air.
    longest: f64,
}

/// A source, or a mirror image of it in the walls, relative to a listener.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ImageSource {
    /// Vector from the listener, in metres.
    pub(crate) from: [f64; 3],
    pub(crate) distance: f64,
    /// Ratio of the pressure at the listener to the pressure at a distance of 1 m from the source.
    pub(crate) pressure: f64,
}

/// An image along one axis: the coordinate relative to the listener, and the number of reflections.
type Along = (f64, i32);

impl SoundRoom {
    /// Maximum reverberation time, in seconds.
    pub const T60_MOST: f64 = 0.5;

    /// Returns open air, in which nothing reflects.
    #[must_use]
    pub const fn open() -> Self {
        Self { corners: [(0.0, 0.0); 2], reflects: 0.0, longest: 0.0 }
    }

    /// Creates a room over the rectangle from `min` to `max`, in metres. Its reverberation time, in which sound falls
    /// by 60 dB by Eyring's formula, is `t60` seconds, but at most [`SoundRoom::T60_MOST`]. Sound that has been
    /// reflected more than five times is omitted, so the end of the reverberation is missing. If `t60` or a side is not
    /// above 0, returns open air.
    #[must_use]
    pub fn new(min: (f64, f64), max: (f64, f64), t60: f64) -> Self {
        let (width, depth) = (max.0 - min.0, max.1 - min.1);
        if t60.is_nan() || t60 <= 0.0 || width <= 0.0 || depth <= 0.0 {
            return Self::open();
        }
        let t60 = t60.min(Self::T60_MOST);
        let volume = width * depth * HEIGHT;
        let surface = 2.0 * (width * depth + width * HEIGHT + depth * HEIGHT);
        // Eyring's formula, solved for the part of the pressure that a wall reflects.
        let reflects = libm::exp(-0.161 * volume / (2.0 * surface * t60));
        Self { corners: [min, max], reflects, longest: SPEED * t60 / 2.0 }
    }

    /// Calls `visit` with each image of a source at `source` whose sound is considered at `here`, beginning with the
    /// source itself.
    pub(crate) fn images(&self, source: (f64, f64), here: (f64, f64), mut visit: impl FnMut(ImageSource)) {
        let direct = [source.0 - here.0, source.1 - here.1, 0.0];
        visit(self.image(direct, length(direct), 0));
        if self.longest <= 0.0 {
            return;
        }
        let [min, max] = self.corners;
        let along = [
            self.along(source.0 - min.0, here.0 - min.0, max.0 - min.0),
            self.along(source.1 - min.1, here.1 - min.1, max.1 - min.1),
            self.along(EARS, EARS, HEIGHT),
        ];
        let [xs, ys, zs] = &along;
        for (x, x_walls) in xs {
            for (y, y_walls) in ys.iter().filter(|(y, _)| libm::hypot(*x, *y) <= self.longest) {
                for (z, z_walls) in zs {
                    let (from, walls) = ([*x, *y, *z], x_walls + y_walls + z_walls);
                    let distance = length(from);
                    if (1..=ORDER).contains(&walls) && distance <= self.longest {
                        visit(self.image(from, distance, walls));
                    }
                }
            }
        }
    }

    fn image(&self, from: [f64; 3], distance: f64, walls: i32) -> ImageSource {
        let distance = distance.max(NEAREST);
        ImageSource { from, distance, pressure: libm::pow(self.reflects, f64::from(walls)) / distance }
    }

    /// Returns the images along an axis with one wall at 0 and another at `width`.
    fn along(&self, source: f64, here: f64, width: f64) -> Vec<Along> {
        let most = (libm::ceil(self.longest / (2.0 * width)) as i32).saturating_add(1);
        let pair = |number: i32| {
            let shift = 2.0 * f64::from(number) * width;
            [(shift + source - here, 2 * number.abs()), (shift - source - here, (2 * number - 1).abs())]
        };
        let all = (-most..=most).flat_map(pair);
        all.filter(|(place, _)| place.abs() <= self.longest).collect()
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    libm::sqrt(x * x + y * y + z * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn images(room: &SoundRoom) -> Vec<ImageSource> {
        let mut images = Vec::new();
        room.images((5.0, 3.0), (2.0, 3.0), |image| images.push(image));
        images
    }

    #[test]
    fn open_air_reflects_nothing() {
        let direct = ImageSource { from: [3.0, 0.0, 0.0], distance: 3.0, pressure: 1.0 / 3.0 };
        assert_eq!(images(&SoundRoom::open()), [direct]);
    }

    #[test]
    fn walls_are_mirrors() {
        let images = images(&SoundRoom::new((0.0, 0.0), (7.0, 6.0), 0.34));
        let has = |x: f64, y: f64, z: f64| {
            let near = |image: &&ImageSource| {
                libm::hypot(image.from[0] - x, image.from[1] - y) + (image.from[2] - z).abs() < 1e-9
            };
            images.iter().filter(near).count()
        };
        // The wall at x = 7 shows the source at 9, that at x = 0 at -5, the floor 2.4 m below.
        assert_eq!([has(7.0, 0.0, 0.0), has(-7.0, 0.0, 0.0), has(3.0, 0.0, -2.4), has(3.0, 0.0, 0.0)], [1; 4]);
    }

    #[test]
    fn reflections_of_the_reverberation_time_take_60_db() {
        let t60 = 0.34;
        let room = SoundRoom::new((0.0, 0.0), (7.0, 6.0), t60);
        // The mean free path is four times the volume divided by the surface.
        let surface = 2.0 * (42.0 + (7.0 + 6.0) * HEIGHT);
        let reflections = SPEED * t60 * surface / (4.0 * 42.0 * HEIGHT);
        let fall = -20.0 * reflections * libm::log10(room.reflects);
        assert!((fall - 60.0).abs() < 0.5, "{fall} dB");
    }

    #[test]
    fn a_room_without_an_inside_is_open_air() {
        for (max, t60) in [((0.0, 6.0), 0.3), ((7.0, 6.0), 0.0), ((7.0, 6.0), f64::NAN)] {
            assert_eq!(SoundRoom::new((0.0, 0.0), max, t60), SoundRoom::open());
        }
    }
}
