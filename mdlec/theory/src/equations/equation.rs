//! Prints the transition matrices of a small plan in the paper's notation: `Π(t) = E_1 ξ̄_1(t) + …`, as in Eq. 6 of the
//! paper.

use super::terms::{Extent, Term, Terms};

/// Maximum number of states whose matrices are printed in the paper's notation; larger matrices do not fit into a line.
const STATES: usize = 16;
/// Maximum length of a line, in characters.
const WIDTH: usize = 100;

/// Returns the equation and the meaning of its symbols; `None` if the plan has so many states that the matrices would
/// not be readable.
#[must_use]
pub fn equation(terms: &Terms<'_>) -> Option<String> {
    (terms.states() <= STATES).then(|| format!("{}\n{}", sum(terms), symbols(terms)))
}

/// Returns the maximum number of states for which [`equation`] prints matrices.
#[must_use]
pub fn most_states() -> usize {
    STATES
}

/// Returns the sum of all terms, with as many terms in each line as fit.
fn sum(terms: &Terms<'_>) -> String {
    let (height, middle) = (terms.states(), terms.states() / 2);
    if terms.live.is_empty() {
        return "Π(t) = 0\n".into();
    }
    let mut text = String::new();
    let mut lines = vec![String::new(); height];
    for (number, term) in terms.live.iter().enumerate() {
        let sign = if number == 0 { "Π(t) = " } else { " + " };
        let block = block(terms, term);
        let wide = block.iter().map(|line| width(line)).max().unwrap_or(0) + width(sign);
        if number > 0 && lines.iter().map(|line| width(line)).max().unwrap_or(0) + wide > WIDTH {
            text += &written(&lines);
            text.push('\n');
            lines = vec![" ".repeat(4); height];
        }
        let so_far = lines.iter().map(|line| width(line)).max().unwrap_or(0);
        for (row, (line, part)) in lines.iter_mut().zip(block).enumerate() {
            let sign = if row == middle { sign.to_owned() } else { " ".repeat(width(sign)) };
            *line += &format!("{}{sign}{part}", " ".repeat(so_far - width(line)));
        }
    }
    text + &written(&lines)
}

/// Returns the lines of a matrix in brackets, with the matrix's interrupt after the middle row.
fn block(terms: &Terms<'_>, term: &Term<'_>) -> Vec<String> {
    let (matrix, last) = (terms.matrix(term), terms.states() - 1);
    let rows = (0..=last).map(|row| {
        let entries: Vec<_> = matrix.iter().map(|one| if *one == row { "1" } else { "0" }).collect();
        let (open, close) = match row {
            0 => ('⎡', '⎤'),
            row if row == last => ('⎣', '⎦'),
            _ => ('⎢', '⎥'),
        };
        let symbol = if row == terms.states() / 2 { format!(" {}(t)", complement(&term.name)) } else { String::new() };
        format!("{open}{}{close}{symbol}", entries.join(" "))
    });
    rows.collect()
}

fn written(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// Returns the width of a text in columns; a bar over a letter needs no column of its own.
fn width(text: &str) -> usize {
    text.chars().filter(|letter| *letter != '\u{304}').count()
}

/// Returns the symbol of an interrupt: `ξ2` for `x2`.
fn symbol(name: &str) -> String {
    name.strip_prefix('x').map_or_else(|| format!("ξ_{name}"), |number| format!("ξ{number}"))
}

/// Returns the symbol of an interrupt's complement, `ξ̄2` for `x2`, which is 1 when the interrupt has fired.
fn complement(name: &str) -> String {
    symbol(name).replacen('ξ', "ξ\u{304}", 1)
}

/// Returns the text that explains the symbols.
fn symbols(terms: &Terms<'_>) -> String {
    let mut text = "where the state is one of\n".to_owned();
    let states = terms.laws.iter().copied().chain(["the plan is over"]);
    let states: Vec<_> = (1..).zip(states).map(|(number, law)| (format!("e{number}"), law.to_owned())).collect();
    text += &table(&states);
    if !terms.live.is_empty() {
        text += "and the complement of an interrupt is 1 when it has fired:\n";
        text += &interrupts(&terms.live, terms.combined);
    }
    if !terms.never.is_empty() {
        text += "These never fire, so that their terms are 0:\n";
        text += &interrupts(&terms.never, false);
    }
    if terms.combined {
        text += "An interrupt in several places is counted once (Eq. 3). Of those that fire at once, the one with the lowest \
                 number\nat the state (in parentheses) decides.\n";
        if is_kept_apart(&terms.live) {
            text += "A timer counts from the start of its own scope, so that equal ones are kept apart.\n";
        }
    } else {
        text += "Of those that fire at once, the one with the lowest number decides.\n";
    }
    text
}

/// Returns `true` if several terms have the same text, but are not combined because their interrupts have timers.
fn is_kept_apart(terms: &[Term<'_>]) -> bool {
    let mut texts: Vec<_> = terms.iter().filter(|term| term.waits).map(|term| term.text).collect();
    texts.sort_unstable();
    texts.windows(2).any(|pair| pair.first() == pair.last())
}

fn interrupts(terms: &[Term<'_>], numbered: bool) -> String {
    let rows = terms.iter().map(|term| {
        let is_own = term.name == "completed";
        let places: Vec<_> = term.places.iter().map(|place| states(place, numbered || is_own)).collect();
        let what = if is_own { "the law is done" } else { term.text };
        (symbol(&term.name), format!("{what}, at {}", places.join(", ")))
    });
    table(&rows.collect::<Vec<_>>())
}

/// Returns the states of a scope as text, with the scope's name and, if `numbered` is `true`, the number of its
/// interrupt.
fn states(place: &Extent<'_>, numbered: bool) -> String {
    let states = if place.first == place.last {
        format!("e{}", place.first + 1)
    } else {
        format!("e{}…e{}", place.first + 1, place.last + 1)
    };
    match (place.scope, numbered) {
        ("", false) => states,
        ("", true) => format!("{states} ({})", place.number),
        (scope, false) => format!("{states} of {scope}"),
        (scope, true) => format!("{states} of {scope} ({})", place.number),
    }
}

fn table(rows: &[(String, String)]) -> String {
    let wide = rows.iter().map(|(name, _)| width(name)).max().unwrap_or(0);
    rows.iter().map(|(name, what)| format!("  {name:wide$}  {what}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::terms;
    use crate::samples::compiled;

    fn printed(text: &str, combined: bool) -> Option<String> {
        equation(&terms(&compiled(text)[0].nondegenerate, combined).unwrap())
    }

    /// In the string of Fig. 3, `((u1, ξ1)(u2, ξ2)(u1, ξ3))`, the first law occurs twice, and each occurrence is a
    /// state.
    #[test]
    fn the_string_of_figure_3_has_three_terms_of_four_states() {
        let text = "{ Fig3 (Atom (bumper) (go 20 0)) (Atom (atIsection 0100) (go 0 0.36)) (Atom (wait 7) (go 20 0)) }";
        insta::assert_snapshot!(printed(text, false).unwrap());
    }

    #[test]
    fn an_interrupt_that_is_counted_once_has_one_term() {
        let text =
            "{ P (wait 60) { Q (bumper) (Atom (wait 1) stop) (Atom (null) rotate 90) } (Atom (bumper) turn 90) }";
        insta::assert_snapshot!(printed(text, true).unwrap());
    }

    #[test]
    fn timers_of_two_scopes_are_kept_apart() {
        let plan = "{ P (Atom (wait 2) stop) { Q (wait 2) (Atom (bumper) stop) } (Atom (bumper) stop) }";
        let text = printed(plan, true).unwrap();
        assert!(text.contains("wait 2, at e1 (2)\n") && text.contains("wait 2, at e2 of Q (3)\n"), "{text}");
        assert!(text.contains("bumper, at e2 (4), e3 (5)\n"), "{text}");
        assert!(text.ends_with("equal ones are kept apart.\n"), "{text}");
    }

    #[test]
    fn a_plan_that_nothing_ends_has_the_sum_zero() {
        assert!(printed("{ P (Atom (null) stop) }", false).unwrap().starts_with("Π(t) = 0\n"));
    }

    #[test]
    fn more_states_than_sixteen_are_not_printed() {
        assert!(printed("{ P (Atom (wait 1) stop)^15 }", false).is_some());
        assert_eq!(printed("{ P (Atom (wait 1) stop)^16 }", false), None);
    }

    #[test]
    fn no_line_is_longer_than_the_limit() {
        let text = printed("{ P (Atom (wait 1) stop)^15 }", false).unwrap();
        assert!(text.lines().all(|line| width(line) <= WIDTH), "{text}");
    }
}
