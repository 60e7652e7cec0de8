//! Tests the names in an emitted file and in bindings of an alphabet: no name hides another one, whatever plans and
//! quarks are called.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use mdle_compiler::rust::{bind, plan_type};
use mdle_tests::emission::{alphabet, emitted, emitted_for};

#[test]
fn names_keep_their_words_and_are_always_names() {
    assert_eq!(["leg_2", "a_leg", "_leg", "2"].map(plan_type), ["Leg2", "ALeg", "Leg", "P2"]);
    let rust = emitted(
        "{ Main (a) { leg2 (b) (Atom (c) idle) } { _Leg (b) (Atom (c) idle) } { Ändern (b) (Atom (c) idle) } }",
    );
    for function in ["fn leg2(", "fn leg(", "fn uc4ndern("] {
        assert!(rust.contains(function), "{function} in {rust}");
    }
}

#[test]
fn declarations_of_one_name_are_numbered_from_two() {
    let alphabet = alphabet(
        "interrupt a; control go(to: length m); control go(to: module); control go(v: length m, w: length m);",
    );
    let rust = emitted_for(&alphabet, "{ Main (Atom (a) go 1) (Atom (a) go(x module)) (Atom (a) go 1 2) }");
    for constant in ["GO_1: robot::Go =", "GO_X_MODULE: robot::Go2 =", "GO_1_2: robot::Go3 ="] {
        assert!(rust.contains(constant), "{constant} in {rust}");
    }
}

#[test]
fn a_quark_may_be_called_as_any_constant_of_the_file_is() {
    let constants = |rust: &str| {
        let declared = rust.split(" const ").skip(1).filter_map(|constant| constant.split_once(": "));
        let names = declared.map(|(name, _)| name.to_owned());
        // `const fn` does not declare a constant.
        names.filter(|name| !name.contains('(')).collect::<Vec<_>>()
    };
    let own = constants(&emitted("{ Main (Atom (wait 1) idle) }"));
    let own: Vec<_> = own.into_iter().filter(|name| name != "IDLE").map(|name| name.to_lowercase()).collect();
    assert!(["fsm", "laws", "conditions", "names"].iter().all(|name| own.iter().any(|own| own == name)), "{own:?}");
    let declarations: String = own.iter().map(|name| format!("interrupt {name}; ")).collect();
    let alphabet = alphabet(&format!("{declarations} control stop;"));
    let mut all = constants(&emitted_for(&alphabet, &format!("{{ Main (Atom ({}) stop) }}", own.join(" OR "))));
    assert_eq!(all.len(), 2 * own.len() + 1);
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 2 * own.len() + 1, "{all:?}");
}

/// Returns the names of functions, arguments and variables in a file that a scope could have as well.
fn names_of_its_own(rust: &str) -> Vec<&str> {
    // More deeply indented functions are methods, which hide no other name.
    let functions = rust.lines().filter_map(|line| line.strip_prefix("    fn ")?.split('(').next());
    let arguments = rust.split("fn ").skip(1).filter_map(|function| function.split_once('(')?.1.split(')').next());
    let arguments =
        arguments.flat_map(|arguments| arguments.split(',')).filter_map(|argument| argument.split_once(": "));
    let laws = rust.split("Running::Atom").skip(1).filter_map(|arm| arm.split_once('(')?.1.split(')').next());
    let names = functions.chain(arguments.map(|(name, _)| name.trim())).chain(laws);
    let mut names: Vec<_> = names.filter(|name| name.chars().all(|letter| letter.is_ascii_lowercase())).collect();
    names.sort();
    names.dedup();
    names
}

#[test]
fn a_scope_may_be_called_as_anything_in_its_file_is() {
    let rust = emitted("{ Main (Atom (a) seek) (Atom (b) idle) }");
    let own = names_of_its_own(&rust);
    for name in ["begin", "cursor", "law", "scope", "t", "tell", "y"] {
        assert!(own.contains(&name), "{name} is one of {own:?}");
    }
    for name in own.into_iter().chain(["gen", "fn"]) {
        let rust = emitted(&format!("{{ Main (Atom (a) seek) {{ {name} (b) (Atom (c) idle) }} }}"));
        assert!(!rust.contains(&format!("fn {name}(cursor")), "{name} in {rust}");
    }
}

/// Returns the text of a file without the lines that are comments.
fn code(rust: &str) -> String {
    let lines = rust.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the names of types in a file, and other names in the same style, where they occur without a path.
fn types(code: &str) -> BTreeSet<&str> {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    // A word in capital letters only is a constant.
    let is_type = |word: &str| {
        word.starts_with(|letter: char| letter.is_ascii_uppercase())
            && word.contains(|letter: char| letter.is_lowercase())
    };
    // A path precedes the name, or it is an associated type of the trait.
    let is_found_elsewhere = |before: &str| before.ends_with("::") || before.ends_with("type ");
    let mut types = BTreeSet::new();
    let mut place = 0;
    for word in code.split(|letter| !is_part(letter)) {
        if is_type(word) && !is_found_elsewhere(&code[..place]) {
            types.insert(word);
        }
        place += word.len() + code[place + word.len()..].chars().next().map_or(0, char::len_utf8);
    }
    types
}

#[test]
fn a_plan_may_be_called_as_any_type_that_its_file_uses() {
    let code = code(&emitted("{ Main (Atom (a) seek)^2 }"));
    // Elsewhere, variants are always written with their enum.
    let (start, rest) = code.split_once("enum Running {").expect("the laws");
    let code = format!("{start} Running {}", rest.split_once('}').expect("their end").1);
    let types = types(&code);
    assert!(types.contains("Running") && types.contains("Nanos"), "{types:?}");
    for name in types.into_iter().filter(|name| *name != "Main") {
        assert!(plan_type(name) != name, "{name}");
    }
    for name in ["Plan", "Self", "Option", "Some", "None"] {
        assert_eq!(plan_type(name), format!("{name}Plan"), "what Rust or the runtime calls so keeps its name");
    }
}

#[test]
fn a_quark_may_be_called_as_any_type_that_a_bound_alphabet_uses() {
    let bound =
        |quark: &str| bind(&alphabet(&format!("interrupt {quark}; signal x unit m tolerance 1; control halt;")));
    let code = code(&bound("a"));
    let mut types = types(&code);
    let declared = include_str!("../../runtime/core/src/alphabet.rs").split_once("macro_rules! alphabet").unwrap().1;
    let declared = ["pub enum ", "pub struct "].iter().flat_map(|item| declared.split(item).skip(1));
    types.extend(declared.filter_map(|item| item.split([' ', ';']).next()));
    assert!(types.contains("AnyLaw") && types.contains("Alphabet") && types.contains("None"), "{types:?}");
    for name in types.into_iter().filter(|name| *name != "Halt") {
        assert!(bound(name).contains(&format!("{name}Quark::new()")), "{name}");
    }
}
