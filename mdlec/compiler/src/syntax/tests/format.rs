//! Tests the canonical layout with examples, and checks that it keeps the tree and every comment.

use proptest::prelude::*;

use super::super::format;
use super::super::lexer::lex;
use super::super::source::FileText;
use super::super::token::Tok;
use super::properties::config;
use super::{Arena, listings, outline, parse};
use crate::diagnostic::SourceId;

/// Every form of the language, in usual and in unusual layout.
const FORMS: &str = "use \"corridors.mdle\";use \"doors.mdle\"
{Tour(v:speed,mask:bits[4])(bumper or wait(5)and not sync ada)
Leg(15cm/s,0100) FRAME 180deg Leg()  here:ExecPlan n Leg
ExecPlan 3{(Atom(wait 500ms)(go 5 0))(Atom(bumper)stop)}((Atom(null)turn 90)Leg)^ 2 (Leg)^∞
{Inner (wait 1)(Atom (r_3(t) \\leq r 5 OR x>=-1 AND rising t == 5s) path \"a b.txt\")} σ_null}
Γ_lab2^lab1={Formal(null)(A,x OR y)(go(5 0) , bumper , 10s)(go 5 0,(bumper),inf)(A B,x)
(Atom (after here (bumper OR wait 5)) goAvoid(heading module)) ((Atom (after here bumper) align (1 2) 3))^n}
\\Gamma_{a}^{\\text{b c}} = \\{ \\text{Last} (Atom (wait $\\infty$) stop); \\}$
";

/// Comments in every possible place.
const COMMENTS: &str = "// The first line.


// The second.
use \"a.mdle\" // beside a use
/* before
   a use   \t
   in lines */ use \"b.mdle\"
/// What it is for.
/// And more.
{ /* name */ A // behind the name
  (bumper /* why */ OR // because
   // on its own
   wait 5) /* behind the head */
  // before the first

  (Atom (wait 1) stop)   // the first
  (Atom (wait 2) go 20 0) // the second, longer



  /* to the loop */ ExecPlan /* n */ 3 { B C /* last */ } // after the loop
  { D E } // short
  /* one */ /* two */ F /* three */ G /* four */ // five
  (Atom // an atom
    (wait 3) /* law */ (go /* v */ 20 // ω
    0))

  // the last
  } // the end of A
// between
{ B (Atom (wait 1) stop) /* in B */ } { C (Atom (wait 1) stop) }
// the end";

/// Lines that are too long.
const LONG: &str = "{ Scope (atIsection 0100 OR atIsection 1000 AND NOT bumper OR wait 20s OR sync robot1 AND sync robot2 OR wait 30) (Atom (wait 1) stop) }
{ Several (null) { Inner (wait 15s OR bumper) ((Atom (wait 500ms) (go 5 0)) (Atom (null) turn 90) (Atom (wait 1) (turn 45)))^3 } }
{ Atoms (Atom (atIsection 0100 OR atIsection 1000 AND NOT bumper OR wait 20s OR sync robot1 AND sync robot2) (goAvoid 90 40 20)) }
{ Formal (null) (go(20cm/s, 0.25rad/s), atIsection 0100 OR atIsection 1000 AND NOT bumper OR wait 20s OR sync robot1, 100s) }
{ Fits (bumper) (Atom (atIsection 0100 OR wait 20s) (goAvoid 90deg 40m 20cm/s)) ExecPlan 2 { Patrol(15cm/s) Patrol(20cm/s) } }
";

fn formatted(text: &str) -> String {
    format(SourceId(7), text).unwrap_or_else(|found| panic!("{text}\n{found:#?}"))
}

/// Returns the outline of a text without errors, which contains no places.
fn tree(text: &str) -> String {
    let arena = Arena::new();
    let (file, found) = parse(SourceId(0), text, &arena);
    assert_eq!(found, [], "{text}");
    outline(&file)
}

/// Returns the comments of a text, without spaces at the ends of their lines. Strings in the text must contain no
/// comments.
fn comments(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find('/') {
        let comment = &rest[start..];
        let length = if comment.starts_with("//") {
            comment.find('\n')
        } else if comment.starts_with("/*") {
            comment.find("*/").map(|end| end + 2)
        } else {
            rest = &comment[1..];
            continue;
        };
        let (comment, behind) = comment.split_at(length.unwrap_or(comment.len()));
        found.push(comment.lines().map(str::trim_end).collect::<Vec<_>>().join("\n"));
        rest = behind;
    }
    found
}

/// Checks that the layout keeps a text's tree and comments; returns the formatted text.
fn assert_kept(text: &str) -> String {
    let formatted = formatted(text);
    assert_eq!(tree(&formatted), tree(text), "{text}\n────\n{formatted}");
    assert_eq!(comments(&formatted), comments(text), "{text}\n────\n{formatted}");
    assert_eq!(self::formatted(&formatted), formatted, "{text}");
    assert!(formatted.lines().all(|line| line.trim_end() == line), "{formatted}");
    assert!(formatted.ends_with('\n') && !formatted.contains("\n\n\n"), "{formatted}");
    formatted
}

#[test]
fn every_form_has_its_layout() {
    insta::assert_snapshot!(assert_kept(FORMS));
}

#[test]
fn strings_as_the_paper_prints_them_get_braces_and_no_commas() {
    let text = "{A (null)(((Atom (b) u),(Atom (c) v)),x,5) B,{C D, /* why */ E}}
/// As in Fig. 2.
((a, ψ_a)(b, ψ_b), ψ_c)σ_null // the end
Γ_x=(a b)^2 \\sigma_{null} { F G }";
    insta::assert_snapshot!(assert_kept(text), @r"
    { A (null)
      (((Atom (b) u) (Atom (c) v)), x, 5)
      B
      { C
        D
        /* why */ E
      }
    }

    /// As in Fig. 2.
    { Plan ((a, ψ_a) (b, ψ_b), ψ_c) sigma_null }    // the end

    Γ_x = { Plan (null) (a b)^2 sigma_null }

    { F G }
    ");
}

#[test]
fn the_papers_listings_read_well() {
    insta::assert_snapshot!(assert_kept(&listings::ALL.concat()));
}

#[test]
fn comments_stay_where_they_belong() {
    insta::assert_snapshot!(assert_kept(COMMENTS));
}

#[test]
fn what_is_too_long_goes_on_in_further_lines() {
    let formatted = assert_kept(LONG);
    assert!(formatted.lines().all(|line| line.chars().count() <= 100), "{formatted}");
    insta::assert_snapshot!(formatted);
}

#[test]
fn a_line_has_a_hundred_columns() {
    let plan = |columns: usize| format!("{{ {} (Atom (wait 1) stop) }}\n", "ω".repeat(columns - 25));
    assert_eq!(assert_kept(&plan(100)), plan(100));
    assert_eq!(assert_kept(&plan(101)), plan(101).replace(" (Atom", "\n  (Atom").replace(" }", "\n}"));
}

#[test]
fn the_deepest_nesting_is_laid_out() {
    let flat = format!("{{ A {}B{} }}", "{ A ".repeat(255), " }".repeat(255));
    assert_eq!(assert_kept(&flat).lines().count(), 256 + 1 + 256);
}

#[test]
fn a_text_with_errors_is_not_laid_out() {
    let found = format(SourceId(0), "{ A (Atom (bumper) }").expect_err("a bracket is missing");
    assert!(!found.is_empty());
    assert!(format(SourceId(0), "// nothing").is_err());
}

#[test]
fn a_label_of_blanks_only_stays_as_it_is() {
    assert_kept("Γ_{ }^{a b} = { A B }\n\\Gamma_{ a  b } = { B A }");
}

/// Text that is allowed between two tokens.
const GAPS: &[&str] = &[
    " ",
    "\n",
    "\n\n\n",
    "\t;",
    "/* c */",
    "/* c */ ",
    "\n/* c\n d */\n",
    "\n/**/",
    "// c\n",
    " // c  \n",
    "\n\n// c\r\n",
    "///c\n",
    "\n////\n",
];

/// Inserts gaps between the tokens of a text, except before parentheses that touch a name.
fn odd(text: &str, gaps: &[(proptest::sample::Index, &str)]) -> String {
    let tokens = lex(FileText { id: SourceId(0), text }).tokens;
    let mut places: Vec<_> = tokens.iter().filter(|token| token.kind != Tok::TouchParen).collect();
    let mut inserted: Vec<_> = gaps.iter().map(|(at, gap)| (at.get(&places).place.start, *gap)).collect();
    places.clear();
    inserted.sort_by_key(|(at, _)| std::cmp::Reverse(*at));
    let mut text = text.to_owned();
    for (at, gap) in inserted {
        text.insert_str(at, gap);
    }
    text
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn odd_layout_keeps_the_tree_and_every_comment(
        text in proptest::sample::select(vec![FORMS, COMMENTS, LONG, listings::ALL[0], listings::ALL[3]]),
        gaps in proptest::collection::vec((any::<proptest::sample::Index>(), proptest::sample::select(GAPS)), 0..60),
    ) {
        assert_kept(&odd(text, &gaps));
    }
}
