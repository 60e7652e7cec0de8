//! Tests the text of an emitted file: arguments, conditions and tables. `machines.rs` tests its behavior.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::rust::{Shape, bind};
use mdle_tests::emission::{alphabet, emitted, emitted_as, emitted_for};

/// Returns the text without white space and without trailing commas of arguments, so that line breaks do not affect
/// comparisons.
fn one_line(rust: &str) -> String {
    rust.split_whitespace().collect::<String>().replace(",)", ")")
}

fn dense(plan: &str) -> String {
    one_line(&emitted(plan))
}

fn dense_as(shape: Shape, plan: &str) -> String {
    one_line(&emitted_as(shape, plan))
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
fn comparisons_are_what_their_texts_say() {
    let value = |number: &str| format!("runtime::Operand::<runtime::NoSignal>::Value({number})");
    for (comparison, operator, with) in [
        ("x < 2m", "Less", value("2.0")),
        ("x <= 2m", "LessOrEqual", value("2.0")),
        ("x > -50cm", "Greater", value("-0.5")),
        ("x >= 2m", "GreaterOrEqual", value("2.0")),
        ("x == 2m", "Equal(0.01)", value("2.0")),
        ("x == r 3", "Equal(0.026)", "runtime::Operand::Signal(robot::R::new(runtime::SonarId::new(3)))".to_owned()),
    ] {
        let rust = dense(&format!("{{ Main (Atom ({comparison}) idle) }}"));
        let new = format!("runtime::Comparison::new(robot::X::new(),runtime::Operator::{operator},{with});");
        assert!(rust.contains(&new), "{new} in {rust}");
        assert!(!rust.contains(":robot::X=") && !rust.contains(":robot::R="), "a signal is no constant: {rust}");
    }
    let clock = alphabet("signal age unit s tolerance 1; control halt;");
    let rust = one_line(&emitted_for(&clock, "{ Leg (most: time) (Atom (age < most) halt) } { Main Leg(inf) }"));
    assert!(rust.contains("Value(1797693134862315"), "the largest number: {rust}");
    let rust = dense("{ Main (Atom (theta == 90deg) idle) }");
    assert!(rust.contains("robot::Theta::new(),runtime::Operator::SameDirection("), "{rust}");
}

#[test]
fn the_time_in_a_scope_is_an_interval_and_no_constant() {
    let rust = dense_as(Shape::Code, "{ Main (Atom (t < 2s) idle) }");
    assert!(rust.contains("(Nanos(0)..Nanos(2000000000)).contains(&cursor.since(1u16,t))"), "{rust}");
    assert!(!rust.contains("runtime::Comparison"), "{rust}");
    let rows = dense_as(Shape::Rows, "{ Main (Atom (t < 2s) idle) }");
    assert!(rows.contains("Elapsed(Nanos(0),Nanos(2000000000))"), "{rows}");
}

#[test]
fn what_never_fires_is_false_among_others() {
    let rust = dense("{ Main (Atom (null OR a) idle) }");
    assert!(rust.contains("iffalse|runtime::Interrupt::fired(&A,y)"), "{rust}");
}

#[test]
fn a_plan_with_after_has_a_memory_in_its_rows() {
    for shape in [Shape::Code, Shape::Rows] {
        let rust = dense_as(shape, "{ Main (a OR RISING b) (Atom (wait 1) idle) }");
        // In the table of operands, that of RISING follows the two of the plan's OR.
        for part in ["Rising(0,2)", "InRows::remembering(", "fnleave(", "fnsettle("] {
            assert!(rust.contains(part), "{part} in {rust}");
        }
        assert!(rust.contains("runtime::Memories<[bool;2]>"), "a memory for each level of scopes: {rust}");
    }
    let rust = dense_as(Shape::Rows, "{ Main (a) (Atom (wait 1) idle) }");
    assert!(rust.contains("InRows::new(&ROWS,"), "{rust}");
    assert!(!rust.contains("fnleave(") && !rust.contains("Memories") && rust.contains("marks:&[],facts:&[]"), "{rust}");
}

#[test]
fn a_bound_alphabet_has_a_line_for_each_quark_that_runs() {
    let bound = bind(&alphabet(
        "/// Halts.\ncontrol halt; control seek(to: length m in 0..2) completes; interrupt a; signal x unit m tolerance 1; \
         interrupt wait(duration: time s);",
    ));
    let tables = "runtime::alphabet! {
    capabilities: [];
    limits: [
        \"seek\" \"to\" in 0.0..2.0,
    ];
    interrupts: [
        \"a\" => A(a),
    ];
    signals: [
        \"x\" => X(x),
    ];
    controls: [
        \"halt\" => Halt(halt),
        \"seek\" => Seek(seek) completes,
    ];
}
";
    assert!(bound.ends_with(tables), "{bound}");
    assert!(bound.contains("/// `halt`: Halts.\nconst fn halt(arguments: &[runtime::Argument<'_>]) -> Option<Halt> {"));
}

#[test]
fn a_condition_of_many_operands_has_sixty_four_at_each_depth() {
    for operands in [64, 65, 5_000] {
        let waits: Vec<_> = (1..=operands).map(|seconds| format!("wait {seconds}")).collect();
        let rust = dense_as(Shape::Code, &format!("{{ Main (Atom ({}) idle) }}", waits.join(" OR ")));
        let condition = rust.split("Running::Atom1(_)=>").nth(1).expect("the atom's arm");
        assert_eq!(operands_at_one_depth(condition), 64, "{operands} operands: {condition}");
        assert_eq!(rust.matches("cursor.since(").count(), operands);
    }
}

/// Returns the maximum number of operands of `|` that are directly between two parentheses.
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
