//! Proposes an existing path to a user who has typed a path that does not exist.

use mdle_compiler::alphabet::nearest;

use super::Tree;
use super::node::names;

/// Maximum number of names that a sentence lists.
const NAMED: usize = 12;

/// Returns the end of a sentence about a path that does not exist. It proposes a path with the same ending or a similar
/// path, or lists the names in the path's deepest existing folder.
pub(super) fn proposal(tree: &Tree, path: &str) -> String {
    let mean = |path: &str| format!("; did you mean `{path}`?");
    let mut alike = tree.keys().filter(|known| path.len() > 1 && known.ends_with(path));
    if let (Some(only), None) = (alike.next(), alike.next()) {
        return mean(only);
    }
    let mut known = String::new();
    let mut is_changed = false;
    for name in path.split('/').filter(|name| !name.is_empty()) {
        let inside = names(tree, &known);
        let mut inside_names = inside.iter().map(|name| name.trim_end_matches('/'));
        let next = if inside_names.clone().any(|known| known == name) { Some(name) } else { None };
        let Some(next) = next.or_else(|| nearest(name, &mut inside_names)) else {
            return match is_changed {
                true => mean(&known),
                false => sending(path).unwrap_or_else(|| content(&known, &inside)),
            };
        };
        is_changed |= next != name;
        known = format!("{known}/{next}");
    }
    if is_changed { mean(&known) } else { String::new() }
}

/// Returns the end of a sentence about the method that would send plans to a robot. The method is there only if the
/// file of the link has a key for plans of this robot (docs/src/many_robots.md); `None` for another path.
fn sending(path: &str) -> Option<String> {
    let robot = path.strip_prefix("/link/")?.strip_suffix("/send_plan").filter(|robot| !robot.contains('/'))?;
    let table = format!("add `plans = \"KEY\"` to the table of `{robot}` in the file of `--link`");
    Some(format!(": {table}, and the same key to the table of this robot in the file of `{robot}`"))
}

/// Returns the end of a sentence that lists the names in a folder.
fn content(folder: &str, names: &[String]) -> String {
    let folder = if folder.is_empty() { "/" } else { folder };
    match names {
        [] => format!(": `{folder}` is no folder"),
        _ => format!(": `{folder}` has {}", listed(names)),
    }
}

/// Returns a list of at most twelve names for a sentence.
pub(crate) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let first: Vec<_> = names.iter().take(NAMED).map(AsRef::as_ref).collect();
    match names.len().saturating_sub(NAMED) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Node, ValueKind};

    #[test]
    fn a_wrong_path_gets_a_proposal() {
        let paths = ["/clock/now", "/safety/limits/speed", "/usr/ears/bearing", "/usr/robot/v", "/usr/robot/x"];
        let tree: Tree = paths.map(|path| (path.to_owned(), Node::reading(ValueKind::Number, "a number"))).into();
        let wrong = [
            "/usr/robt",
            "/usr/robt/x",
            "/usr/robt/speed",
            "/usr/robot/y2",
            "/robot/x",
            "/speed",
            "/lib/ears",
            "/clock/now/x",
            "/link/second/send_plan",
        ];
        let proposals = wrong.map(|path| format!("{path}{}", proposal(&tree, path)));
        insta::assert_snapshot!(proposals.join("\n"));
    }
}
