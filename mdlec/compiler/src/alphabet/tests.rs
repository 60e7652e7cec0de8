//! Tests the reader of alphabets, and its messages about invalid alphabets.

use super::{Alphabet, AlphabetFile, Capability, DeclarationKind, Origin, Unit, combine, read};
use crate::diagnostic::{Code, SourceId, Sources};

const ATOMS: &str = include_str!("../../../../atoms/alphabet.mdle");
const SIM: &str = include_str!("../../../../targets/sim/alphabet.mdle");

fn good(text: &str) -> AlphabetFile {
    let (file, diagnostics) = read(SourceId(0), text);
    assert_eq!(diagnostics, []);
    file.unwrap()
}

fn sim() -> Alphabet {
    let (alphabet, diagnostics) = combine(good(SIM), &[good(ATOMS)]);
    assert_eq!(diagnostics, []);
    alphabet
}

/// Returns the text with its messages, and checks that each message has the code E0601.
fn defects(text: &str) -> String {
    let mut sources = Sources::default();
    let id = sources.add("alphabet.mdle", text);
    let (_, diagnostics) = read(id, text);
    assert!(!diagnostics.is_empty(), "nothing is said about {text}");
    assert!(diagnostics.iter().all(|found| found.code == Code::E0601), "{diagnostics:?}");
    let messages: Vec<String> = diagnostics.iter().map(|found| sources.render(found)).collect();
    format!("{text}\n────────\n{}", messages.concat())
}

#[test]
fn our_own_alphabets_are_read() {
    let atoms = good(ATOMS);
    assert_eq!((atoms.name.as_str(), atoms.declarations.len()), ("atoms", 34));
    let sim = good(SIM);
    let head = sim.target.unwrap();
    assert_eq!((head.crate_name.as_str(), head.period), ("mdle_sim", Some(100_000_000)));
    assert_eq!(
        head.capabilities.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "),
        "diff_drive sonar[16] bumper odometry paths power"
    );
    assert_eq!(head.engine.iter().map(ToString::to_string).collect::<Vec<_>>(), ["modules", "state_link"]);
}

#[test]
fn a_quark_names_the_attributes_that_it_reads() {
    let file = good(
        "alphabet a; control f(of: module with bearing, range, n: count); signal s(of: module) unit m tolerance 0;",
    );
    let with: Vec<_> =
        file.declarations.iter().flat_map(|found| &found.params).map(|param| param.with.join(" ")).collect();
    assert_eq!(with, ["bearing range", "", ""]);
    let report = defects("alphabet a; control f(n: count with range);");
    assert!(report.contains("only a module has attributes"), "{report}");
}

#[test]
fn an_executable_lacks_what_an_engine_has() {
    let mut sim = sim();
    let modules = Capability { name: "modules".into(), size: None };
    assert!(sim.has(&modules) && sim.needs_engine(&modules));
    let hash = sim.hash();
    sim.has_engine = false;
    assert!(!sim.has(&modules) && sim.hash() == hash);
}

#[test]
fn declarations_are_read_in_full() {
    let file = good(
        "alphabet a; /// One.\n/// Two.\ncontrol f(p: speed cm/s = -20 in -100..100, q: number = 1e2, n: bits[4] = 0100) completes remembers needs x, y[2];",
    );
    insta::assert_snapshot!(format!("{} /// {}", file.declarations[0], file.declarations[0].docs));
}

#[test]
fn a_declaration_of_the_target_replaces_the_shared_one() {
    let sim = sim();
    let go: Vec<_> = sim.declarations_of("go").collect();
    assert_eq!(go.len(), 1);
    assert!(go[0].origin == Origin::Target && go[0].params[0].range == Some((-100.0, 100.0)));
    let avoid: Vec<_> =
        sim.declarations_of("goAvoid").map(|found| (found.origin.clone(), found.params.len())).collect();
    assert_eq!(avoid, [(Origin::Target, 3), (Origin::Shared("atoms".into()), 1)]);
}

#[test]
fn a_value_of_a_unit_is_exact_in_si_units() {
    let si = |unit: &str, value| Unit::from_name(unit).map(|unit| unit.to_si(value));
    assert_eq!([si("cm/s", -70.0), si("in", 3.0), si("min", 1.5)], [Some(-0.7), Some(0.0762), Some(90.0)]);
    assert_eq!(si("deg", 180.0), Some(std::f64::consts::PI));
}

#[test]
fn capabilities_have_a_size() {
    let need = |name: &str, size| Capability { name: name.into(), size };
    assert!(sim().has(&need("sonar", Some(8))) && sim().has(&need("bumper", None)));
    assert!(!sim().has(&need("sonar", Some(17))) && !sim().has(&need("arm", None)));
    assert!(Alphabet::shared(good(ATOMS)).has(&need("arm", None)));
}

#[test]
fn the_nearest_name_is_near() {
    let sim = sim();
    assert_eq!(sim.nearest("bumpr", None), Some("bumper"));
    assert_eq!(sim.nearest("goavoid", None), Some("goAvoid"));
    assert_eq!(sim.nearest("stpo", Some(DeclarationKind::Control)), Some("stop"));
    assert_eq!(sim.nearest("teleport", None), None);
}

#[test]
fn the_hash_is_over_what_is_declared() {
    let hash = |text: &str| combine(good(text), &[good(ATOMS)]).0.hash();
    assert_eq!(hash(SIM), hash(&SIM.replace("/// Drives", "// A comment.\n/// Goes")));
    assert_ne!(hash(SIM), hash(&SIM.replace("-6..6", "-7..7")));
    assert_ne!(hash(SIM), hash(&SIM.replace("use atoms;", "")));
}

#[test]
fn an_unknown_shared_alphabet() {
    let (_, diagnostics) = combine(good("target t : crate t; use molecules;"), &[good(ATOMS)]);
    assert_eq!(diagnostics.iter().map(|found| found.code).collect::<Vec<_>>(), [Code::E0601]);
}

#[test]
fn alphabets_that_make_no_sense() {
    let texts = [
        "alphabet a; control f(p: spead);",
        "alphabet a; control f(p: speed furlongs);",
        "alphabet a; control f(p: speed deg);",
        "alphabet a; control f(p: speed = 20 in 0..10);",
        "alphabet a; control f(p: speed in 10..0);",
        "alphabet a; control f(p: speed = 0 in -1..1 not 0);",
        "alphabet a; control f(p: speed not);",
        "alphabet a; control f(p: speed, p: time);",
        "alphabet a; control f(p: speed); interrupt f(q: speed);",
        "alphabet a; control f(p: speed = 1, q: time);",
        "alphabet a; interrupt f completes;",
        "alphabet a; control f unit m tolerance 1; signal x;",
        "alphabet a; control f(n: integer) exclusive; signal g(n: sonar) unit m tolerance 0 exclusive;",
        "alphabet a; interrupt f exclusive; interrupt g(to: robot) remembers exclusive;",
        "alphabet a; interrupt f(n: integer, far: length) exclusive; interrupt g(of: file) exclusive;",
        "control f;",
        "alphabet a; control f(p speed); control; capability x; law g;",
        "target t : crate t, period 5m;",
        "target t : crate x/y;",
        "target t : crate größe;",
        "target t : crate fn;",
        "target t : crate _;",
        "target t : crate gen;",
        "target t : crate self, period 1s;",
        "target x/y : crate t;",
        "alphabet a; interrupt a/b; control f(m/s: speed m/s) needs x/y;",
        "target t : crate t; interrupt wait(x: length);",
        "target t : crate t; interrupt wait(x: time, y: time); interrupt wait;",
    ];
    insta::assert_snapshot!(texts.map(defects).join("\n════════\n"));
}

#[test]
fn names_have_no_digits_but_decimal_ones() {
    for text in ["target t : crate a²;", "target t : crate t; interrupt a①;"] {
        let (_, diagnostics) = read(SourceId(0), text);
        assert!(diagnostics.iter().any(|found| found.code == Code::E0101), "{text}: {diagnostics:?}");
    }
    assert_eq!(good("target t : crate t, period 1e-1s; control a٣(p: speed cm/s);").declarations[0].name, "a٣");
}

#[test]
fn no_text_makes_the_reader_stop() {
    let pieces = [
        "alphabet a;",
        "control",
        "f",
        "(",
        ")",
        ":",
        "speed",
        "=",
        "1",
        "in",
        "..",
        ",",
        ";",
        "unit",
        "m",
        "needs",
        "x[",
        "@",
        "é",
    ];
    for first in pieces {
        for second in pieces {
            for third in pieces {
                let _ = read(SourceId(0), &format!("alphabet a; control f {first} {second} {third}"));
            }
        }
    }
}
