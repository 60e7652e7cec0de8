//! Colours of a plot on light and on dark pages. Consecutive atoms have colours that everybody can distinguish,
//! including people who cannot see red or green.

use std::fmt::Write as _;

/// Colours of a picture.
struct Palette {
    ink: &'static str,
    faint: &'static str,
    paper: &'static str,
    grid: &'static str,
    /// Fill colour of boxes and discs.
    solid: &'static str,
    echo: &'static str,
    contact: &'static str,
    goal: &'static str,
    /// Fill colour of a charger's symbol.
    charge: &'static str,
    /// Colours of the atoms, which are used in rotation. Each has the colour for a number that is drawn on it.
    atoms: [(&'static str, &'static str); COUNT],
}

/// Number of colours of atoms.
const COUNT: usize = 8;

const LIGHT: Palette = Palette {
    ink: "#262b33",
    faint: "#6b7380",
    paper: "#ffffff",
    grid: "#eceef2",
    solid: "#cdd1d8",
    echo: "#8a97a8",
    contact: "#c00020",
    goal: "#e3f1e8",
    charge: "#ffd84d",
    atoms: [
        ("#0072b2", "#ffffff"),
        ("#e69f00", "#14171c"),
        ("#882255", "#ffffff"),
        ("#c44e00", "#ffffff"),
        ("#00805e", "#ffffff"),
        ("#56b4e9", "#14171c"),
        ("#332288", "#ffffff"),
        ("#5f5f5f", "#ffffff"),
    ],
};

const DARK: Palette = Palette {
    ink: "#e6e9ee",
    faint: "#9aa4b0",
    paper: "#14181d",
    grid: "#242a32",
    solid: "#3a434e",
    echo: "#7d8b9d",
    contact: "#ff5468",
    goal: "#1c3a29",
    charge: "#ffd84d",
    atoms: [
        ("#4aa3df", "#14171c"),
        ("#ff9a5c", "#14171c"),
        ("#a8dcff", "#14171c"),
        ("#f0b429", "#14171c"),
        ("#27a882", "#14171c"),
        ("#8f7ff5", "#14171c"),
        ("#c95fb0", "#14171c"),
        ("#c8c8c8", "#14171c"),
    ],
};

/// Returns the style class that gives an element the colour of this atom. `kind` is `way` for a line, `disc` for the
/// inside of a disc, and `on` for a number on a disc.
pub(super) fn class(kind: &str, atom: usize) -> String {
    format!("{kind}{}", atom % COUNT)
}

/// Returns the style sheet of a picture, for light and dark pages.
pub(super) fn style() -> String {
    format!("\n{}@media (prefers-color-scheme: dark) {{\n{}}}\n", rules(&LIGHT), rules(&DARK))
}

fn rules(palette: &Palette) -> String {
    let Palette { ink, faint, paper, grid, solid, echo, contact, goal, charge, atoms } = palette;
    let mut rules = format!(
        "text {{ fill: {ink} }}\n.quiet {{ fill: {faint} }}\n.paper {{ fill: {paper} }}\n.ink {{ stroke: {ink} }}\n\
         .faint {{ stroke: {faint} }}\n.grid {{ stroke: {grid} }}\n.shade {{ fill: {grid} }}\n.solid {{ fill: {solid} }}\n\
         .echo {{ stroke: {echo} }}\n.contact {{ stroke: {contact} }}\n.goal {{ fill: {goal} }}\n.charge {{ fill: {charge} }}\n.halo {{ stroke: {paper} }}\n"
    );
    for (number, (colour, on)) in atoms.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(
            rules,
            ".way{number} {{ stroke: {colour} }}\n.disc{number} {{ fill: {colour} }}\n.on{number} {{ fill: {on} }}"
        );
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rgb = [f64; 3];

    /// Matrices that convert linear RGB to perceived colours: for normal sight, and for people without red, green or
    /// blue cones (Machado, Oliveira and Fernandes, 2009, severity 1).
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

    /// Converts a colour to lightness and two opponent colours (CIE 1976). In this space, distances correspond
    /// approximately to perceived differences.
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

    fn contrast(one: &str, other: &str) -> f64 {
        let [one, other] = [one, other].map(|colour| luminance(&linear(colour)));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn atoms_that_follow_each_other_look_different_in_every_eye() {
        for palette in [&LIGHT, &DARK] {
            for (number, (one, _)) in palette.atoms.iter().enumerate() {
                let (other, _) = palette.atoms[(number + 1) % COUNT];
                for eye in &EYES {
                    let seen = |colour| {
                        let rgb = linear(colour);
                        lab(&[0, 1, 2].map(|row: usize| times(&eye[row], &rgb).clamp(0.0, 1.0)))
                    };
                    let (seen, beside) = (seen(one), seen(other));
                    let apart = seen.iter().zip(beside).map(|(one, other)| (one - other) * (one - other)).sum();
                    assert!(libm::sqrt(apart) > 25.0, "{one} and {other}: {}", libm::sqrt(apart));
                }
            }
        }
    }

    #[test]
    fn texts_and_numbers_can_be_read_on_their_ground() {
        for Palette { ink, faint, paper, grid, atoms, .. } in [&LIGHT, &DARK] {
            let texts = [(ink, paper), (faint, paper), (ink, grid)];
            for (text, ground) in texts.into_iter().chain(atoms.iter().map(|(disc, on)| (on, disc))) {
                assert!(contrast(text, ground) >= 4.5, "{text} on {ground}: {}", contrast(text, ground));
            }
        }
    }

    #[test]
    fn ways_and_signs_are_seen_on_the_floor() {
        for Palette { contact, paper, atoms, .. } in [&LIGHT, &DARK] {
            for colour in atoms.iter().map(|(colour, _)| colour).chain([contact]) {
                assert!(contrast(colour, paper) >= 2.0, "{colour}: {}", contrast(colour, paper));
            }
        }
    }
}
