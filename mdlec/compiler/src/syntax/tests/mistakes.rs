//! Tests the messages about mistakes: one message for each mistake, with a text to type.

use super::{Arena, check, one, parse};
use crate::diagnostic::{Code, SourceId};

#[test]
fn atoms() {
    check(
        "mistakes_atoms",
        &[
            "{ A (Atom bumper stop) (Atom (wait 5) stop) }",
            "{ A (Atom wait 5 (go 5 0)) }",
            "{ A (Atom stop (bumper)) }",
            "{ A (Atom) (Atom (bumper)) (Atom (bumper) (go 5 0) 7) (Atom (bumper) stop^3) (Atom (bumper) go 5, 0) }",
            "{ A Atom (bumper) stop\n Atom (wait 5) stop }",
            "{ A Atom (bumper) stop) (Atom (wait 5) stop) }",
            "{ A (bumper) ((wait 5) stop) go 5 0 }",
        ],
    );
}

#[test]
fn comparisons_without_an_end() {
    for text in ["{ A (Atom (r 0 <) stop) }", "{ A (r 0 ==) B }"] {
        let arena = Arena::new();
        let (_, diagnostics) = parse(SourceId(0), text, &arena);
        let messages: Vec<_> = diagnostics.iter().map(|diagnostic| diagnostic.message.as_str()).collect();
        assert_eq!(messages, ["expected a value or a signal, found `)`"]);
    }
}

#[test]
fn printed_strings() {
    check(
        "mistakes_printed_strings",
        &[
            "{ A, B } { A (n: count), B } { A (n: count) (bumper), B } { A (s1: B), C }",
            "{ A (bumper), B } { A (null), { B (bumper), C } } { A B, }",
            "{ A B,, C } { A (Atom (bumper) stop),, (Atom (bumper) stop) }",
            "{ A ExecPlan 3 {, B } ExecPlan 3, { B } ExecPlan 3 { B, } FRAME 90, B FRAME here, B s1:, B }",
            "{ A (,(Atom (bumper) stop))^2 } { A ((Atom (bumper) stop),)^2 }",
            "{ A B }, { C D }",
            "{ A (Atom (bumper, wait 2) stop) (Atom (bumper OR, wait 2) stop) (Atom (bumper), stop) }",
            "σ_null",
            "{ A B } σ_null",
            "((u, x),)σ_null",
            "((u, x), (u, y), z)",
            "((u, x) (u, y), z) { A B }",
            "(go(20, 0), bumper)",
            "((u, x)(u, y), z)^3 ((u, x))^2 { A B }",
            "((go(20, 0), bumper)\n(turn(90), null), null)",
            "((u, x), (u, y",
        ],
    );
}

#[test]
fn plans() {
    check(
        "mistakes_plans",
        &[
            "{ (bumper) (Atom (bumper) stop) } { }",
            "{ module (bumper) (Atom (bumper) stop) }",
            "{ 3 (Atom (bumper) stop) }",
            "A { (Atom (bumper) stop) }",
            "Foo = { A (Atom (bumper) stop) }",
            "Γ_x { A (Atom (bumper) stop) }",
            "Γ_x = A { (Atom (bumper) stop) }",
            "{ A Γ_b (Atom (bumper) stop) }",
            "Γ_b = ",
            "(Atom (bumper) stop)",
            "use corridors { A (Atom (bumper) stop) }",
            "{ A (v: speed, ) (Atom (bumper) stop) }",
            "{ A (Atom (bumper) stop) sigma_null B }",
            "// nothing\n",
        ],
    );
}

#[test]
fn elements() {
    check(
        "mistakes_elements",
        &[
            "{ A (Atom (bumper) stop), (Atom (bumper) stop) }",
            "{ A ((Atom (bumper) stop), (Atom (bumper) stop)) }",
            "{ A ExecPlan { (Atom (bumper) stop) } }",
            "{ A ExecPlan 3 (Atom (bumper) stop) }",
            "{ A ExecPlan Patrol 3 }",
            "{ A ExecPlan 3 Patrol { (Atom (bumper) stop) } }",
            "{ A execplan 3 { B (Atom (bumper) stop) } }",
            "{ A (B)^ (Atom (bumper) stop) }",
            "{ A FRAME Lab B }",
            "{ A B(Atom (bumper) stop) }",
            "{ A 7 (Atom (bumper) stop) = 7 }",
            "{ A (bumper) ( ) ExecPlan 3 { } { B } }",
        ],
    );
}

#[test]
fn inside_parentheses() {
    check(
        "mistakes_inside_parentheses",
        &[
            "{ A (null) (go 20 = 0) (B, ) (B, = x) (B, x = 5) (B, x, 5 = 6) (Atom (b) u) }",
            "{ A (v: 5) (Atom (b) u) }",
            "{ A (null) (go 20, ) (go 20, = x) (go 20 0, x = 5) (go 20 0, x, 5 = 6) (Atom (b) u) }",
            "{ A (null) B(5 = 6) (Atom (b (5 = 6)) u) (Atom (b) (u (5 = 6))) (Atom (b) (= u)) (Atom (b) u) }",
        ],
    );
}

#[test]
fn conditions() {
    check(
        "mistakes_conditions",
        &[
            "{ A (x = 3) (Atom () stop) (Atom (OR bumper) stop) (Atom (bumper OR) stop) (Atom (NOT NOT bumper) stop) }",
            "{ A (Atom (0.5 < r 3) stop) (Atom (r 3 < 0.5 m) stop) (Atom (after 5) stop) }",
            "{ A (Atom (atIsection 1,0,0,0 OR wait 5) stop) (stop, atIsection 1, 0, 0, 0) (Atom (atIsection 1,0,0) stop) }",
            "{ A (Atom (b) align 3, 5) (Atom (b) (goAvoid 90, 4m, 20)) (Atom (b) (go 5, 0 = 1)) }",
            "{ A ((bumper OR) AND wait 5) (Atom (bumper) stop) }",
        ],
    );
}

#[test]
fn brackets() {
    check(
        "mistakes_brackets",
        &[
            "{ A (Atom (bumper stop)\n    (Atom (wait 5) stop) }",
            "{ A\n  (Atom (bumper) stop)\nΓ_b = { B\n  (Atom (bumper) stop)\n}\n",
            "{ A (Atom (bumper) stop)",
            "{ A (Atom (bumper) stop) )",
            "{ A (Atom (bumper) stop) } }",
            "{ A (Atom (bumper) stop)) (Atom (bumper) stop) }",
            "{ A (B (C (D }",
            "{ A \\text{B }",
            "{ A \\text{B {",
        ],
    );
}

#[test]
fn brackets_nest_256_deep() {
    let nested = |depth: usize| format!("{{ A (null) {}B{} }}", "(".repeat(depth - 1), ")".repeat(depth - 1));
    assert_eq!(parse(SourceId(0), &nested(256), &Arena::new()).1, []);
    let arena = Arena::new();
    let (_, diagnostics) = parse(SourceId(0), &nested(257), &arena);
    assert_eq!(diagnostics.iter().map(|found| found.code).collect::<Vec<_>>(), [Code::E0106]);
    check("mistakes_brackets_nest_256_deep", &[&nested(257)]);
}

#[test]
fn characters_and_numbers() {
    check(
        "mistakes_characters_and_numbers",
        &[
            "{ A (Atom (bumper && wait 5) stop) (Atom (!bumper) # stop) }",
            "{ A (Atom (wait 20furlongs) stop) (Atom (wait 20sec) stop) ExecPlan 3Patrol }",
            "{ A (Atom (wait .5) stop) (Atom (wait 5.) stop) (Atom (wait 5-3) stop) (Atom (wait 5.5.5) stop) }",
            "{ A (Atom (b) (go 20 cm/s 0.36rad/s2)) (Atom (b) (rotate 90°)) (Atom (b) (rotate − 90)) }",
            "{ A B\n 3Patrol\n @ = C }",
            "{ A (Atom (atIsection 0b1000) stop) (Atom (NOT atIsection 10x0) stop) (Atom (atIsection(1xx0)) stop) }",
            "{ A (Atom (atIsection 0b10) stop) (Atom (b) align 3-5) (Atom (b) (align(11-13))) (Atom (b) (align 3-50)) }",
            "{ A B \\alpha \\Gamma “x” @@@ }",
            "{ A (Atom\\; (r_{7}(t) == r_{ 9 }(t))\\, align r_{7} r_{10}) }",
            "{ A (Atom (|r_7 - r_9| < 1cm) stop) (Atom (wait 2)~stop) (Atom (bumper|wait 5|bumper) stop) }",
        ],
    );
}

#[test]
fn what_does_not_end() {
    check(
        "mistakes_what_does_not_end",
        &["{ A B } /* and so on", "use \"corridors.mdle\n{ A (Atom (bumper) path(\"a b)) }"],
    );
}

#[test]
fn all_errors_of_a_file_come_in_order() {
    let text = "{ A (Atom bumper stop)\n  (Atom (wait 5x) stop)\n  7\n  ExecPlan { C }\n  (Atom (wait 5) stop }\n{ (Atom (b OR) u) }\n@";
    let arena = Arena::new();
    let (_, diagnostics) = parse(SourceId(0), text, &arena);
    let lines: Vec<_> = diagnostics
        .iter()
        .filter_map(|found| found.span())
        .map(|span| text[..span.start as usize].matches('\n').count() + 1)
        .collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 6, 6, 7], "{}", one(text));
}
