//! Tests properties that hold for every text.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::super::brackets::{MAX_DEPTH, balance};
use super::super::format;
use super::super::lexer::lex;
use super::super::source::FileText;
use super::super::token::Tok;
use super::{Arena, outline, parse};
use crate::diagnostic::{SourceId, Sources};

/// Seed of all random tests here, so that a failure repeats; `PROPTEST_RNG_SEED` overrides it.
const SEED: u64 = 2003;

/// Pieces of plans.
const PIECES: &[&str] = &[
    "{",
    "}",
    "(",
    ")",
    "\\{",
    "$",
    ";",
    ",",
    ":",
    "^",
    "=",
    "==",
    "<",
    "≤",
    "\\geq",
    "[",
    "]",
    "Atom",
    "(Atom",
    "ExecPlan",
    "OR",
    "and",
    "NOT",
    "RISING",
    "use",
    "null",
    "module",
    "after",
    "FRAME",
    "sigma_null",
    "Γ_a^b",
    "\\Gamma_{a}^{b}",
    "A",
    "wait",
    "5",
    "0100",
    "5cm/s",
    "5 cm/s",
    "5x",
    "5-3",
    "inf",
    "∞",
    "\"a\"",
    "\"a",
    "/*",
    "*/",
    "//",
    "/// doc\n",
    "\n",
    "\\text{",
    "\\\\",
    "\\alpha",
    "@",
    "é",
    "{ A",
    "(bumper)",
    "(Atom (bumper) stop)",
    "f(",
    "ExecPlan 3 {",
    "s1:",
];

fn soup() -> impl Strategy<Value = String> {
    let piece = (proptest::sample::select(PIECES), any::<bool>());
    proptest::collection::vec(piece, 0..60).prop_map(|pieces| {
        pieces.into_iter().map(|(piece, blank)| format!("{piece}{}", if blank { " " } else { "" })).collect()
    })
}

/// Returns the configuration of each test, and prints the seed, which the output of a failed test shows.
pub(super) fn config() -> ProptestConfig {
    let default = ProptestConfig::default();
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(SEED),
        named @ RngSeed::Fixed(_) => named,
    };
    println!("PROPTEST_RNG_SEED={rng_seed}");
    ProptestConfig { cases: 400, failure_persistence: None, rng_seed, ..default }
}

/// Parses a text, renders all its messages, and checks them.
fn reads(text: &str) {
    let mut sources = Sources::default();
    sources.add("before.mdle", "Γ");
    let id = sources.add("plan.mdle", text);
    let arena = Arena::new();
    let (file, diagnostics) = parse(id, text, &arena);
    let _ = outline(&file);
    // A brace can cause two messages: it is not closed, and its plan has no name.
    assert!(diagnostics.len() <= 2 * text.len() + 1);
    assert!(!file.plans.is_empty() || !diagnostics.is_empty());
    assert!(diagnostics.is_sorted_by_key(|found| found.span()));
    for found in &diagnostics {
        assert!(!found.message.is_empty());
        for label in &found.labels {
            assert!(text.get(label.span.within(id)).is_some(), "{found:?}");
        }
        let _ = sources.render(found);
    }
    match format(id, text) {
        Ok(formatted) => {
            assert_eq!(outline(&parse(id, &formatted, &Arena::new()).0), outline(&file), "{formatted}");
            assert_eq!(format(id, &formatted).as_ref(), Ok(&formatted));
        }
        Err(found) => assert_eq!(found, diagnostics),
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn token_soup_is_read(text in soup()) {
        reads(&text);
    }

    #[test]
    fn any_text_is_read(text in any::<String>()) {
        reads(&text);
    }

    #[test]
    fn any_bytes_are_read(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        reads(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn brackets_match_after_the_pass(text in soup()) {
        let source = FileText { id: SourceId(0), text: &text };
        let balanced = balance(source, &lex(source));
        let mut open = Vec::new();
        for (at, token) in balanced.tokens.iter().enumerate() {
            #[allow(clippy::wildcard_enum_match_arm, reason = "only brackets are looked at")]
            match token.kind {
                Tok::LBrace => open.push((at, Tok::RBrace)),
                Tok::LParen | Tok::TouchParen => open.push((at, Tok::RParen)),
                closer @ (Tok::RBrace | Tok::RParen) => prop_assert_eq!(open.pop().map(|(_, closer)| closer), Some(closer)),
                Tok::Atom => {
                    let around = open.iter().rev().take_while(|(_, closer)| *closer == Tok::RParen);
                    let atoms = around.filter(|(opener, _)| balanced.tokens[opener + 1].kind == Tok::Atom);
                    prop_assert_eq!(atoms.count(), 1);
                }
                _ => {}
            }
            prop_assert!(open.len() <= MAX_DEPTH);
        }
        prop_assert!(open.is_empty());
    }

    /// Checks that an error in one atom is reported once and does not affect the other elements.
    #[test]
    fn one_broken_atom_is_one_message(piece in proptest::sample::select(&["=", ":", "^", "==", "[", "]", "use", "FRAME", "7x", "@", "Γ_a", ","][..]), place in 0_usize..6) {
        let mut atom = ["(Atom", "(", "wait 5", ")", "(go 5 0)", ")"].map(str::to_owned);
        atom[place].push_str(&format!(" {piece} "));
        let text = format!("{{ A (bumper) (Atom (b) u) {} (Atom (b) u) ExecPlan 2 {{ B }} }}", atom.concat());
        let arena = Arena::new();
        let (file, diagnostics) = parse(SourceId(0), &text, &arena);
        prop_assert!(diagnostics.len() <= 1, "{}", super::one(&text));
        prop_assert!(file.plans.len() == 1 && file.plans[0].elements.len() >= 4);
    }
}

#[test]
fn a_hundred_thousand_elements_are_read() {
    let text = format!("{{ A (bumper) {} }}", "(Atom (wait 5) stop) ".repeat(100_000));
    let arena = Arena::new();
    let (file, diagnostics) = parse(SourceId(0), &text, &arena);
    assert_eq!(diagnostics, []);
    assert_eq!(file.plans[0].elements.len(), 100_000);
}

#[test]
fn long_words_and_comments_take_no_stack() {
    let long = "x".repeat(4_000_000);
    let texts = [
        format!("// {long}\n{{ P (Atom (null) stop) }}"),
        format!("{}{{ P (Atom (null) stop) }}", "// a line\n".repeat(400_000)),
        format!("{}{{ P (Atom (null) stop) }}", "/* a */ ".repeat(500_000)),
        format!("{}{{ P (Atom (null) stop) }}", r"\\ ".repeat(1_000_000)),
        format!("/// {long}\n{{ P (Atom (null) stop) }}"),
        format!("/* {long} */{{ P (Atom (null) stop) }}"),
        format!("{{ P{}(Atom (null) stop) }}", " ;\n".repeat(1_000_000)),
        format!("{{ {long} (Atom (null) stop) }}"),
        format!("{{ P (Atom (wait {}) stop) }}", "7".repeat(4_000_000)),
        format!("{{ P (Atom (null) (path \"{long}\")) }}"),
    ];
    // Half of the stack that a thread has by default.
    let thread = std::thread::Builder::new()
        .stack_size(1 << 20)
        .spawn(move || texts.map(|text| lex(FileText::new(SourceId(0), &text)).tokens.len()));
    assert_eq!(thread.unwrap().join().unwrap(), [10, 10, 10, 10, 10, 10, 10, 10, 11, 13]);
}
