//! The colours of a plot: atoms that follow each other can be told apart by everybody, those who see no red or green too.

pub(super) const INK: &str = "#262b33";
/// For what is written on light colours.
const DARK: &str = "#14171c";
pub(super) const WHITE: &str = "#ffffff";
pub(super) const FAINT: &str = "#7a828e";
pub(super) const GRID: &str = "#eceef2";
pub(super) const BOX: &str = "#cdd1d8";
pub(super) const ECHO: &str = "#8a97a8";
pub(super) const CONTACT: &str = "#c00020";
pub(super) const GOAL: &str = "#e3f1e8";

/// The colours of the atoms, over and over, each with what can be read on it.
const COLOURS: [(&str, &str); 8] = [
    ("#0072b2", WHITE),
    ("#e69f00", DARK),
    ("#882255", WHITE),
    ("#c44e00", WHITE),
    ("#00805e", WHITE),
    ("#56b4e9", DARK),
    ("#332288", WHITE),
    ("#5f5f5f", WHITE),
];

/// The colour of the atom that began as this number, from 0.
pub(super) fn of(number: usize) -> &'static str {
    COLOURS[number % COLOURS.len()].0
}

/// What can be read on it.
pub(super) fn on(number: usize) -> &'static str {
    COLOURS[number % COLOURS.len()].1
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rgb = [f64; 3];

    /// What becomes of linear RGB in an eye: of most people, and without red, green or blue cones (Machado, Oliveira and
    /// Fernandes, 2009, severity 1).
    const EYES: [[Rgb; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    fn linear(colour: &str) -> Rgb {
        [1, 3, 5].map(|at| {
            let part = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { libm::pow((part + 0.055) / 1.055, 2.4) }
        })
    }

    fn times(row: &Rgb, rgb: &Rgb) -> f64 {
        row.iter().zip(rgb).map(|(one, other)| one * other).sum()
    }

    fn luminance(rgb: &Rgb) -> f64 {
        times(&[0.2126, 0.7152, 0.0722], rgb)
    }

    /// Lightness and the two opponent colours (CIE 1976), in which distances are about as they are seen.
    fn lab(rgb: &Rgb) -> Rgb {
        let part = |row: Rgb, white: f64| {
            let part = times(&row, rgb) / white;
            if part > 0.008856 { libm::cbrt(part) } else { 7.787 * part + 16.0 / 116.0 }
        };
        let x = part([0.4124, 0.3576, 0.1805], 0.9505);
        let y = part([0.2126, 0.7152, 0.0722], 1.0);
        let z = part([0.0193, 0.1192, 0.9505], 1.089);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn atoms_that_follow_each_other_look_different_in_every_eye() {
        for number in 0..COLOURS.len() {
            for eye in &EYES {
                let seen = |number| {
                    let rgb = linear(of(number));
                    lab(&[0, 1, 2].map(|row: usize| times(&eye[row], &rgb).clamp(0.0, 1.0)))
                };
                let (one, other) = (seen(number), seen(number + 1));
                let apart = libm::sqrt(one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum());
                assert!(apart > 25.0, "{} and {}: {apart}", of(number), of(number + 1));
            }
        }
    }

    #[test]
    fn numbers_can_be_read_on_every_colour() {
        for number in 0..COLOURS.len() {
            let [one, other] = [of(number), on(number)].map(|colour| luminance(&linear(colour)));
            let contrast = (one.max(other) + 0.05) / (one.min(other) + 0.05);
            assert!(contrast >= 4.5, "{}: {contrast}", of(number));
        }
    }
}
