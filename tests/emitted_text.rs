//! What an emitted file says: names, arguments and conditions as their rules have them (`emitted.rs` says what it does).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_tests::pipeline::scripted;
use mdlec::alphabet::{Alphabet, combine, read};
use mdlec::diagnostic::SourceId;
use mdlec::rust::{Header, emit, plan_type};

fn emitted(plan: &str) -> String {
    emitted_for(scripted(), plan)
}

fn emitted_for(alphabet: &Alphabet, plan: &str) -> String {
    let (compiled, found) = mdlec::compile(SourceId(0), plan, alphabet, Some("Main"));
    let compiled = compiled.first().unwrap_or_else(|| panic!("{plan}: {found:?}"));
    emit(&compiled.lowered, Header { file: "plan.mdle", plan: "Main" }, alphabet)
}

/// The alphabet of a robot that has these quarks.
fn alphabet(declarations: &str) -> Alphabet {
    let text = format!("target t : crate t, period 1s; {declarations}");
    let (alphabet, found) = combine(read(SourceId(0), &text).0.expect("an alphabet"), &[]);
    assert_eq!(found, []);
    alphabet
}

/// The same as if it were one line: without white space, and without a comma behind the last argument.
fn dense(plan: &str) -> String {
    emitted(plan).split_whitespace().collect::<String>().replace(",)", ")")
}

#[test]
fn an_atom_is_described_without_its_removed_interrupt() {
    let rust = emitted("{ Main (a) (Atom (a) seek) (Atom (b) idle) }");
    assert!(rust.contains("/// `(Atom (null) seek)`") && rust.contains("/// `(Atom (b) idle)`"), "{rust}");
}

#[test]
fn arguments_are_what_their_texts_say() {
    let laws = "(Atom (a) wander(1 inf)) (Atom (a) wander(1m, 2.5s)) (Atom (a) veer -90) (Atom (a) veer 1rad)";
    let interrupts = "(Atom (beyond -0.5 0) idle) (Atom (beyond 2 -3) idle) (Atom (beyond 2 1) idle)";
    let rust = dense(&format!("{{ Main {laws} {interrupts} }}"));
    for argument in [
        "Wander::new(runtime::Meters(1.0),runtime::Nanos::MAX)",
        "Wander::new(runtime::Meters(1.0),runtime::Nanos(2500000000))",
        "Veer::new(runtime::Radians::from_degrees(-90.0))",
        "Veer::new(runtime::Radians(1.0))",
        "Beyond::new(-0.5,0)",
        "Beyond::new(2.0,-3)",
        "Beyond::new(2.0,1)",
    ] {
        assert!(rust.contains(argument), "{argument} in {rust}");
    }
}

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
        // `const fn` is none.
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

/// Every name that a file gives to a function of its own, an argument or a variable, as far as a scope could have it.
fn names_of_its_own(rust: &str) -> Vec<&str> {
    // Functions further in are methods, which hide nothing.
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
    for name in ["begin", "cursor", "direct", "law", "scope", "t", "text", "texts", "y"] {
        assert!(own.contains(&name), "{name} is one of {own:?}");
    }
    for name in own.into_iter().chain(["gen", "fn"]) {
        let rust = emitted(&format!("{{ Main (Atom (a) seek) {{ {name} (b) (Atom (c) idle) }} }}"));
        assert!(!rust.contains(&format!("fn {name}(cursor")), "{name} in {rust}");
    }
}

#[test]
fn a_plan_may_be_called_as_any_type_that_its_file_uses() {
    let rust = emitted("{ Main (Atom (a) seek)^2 }");
    let lines = rust.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n");
    // Variants are written with their enum everywhere else.
    let (start, rest) = code.split_once("enum Running {").expect("the laws");
    let code = format!("{start} Running {}", rest.split_once('}').expect("their end").1);
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    // What is written large is a constant.
    let is_type = |word: &str| {
        word.starts_with(|letter: char| letter.is_ascii_uppercase())
            && word.contains(|letter: char| letter.is_lowercase())
    };
    for name in code.split(|letter| !is_part(letter)).filter(|word| is_type(word) && *word != "Main") {
        let places = code.match_indices(name).map(|(place, _)| (&code[..place], &code[place + name.len()..]));
        let mut alone = places.filter(|(before, behind)| !before.ends_with(is_part) && !behind.starts_with(is_part));
        // Where it is looked for is said before it, or it is a type of the trait's.
        let is_found_elsewhere = alone.all(|(before, _)| before.ends_with("::") || before.ends_with("type "));
        assert!(is_found_elsewhere || plan_type(name) != name, "{name}");
    }
    for name in ["Plan", "Self", "Option", "Some", "None"] {
        assert_eq!(plan_type(name), format!("{name}Plan"), "what Rust or the runtime calls so keeps its name");
    }
}

#[test]
fn a_condition_of_many_operands_has_sixty_four_at_each_depth() {
    for operands in [64, 65, 5_000] {
        let waits: Vec<_> = (1..=operands).map(|seconds| format!("wait {seconds}")).collect();
        let rust = dense(&format!("{{ Main (Atom ({}) idle) }}", waits.join(" OR ")));
        let condition = rust.split("Running::Atom1(_)=>").nth(1).expect("the atom's arm");
        assert_eq!(operands_at_one_depth(condition), 64, "{operands} operands: {condition}");
        assert_eq!(rust.matches("cursor.since(").count(), operands);
    }
}

/// The most operands of `|` between two parentheses.
fn operands_at_one_depth(text: &str) -> usize {
    let mut open = vec![1];
    let mut most = 1;
    for letter in text.chars() {
        match letter {
            '(' => open.push(1),
            ')' => {
                open.pop();
            }
            '|' => *open.last_mut().expect("as many open as are closed") += 1,
            _ => {}
        }
        most = most.max(open.last().copied().unwrap_or(1));
    }
    most
}
