//! Tests the paper's own listings exactly as printed, including typesetting marks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::golden::judge;
use mdle_tests::repository::{TextFile, root};

/// Listings, each with its first words, the name of its file, and its number of repeated interrupts.
const LISTINGS: [(&str, &str, usize); 5] = [
    (r"$\Gamma_{lab2}^{lab1} = \{$", "lab2_to_lab1", 0),
    (r"$\Gamma_{lab}^{office} = \{$", "lab1_to_office", 0),
    (r"$\Gamma_{robot1} = \{$", "first_robot", 2),
    (r"$\Gamma_{robot2} = \{$", "second_robot", 2),
    (r"$$\Gamma_{\text{soundFollow}} = \{", "sound_following", 0),
];

/// Returns the listing that begins with `first`. It ends with its block or, if it is a formula, with its line.
fn cut<'p>(paper: &'p str, first: &str) -> &'p str {
    if first.starts_with("$$") {
        return paper.lines().find(|line| line.starts_with(first)).expect(first);
    }
    let block = paper.split("```\n").find(|block| block.trim_start().starts_with(first)).expect(first);
    block.trim_matches('\n')
}

/// Returns the text of the paper if it is available beside the checkout; the listings alone are always available in
/// `plans/paper/`.
fn paper() -> Option<String> {
    let folder = root().join("../shared/paper");
    let file = fs::read_dir(folder).ok()?.find_map(|entry| Some(entry.ok()?.path()).filter(|path| path.is_file()))?;
    fs::read_to_string(file).ok()
}

#[test]
fn listings_are_accepted_as_printed() {
    for (first, name, repeated) in LISTINGS {
        let path = format!("plans/paper/{name}.mdle");
        let text = fs::read_to_string(root().join(&path)).expect(&path);
        assert!(text.trim_start().starts_with(first), "{path} is not as printed");
        let (compiled, message) = judge(&TextFile { path, text: text.clone() }, None);
        assert_eq!(compiled.len(), 1, "{message}");
        assert_eq!(message.matches("warning[W0101]").count(), repeated, "{message}");
        // A forward speed of `0.5` is half a centimetre per second, which cannot be intended.
        let slow = message.matches("warning[W0401]: `v` of `go` is 0.5 cm/s").count();
        assert_eq!(slow, text.matches("go(0.5 0)").count(), "{message}");
        // In the paper, `sync` is used without a timer.
        let waits = message.matches("warning[W0209]").count();
        assert_eq!(waits, text.matches("(Atom (sync ").count() + text.matches("(Atom ((sync ").count(), "{message}");
        assert_eq!(message.matches("[W").count(), repeated + slow + waits, "{message}");
    }
}

#[test]
fn listings_are_those_of_the_paper() {
    let Some(paper) = paper() else { return };
    for (first, name, _) in LISTINGS {
        let path = root().join(format!("plans/paper/{name}.mdle"));
        let kept = fs::read_to_string(path).expect(name);
        assert_eq!(cut(&paper, first), kept.trim_matches('\n'));
    }
}
