//! Tests that the reference lists exactly the keys of the answers of `mdle why` (docs/src/reference/interfaces.md,
//! 6.8).

use std::collections::BTreeSet;
use std::fs;

use mdle_tests::executable::folder;
use mdle_tests::repository::root;
use serde_json::Value;

use super::asked;
use super::scripted::{outputs, ping, write};

/// Returns the keys in the tables after `head` and before `end`.
fn documented(head: &str, end: &str) -> BTreeSet<String> {
    let page = fs::read_to_string(root().join("docs/src/reference/interfaces.md")).unwrap();
    let section = page.split_once("### 6.8 ").unwrap().1.split_once(head).unwrap().1.split_once(end).unwrap().0;
    let cells = section.lines().filter(|line| line.starts_with("| `")).map(|line| line.split('|').nth(1).unwrap());
    cells.flat_map(|cell| cell.split(',').map(|key| key.trim().trim_matches('`').to_owned())).collect()
}

/// Removes the keys of an object, and of all objects inside it, from `unused`. `path` contains the keys that lead to
/// the object. Undocumented keys are added to `others`. If several ends of a path are documented, the longest end
/// counts.
fn look(
    value: &Value,
    path: &str,
    known: &BTreeSet<String>,
    unused: &mut BTreeSet<String>,
    others: &mut BTreeSet<String>,
) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| look(item, path, known, unused, others)),
        Value::Object(entries) => {
            for (key, value) in entries {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                let starts = path.match_indices('.').map(|(at, _)| at + 1);
                let ends: Vec<_> = [0].into_iter().chain(starts).map(|at| path[at..].to_owned()).collect();
                // A key of the answer itself does not document the same key of a nested object.
                let inside = ends.iter().filter(|end| end.contains('.') || **end == path);
                match inside.into_iter().find(|end| known.contains(*end)) {
                    Some(end) => _ = unused.remove(end),
                    None => _ = others.insert(path.clone()),
                }
                look(value, &path, known, unused, others);
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[test]
fn answers_have_the_keys_of_the_reference() {
    let plan = "{ Keys (wait 4s)
  ((Atom (r0 < 50cm OR wait 500ms) go 20 0) (Atom (NOT (bumper OR r1 < 1m)) go 10 0))^2
  { Near (r2 < 1m) (Atom (wait 1s) go 5 0) }
  { Far (wait 1s) (Atom (RISING (bumper OR lowBattery)) go 4 0) (Atom (null) go 3 0) }
  (Atom (null) stop)
}
";
    let (folder, target) = (folder("why-keys"), mdle_files::target(Some("sim")).unwrap());
    let outputs = outputs(45, |turn, y| {
        ping(y, 0, if turn == 3 { 0.4 } else { 2.0 });
        ping(y, 1, 2.0);
        ping(y, 2, if turn > 8 { 0.5 } else { 2.0 });
        y.switches = u32::from((3..8).contains(&turn));
    });
    write(&folder, "keys", &target, plan, &outputs);
    let times = ["0", "0.3", "0.8", "1.3", "2.5", "4.0"].map(|time| vec![time]);
    let names = ["go", "go 5 0", "Near", "Far", "go 3 0", "stop", "Keys", "go 10 0"].map(|name| vec!["--not", name]);
    let kinds = [
        (&times[..], documented("prints one object. Times", "`mdle why LOG --not")),
        (&names[..], documented("--not ATOM", "## 7")),
    ];
    let scopes = documented("wherever they are", "`mdle why LOG --not");
    for (questions, own) in kinds {
        let known: BTreeSet<_> = own.union(&scopes).cloned().collect();
        let (mut unused, mut others) = (own, BTreeSet::new());
        for question in questions {
            let arguments = [&["why", "keys.mcap", "--json"], &question[..]].concat();
            let answer = asked(&folder, &arguments);
            let object: Value = serde_json::from_str(answer.lines().nth(1).unwrap()).expect(&answer);
            look(&object, "", &known, &mut unused, &mut others);
        }
        assert_eq!((unused, others), Default::default(), "{questions:?}: documented only, printed only");
    }
}
