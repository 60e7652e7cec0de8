//! Tests the limits of a run: turns whose moments are not stored can still be explained, and a run with too much data
//! ends.

use serde_json::Value;

use super::{DataLimits, LIMITS, Run};
use crate::draft::PageFiles;
use crate::setup::PageSetup;

const DOCK: &str =
    "{ Dock (bumper)\n (Atom (wait 1s) (go 20 0))\n (Atom (NOT bumper) stop)\n (Atom (wait 2s) stop)\n}\n";
/// A plan that makes 4,096 transitions in each turn.
const SPIN: &str = "{ Spin (wait 1h)\n ExecPlan inf {\n  (Atom (NOT bumper) stop)\n  (Atom (wait 0s) stop)\n }\n}\n";

fn begun(text: &str, limits: DataLimits) -> Run {
    let world = "[[wall]]\npoints = [[-1, -1], [9, -1], [9, 1], [-1, 1], [-1, -1]]\n".to_owned();
    let draft = PageFiles { text: text.to_owned(), ..PageFiles::default() };
    let setup = PageSetup { draft, world, limit: Some(60.0), ..PageSetup::default() };
    Run::within(limits, &setup).expect("a run")
}

fn made(run: &mut Run) -> (Vec<Value>, Value) {
    let mut turns = Vec::new();
    loop {
        let answer = run.step(1000);
        turns.extend(answer["turns"].as_array().expect("turns").iter().cloned());
        if !answer["end"].is_null() {
            return (turns, answer["end"].clone());
        }
    }
}

#[test]
fn turns_are_explained_without_their_moments() {
    let mut run = begun(DOCK, LIMITS);
    let mut lean = begun(DOCK, DataLimits { moments: 2000, ..LIMITS });
    let (turns, end) = made(&mut run);
    assert_eq!(made(&mut lean), (turns.clone(), end));
    assert!(lean.moments.len() < turns.len() / 2 && run.moments.len() == turns.len());
    for turn in 0..turns.len() {
        assert_eq!(run.why(turn), lean.why(turn), "turn {turn}");
    }
    assert!(lean.why(turns.len()).is_err());
}

#[test]
fn atoms_that_are_skipped_are_counted_apart() {
    let (turns, _) = made(&mut begun(DOCK, LIMITS));
    let skipped: Vec<_> = turns.iter().filter(|turn| turn["skipped"] != serde_json::json!([])).collect();
    assert_eq!(skipped.len(), 1);
    assert_eq!(skipped[0]["skipped"], serde_json::json!([[1, 1]]));
}

#[test]
fn kept_moments_have_no_room_for_those_left_out() {
    let mut run = begun(SPIN, LIMITS);
    run.step(3);
    assert!(run.moments.iter().all(|moments| moments.len() == 41 && moments.capacity() < 100));
}

#[test]
fn a_run_that_is_too_large_ends() {
    let mut run = begun(SPIN, DataLimits { turns: 50_000, ..LIMITS });
    let (turns, end) = made(&mut run);
    assert_eq!(end, serde_json::json!({ "how": "full" }));
    assert!(turns.len() > 1 && turns.len() < 100, "{} turns", turns.len());
    assert!(run.why(turns.len() - 1).is_ok());
}
