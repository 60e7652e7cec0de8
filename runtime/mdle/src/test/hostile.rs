//! Tests that the parser of test files accepts or refuses any text, and that a refusal names a place in the text.

use super::file::read;

/// A file with a scripted test and a simulated test.
const TEXT: &str = r#"
plan = "dock.mdle"

[[test]]
name = "é: it shakes itself"
script = [{ t = 0 }, { t = 1, fired = ["bumper"] }]
expect.atoms = ["go 20 0", "turn 90"]
expect.transitions = [{ from = "go 20 0", to = "Shake", by = "wait 20s", within = "20s" }]
expect.end = "bumper"

[[test]]
name = "it drives up to the wall"
world = "room"
start = "0.7,0.7,0"
seed = 1
seeds = 5
body = "scout"
expect.order = ["go 20 0", "Shake", "turn 90"]
expect.never = ["bumper"]
"#;

/// Texts that the test inserts at each place.
const TYPED: [&str; 9] = ["\"", "[", "]", "=", "-", "9", "é", "\n", "\0"];

#[test]
fn any_text_is_read_or_refused_at_a_place() {
    assert!(read(TEXT).is_ok(), "{:?}", read(TEXT));
    let mut texts = Vec::new();
    for (place, letter) in TEXT.char_indices() {
        let (before, after) = (&TEXT[..place], &TEXT[place + letter.len_utf8()..]);
        texts.push(before.to_owned());
        texts.push(format!("{before}{after}"));
        texts.extend(
            TYPED
                .iter()
                .flat_map(|typed| [format!("{before}{typed}{letter}{after}"), format!("{before}{typed}{after}")]),
        );
    }
    let mut refused = 0;
    for text in texts {
        let Err(error) = read(&text) else { continue };
        refused += 1;
        assert!(!error.message.is_empty() && !error.message.contains('\n'), "{error:?} of {text}");
        assert!(error.place.is_none_or(|place| text.get(place).is_some()), "{text}");
    }
    assert!(refused > 1000, "{refused}");
}
