//! Tests the tree of every form of the language.

use super::check;

#[test]
fn the_example_of_the_language() {
    let text = r#"use "corridors.mdle"

/// From the rear lab door to the front one.
Γ_lab2^lab1 = { Lab2ToLab1Plan (bumper)
  (Atom (atIsection 0100) (goAvoid 90 40 20))
  (Atom (atIsection 0010) (go 0 0.36))
  (Atom (wait inf) align 7 9)
  { Crossing (wait 20s)                          // a behavior: a scope with a guard of its own
    (Atom (atIsection 1000 OR wait 5s) goAvoid(0deg, 40m, 20cm/s))
    ExecPlan 2 { (Atom (wait 500ms) (go 5 0)) (Atom (bumper) stop) }
  }
  ExecPlan 3 Patrol(15cm/s)                      // a named plan, instantiated
}"#;
    check("forms_the_example_of_the_language", &[text]);
}

#[test]
fn elements() {
    check(
        "forms_elements",
        &[
            "{ A B C(5cm/s, inf) D() (E F)^3 ((G)) (Atom (b) u)^inf ExecPlan n E ExecPlan inf { A { B (c) D } } }",
            "{ A FRAME 180deg B s1: FRAME -90 C(1 2) s2: (D)^2 Γ_e = { E F } }",
            "{ A FRAME here (B here)^2 s1: FRAME here(C) FRAME // then\nhere here FRAME here { here D } }",
            "{ A B σ_null } { B A sigma_null } { C A \\sigma_{null} }",
            "/* no doc */ /// One.\n/// Two.\n{ A /// inside\n B } //// none\n{ B A }",
        ],
    );
}

#[test]
fn groups() {
    check(
        "forms_groups",
        &[
            "{ Group [a b, c] R (any bumper OR wait 5) (Atom (a.x > 7m AND NOT b.r 3 < 1m) formation line 1m (go 5 0)) }",
            "{ Group [a b] R(a.bumper) (Atom (wait 5) (formation(line, 1m, goAvoid(0, 7m, 20)))) S: (Atom (all c) stop) }",
            "{ Group [] R S } { Group (bumper) S } { Group S } { S (a.b) T }",
            "{ Group [a b S } { S T } { Group [a < b] S T } { Group [a b] (wait 5) S } { Group [a b] }",
            "{ Group [a.b c] R (d. e OR f .g OR h.null OR k.l: m) n.o (p.q: S) }",
        ],
    );
}

#[test]
fn headers() {
    check(
        "forms_headers",
        &[
            "{ A (bumper) B } { A(bumper) B } { A ((bumper)) B } { A (wait 5 OR NOT (bumper)) B }",
            "{ A (v: speed, pattern: bits[4], leader: module) B } { A(v: speed)(bumper) B } { A (v: speed) (Atom (b) u) }",
            "{ A ((Atom (b) u) B) } { A (B C^2) } { A (B, bumper) } { A (null) (B C) } { A (go(5, 0), bumper, 10) }",
            "{ A ExecPlan 2 { B (C D) } ExecPlan n { B (C) } }",
            "{ A ((u, x)(v, y)) } { A (((u, x)), z) } { A ((s1: B)) } { A (b (1, 2)) C } { A ((b (1 (2, 3)) OR c(1, 2)) AND d 1 (2) (3, 4)) C }",
        ],
    );
}

#[test]
fn strings_as_the_paper_prints_them() {
    check(
        "forms_strings_as_the_paper_prints_them",
        &[
            "{ A (null) (((Atom (b) u), (Atom (c) v)), x, 5) B, { C D, E }, ExecPlan 2 { F, G } }",
            "{ A ((u 1, x), (v 2, y), s1: B) FRAME 90 (C^2, FRAME here D), ((u 1, x), (y OR z)) (B, C) }",
            "((a, ψ_a)(b, ψ_b), ψ_c)σ_null",
            "((Atom (b) u), (Atom (c) v)) \\sigma_{null} Γ_x = (a b)^2 sigma_null { C D }",
        ],
    );
}

#[test]
fn conditions() {
    check(
        "forms_conditions",
        &[
            "{ A (a OR b AND NOT c OR (d OR e)) (Atom ((a AND b) and (c) AND d) u) (Atom (not (a or b)) u) }",
            "{ A (RISING a AND rising (b OR c)) (Atom (null OR a) u) (Atom (sync robot2 OR sync(robot3)) u) }",
            "{ A (r_3 == r_5) (Atom (r 3 < 0.5m OR x >= -1 AND y ≤ 2) u) (Atom (r_3(t) \\leq r(5) OR t \\geq 5s OR v > 1 OR t > ∞) u) }",
            "{ A (after s1) (Atom (after s1 x12 OR after s2 (a OR b)) u) (Atom (x3 OR NOT (after s1 atIsection 0100)) u) }",
        ],
    );
}

#[test]
fn arguments() {
    check(
        "forms_arguments",
        &[
            "{ A (a) (Atom (b 1 -2.5 +3e-2) u) (Atom (b) (u (1 2) 3)) (Atom (b) u(1, 2 (3 4), 5)) (Atom (b) u \"a file.txt\") }",
            "{ A (a) (Atom (b) goAvoid(heading module)) (Atom (b) goAvoid heading module) (Atom (b) (u 20cm/s 0.36rad/s)) }",
            "{ A (a) (Atom (b ∞) u \\infty) (Atom (b infinity) u(inf)) (Atom (b 0100) ürüm_2) }",
        ],
    );
}

#[test]
fn formal_notation() {
    check(
        "forms_formal_notation",
        &[
            "{ P (null) (A, x) (A B, x OR y) (A B, (x), 10s) (go 5 0, bumper, inf) (go(5 0), bumper, T) ((Atom (b) u)^2, x) }",
            "{ P (null) (rotate 90, x) (hold inf, x AND y AND z) (path \"a b.txt\" 2, x, 1) }",
        ],
    );
}

#[test]
fn labels() {
    check(
        "forms_labels",
        &[
            "Γ_a^b = { A B } Gamma_a^b = { B A } \\Gamma_{a}^{b} = { C A } \\Gamma_a^b = { D A } $\\Gamma_{\\text{a}}^{b} = \\{$ E A $\\}$",
            "Γ_a = { A B } \\Gamma_{a} = { B A } \\Gamma_{\\text{a}} = \\{ \\text{C}(\\text{bumper}) \\\\ \\text{A} \\}",
        ],
    );
}
