//! Writes messages about text that is not TOML, and about keys and values that a world does not have, in the terms that
//! the author of the file knows.

use mdle_quantity::{TomlKeys, TomlMistake, did_you_mean};

use super::Wrong;

/// Keys of a world file, by the kind of their values.
const KEYS: TomlKeys = TomlKeys {
    numbers: &["rough", "x", "y", "heading", "tolerance", "reach", "t60", "level", "radius", "every"],
    lists: &[
        ("points", "[[0, 0], [2.5, 0]]"),
        ("open", "[[20, 50]]"),
        ("schedule", "[[0, 1, 2], [5, 4, 2]]"),
        ("min", "[0, 0]"),
        ("max", "[2.5, 1]"),
        ("centre", "[2.5, 1]"),
        ("size", "[2.5, 1]"),
        ("at", "[2.5, 1]"),
    ],
    flags: &["repeat"],
    tables: &["wall", "box", "disc", "door", "sound"],
};

/// Returns the error of a text that cannot be read as a world.
pub(super) fn unreadable(text: &str, error: &toml::de::Error) -> Wrong {
    let mistake = error.span().and_then(|span| KEYS.mistake(text, span.start, error.message()));
    if let Some(TomlMistake { message, help }) = mistake {
        return Wrong(error.span(), format!("{message}\nhelp: {help}"));
    }
    let what = error.message().replace('\n', " ").replace("expected f64", "expected a number");
    let value = error.span().and_then(|span| text.get(span.start..)).unwrap_or_default();
    let key = error.span().and_then(|span| key_before(text.get(..span.start)?));
    let sentence = match key {
        Some(key) => format!("`{key}`: {}", number(key, value, &what).unwrap_or(what)),
        None => format!("{what}{}", meant(&what)),
    };
    Wrong(error.span(), sentence)
}

/// Keys whose values are texts in quotes.
const TEXTS: [&str; 3] = ["name", "units", "kind"];

/// Returns a sentence about a value that should be a number, such as `50%` and `2m`; `None` if `what` is about
/// something else.
fn number(key: &str, value: &str, what: &str) -> Option<String> {
    if what.ends_with("expected a number") {
        return (key == "rough").then(|| format!("{what} from 0 to 1, as in `rough = 0.5`"));
    }
    let end = value.find(|letter: char| !letter.is_ascii_digit() && !"+-.".contains(letter)).unwrap_or(value.len());
    let (digits, unit) = value.split_at(end);
    let written = digits.parse::<f64>().ok();
    if !what.starts_with("string values must be quoted") || TEXTS.contains(&key) {
        return None;
    }
    if key == "rough" {
        let percent = written.filter(|percent| unit.starts_with('%') && (0.0..=100.0).contains(percent));
        let share = percent.map_or(0.5, |percent| percent / 100.0);
        return Some(format!("expected a number from 0 to 1, as in `rough = {share}`"));
    }
    written.map(|_| format!("expected a number without a unit, as in `{key} = {digits}`"))
}

/// Returns the end of a sentence that lists the known keys: the key that is meant by the unknown one.
fn meant(what: &str) -> String {
    let mut names = what.split('`').skip(1).step_by(2);
    match names.next() {
        Some(unknown) if what.starts_with("unknown field") => did_you_mean(unknown, &names.collect::<Vec<_>>()),
        Some(_) | None => String::new(),
    }
}

/// Returns the key whose value follows `before`; `None` if no value follows it.
fn key_before(before: &str) -> Option<&str> {
    let assigned = before.trim_end().strip_suffix('=')?.trim_end();
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-');
    let from = assigned.rfind(|letter| !is_part(letter)).map_or(0, |at| at + 1);
    assigned.get(from..).filter(|key| !key.is_empty())
}

#[cfg(test)]
mod tests {
    use crate::World;

    /// Returns the error message for a world with an error.
    fn refused(text: &str) -> String {
        World::parse("room.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn a_help_is_right_when_it_is_typed() {
        for (text, typed, proposed) in [
            ("rough = 0,5", "0,5", "0.5"),
            ("rough = 0,5 # half", "0,5", "0.5"),
            ("start = { x = -0,25 }", "-0,25", "-0.25"),
            ("start = { y = 1,5, x = 1 }", "1,5", "1.5"),
            ("start.x = 1,5", "1,5", "1.5"),
            ("start = { x = 1,500 }", "1,500", "1500"),
            ("start = { x = 1,500 }", "1,500", "1.500"),
            ("rough = .5", ".5", "0.5"),
            ("start = { x = -.5, y = 1 }", "-.5", "-0.5"),
            ("rough = 1.", "1.", "1.0"),
            ("[[wall]]\npoints = [[.5, 1], [2, 3]]", ".5", "0.5"),
            ("[[wall]]\npoints = [[5., 1], [2, 3]]", "5.", "5.0"),
            ("[wall]\npoints = [[0, 0], [1, 0]]", "[wall]", "[[wall]]"),
            ("[ wall ]\npoints = [[0, 0], [1, 0]]", "[ wall ]", "[[wall]]"),
            ("[wall]\npoints = [[0, 0], [1, 0]]\n[wall]\npoints = [[0, 0], [1, 0]]", "[wall]", "[[wall]]"),
            ("[box]\nmin = [0, 0]\nmax = [1, 1]", "[box]", "[[box]]"),
            ("[disc]\ncentre = [0, 0]\nradius = 1", "[disc]", "[[disc]]"),
            ("[door]\npoints = [[0, 0], [1, 0]]\nopen = []", "[door]", "[[door]]"),
            ("[sound]\nat = [0, 0]", "[sound]", "[[sound]]"),
            ("[[wall]]\npoints = [[-2 -2], [3, 0]]", "-2 -2", "-2, -2"),
            ("[[wall]]\npoints = [\n  [1; 0.5],\n  [3, 0],\n]", "1; 0.5", "1, 0.5"),
            ("[[disc]]\nradius = 1\nschedule = [[0 1 2], [3, 4, 5]]", "0 1 2", "0, 1, 2"),
            ("[[disc]]\nradius = 1\nschedule = [[0, 1, 2]]\nrepeat = yes", "yes", "true"),
            ("[[disc]]\nradius = 1\nschedule = [[0, 1, 2]]\nrepeat = no # never", "no", "false"),
            ("[[disc]]\nradius = 1\nschedule = [[0, 1, 2]]\nrepeat = False", "False", "false"),
            ("[[disc]]\nradius = 1\nschedule = [[0, 1, 2]]\nrepeat = \"true\"", "\"true\"", "true"),
            ("[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [20, 50]", "open = [20, 50]", "open = [[20, 50]]"),
            ("[[door]]\npoints = [0, 0, 2.5, 0]\nopen = []", "[0, 0, 2.5, 0]", "[[0, 0], [2.5, 0]]"),
            ("[[wall]]\npoints = [(0, 0), (1, 0)]", "[(0, 0), (1, 0)]", "[[0, 0], [2.5, 0]]"),
            ("[[disc]]\nradius = 1\nschedule = [0, 1, 2]", "[0, 1, 2]", "[[0, 1, 2], [5, 4, 2]]"),
            ("[[disc]]\ncentre = 1, 2\nradius = 1", "1, 2", "[2.5, 1]"),
            ("[[disc]]\ncentre = 1 2\nradius = 1", "1 2", "[2.5, 1]"),
            ("[[wall]]\npoints = [[0,5 1], [2, 3]]", "[[0,5 1], [2, 3]]", "[[0, 0], [2.5, 0]]"),
            ("[[disc]]\ncentre = 1,2\nradius = 1", "1,2", "[2.5, 1]"),
            ("[[disc]]\ncentre = [[1, 2]]\nradius = 1", "[[1, 2]]", "[2.5, 1]"),
        ] {
            let message = refused(text);
            let (_, help) = message.split_once("\nhelp: ").expect(&message);
            assert!(help.contains(proposed), "{text}: {message}");
            let corrected = World::parse("room.toml", &text.replace(typed, proposed));
            assert!(corrected.is_ok(), "{text}: {message}: {corrected:?}");
        }
    }

    #[test]
    fn text_that_is_not_understood_has_no_help() {
        for text in [
            "units = 0,5",
            "units = .5",
            "rough = 0,5%",
            "rough = 0,5,6",
            "rough = 0,5,",
            "rough = 00,5",
            "rough = .",
            "rough = .5m",
            "rough = 1.5.2",
            "rough = 1 2",
            "units = yes",
            "[wall.points]",
            "[[wall]",
            "[[box]]\nmin = [",
            "[[wall]]\npoints = [ # x = 3\n[1 2]]",
            "[[wall]]\nname = \"a\"\npoints = [[0, 0], [\"1\", 0]]",
            "[[wall]]\npoints = [[0, 0] [1, 0]]",
            "[[wall]]\npoints = [[0, 0], [1, 0]]]",
            "[[wall]]\npoints = [[0, 0], [1, 0]] rough = 1",
        ] {
            let message = refused(text);
            assert!(!message.contains("help: "), "{text}: {message}");
        }
    }

    #[test]
    fn mistakes_are_in_the_words_of_the_book() {
        let messages = [
            "rough = 0,5",
            "start = { x = 1,500 }",
            "[[wall]]\npoints = [[.5, 1], [2, 3]]",
            "[wall]\npoints = [[0, 0], [1, 0]]",
            "wall = { points = [[0, 0], [1, 0]] }",
            "[[wall]]\npoints = [[-2 -2], [3, 0]]",
            "[[disc]]\nradius = 1\nrepeat = yes",
            "[[door]]\npoints = [[0, 0], [1, 0]]\nopen = [20, 50]",
            "rough = 0.5\nrough = 0.6",
            "[start]\nx = 1\n[start]\nx = 2",
            "[wall]\npoints = [[0, 0], [1, 0]]\n[[wall]]\npoints = [[0, 0], [1, 0]]",
            "wall = []\n[[wall]]\npoints = [[0, 0], [1, 0]]",
        ];
        insta::assert_snapshot!(messages.map(refused).join("\n"), @"
        room.toml:1:10: `0,5` has a comma; a number has a dot before its fraction, and no comma
        help: write `0.5`
        room.toml:1:21: `1,500` has a comma; a number has a dot before its fraction, and no comma
        help: write `1500` or `1.500`
        room.toml:2:12: `.5` lacks a digit; a number has digits before and after its dot
        help: write `0.5`
        room.toml:1:1: `[wall]` has single brackets
        help: write `[[wall]]` each time, as there may be several
        room.toml:1:8: `wall` cannot have this value
        help: write `[[wall]]`, and its keys and values in the lines below
        room.toml:2:12: no comma between the numbers `-2 -2`
        help: write `-2, -2`
        room.toml:3:10: `repeat` is neither `true` nor `false`
        help: write `true` or `false`, without quotes
        room.toml:3:9: the value of `open` has a wrong form
        help: write it in the form of `open = [[20, 50]]`
        room.toml:2:1: the key `rough` is given twice
        help: leave one of the two out
        room.toml:3:2: the key `start` is given twice
        help: leave one of the two out
        room.toml:3:3: `[wall]` has single brackets
        help: write `[[wall]]` each time, as there may be several
        room.toml:2:3: the key `wall` is given twice
        help: leave one of the two out
        ");
    }
}
