//! Tests that targets that a manifest excludes from `cargo test` contain no tests. They are excluded to save time:
//! cargo would compile and link each target once more, and rustdoc would read each library.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_tests::repository::files;
use toml::Table;

/// A cargo target of a package.
struct Target {
    /// Path of the target's root file from the root of the repository.
    path: String,
    /// The target's table in the manifest.
    table: Table,
}

impl Target {
    /// Returns `true` if the target's table sets this flag to `false`.
    fn is_without(&self, flag: &str) -> bool {
        self.table.get(flag).and_then(toml::Value::as_bool) == Some(false)
    }
}

/// Returns the targets of this kind, `lib` or `bin`, that have a table in a manifest.
fn targets(kind: &str) -> Vec<Target> {
    let mut targets = Vec::new();
    for manifest in files(&["Cargo.toml"]) {
        let folder = manifest.path.trim_end_matches("Cargo.toml");
        let manifest: Table = manifest.text.parse().expect("a manifest");
        let tables = match manifest.get(kind) {
            Some(toml::Value::Table(table)) => vec![table.clone()],
            Some(toml::Value::Array(tables)) => tables.iter().filter_map(toml::Value::as_table).cloned().collect(),
            Some(_) | None => Vec::new(),
        };
        targets.extend(tables.into_iter().map(|table| {
            let path = table.get("path").and_then(toml::Value::as_str).unwrap_or("src/lib.rs");
            Target { path: format!("{folder}{path}"), table }
        }));
    }
    targets
}

/// Returns `true` if a file contains a test.
fn has_tests(text: &str) -> bool {
    text.lines().any(|line| line.trim_start() == "#[test]")
}

/// Returns `true` if the documentation in a file contains an example that rustdoc compiles: a block without a language,
/// in Rust, or with an attribute such as `no_run`.
fn has_examples(text: &str) -> bool {
    let lines = text.lines().map(str::trim_start);
    let documentation = lines.filter_map(|line| line.strip_prefix("///").or_else(|| line.strip_prefix("//!")));
    let fences = documentation.filter_map(|line| line.trim_start().strip_prefix("```"));
    // Every second fence ends a block.
    fences.step_by(2).any(|language| !["text", "mdle", "toml", "console"].contains(&language))
}

/// Asserts that `has` is `false` for all files of the targets that set `flag` to `false`. `is_in` returns `true` if a
/// file with this path belongs to the target.
fn assert_none(targets: &[Target], flag: &str, is_in: fn(&Target, &str) -> bool, has: fn(&str) -> bool) {
    let left_out: Vec<_> = targets.iter().filter(|target| target.is_without(flag)).collect();
    assert!(left_out.len() > 3, "{} targets without {flag}", left_out.len());
    let sources = files(&[".rs"]).into_iter().filter(|file| left_out.iter().any(|target| is_in(target, &file.path)));
    let found: Vec<_> = sources.filter(|file| has(&file.text)).map(|file| file.path).collect();
    assert_eq!(found, [] as [&str; 0], "{flag} = false");
}

#[test]
fn what_is_not_built_to_be_tested_has_no_tests() {
    assert_none(&targets("bin"), "test", |target, path| target.path == path, has_tests);
    // Tests in the package's folder `tests` are separate targets.
    let is_inside = |target: &Target, path: &str| path.starts_with(target.path.trim_end_matches("lib.rs"));
    assert_none(&targets("lib"), "test", is_inside, has_tests);
    assert_none(&targets("lib"), "doctest", is_inside, has_examples);
}

#[test]
fn tests_and_examples_are_recognized() {
    assert!(has_tests("mod tests {\n    #[test]\n    fn it_works() {}\n}\n"));
    assert!(!has_tests("/// Says `#[test]`.\nfn f() {}\n"));
    for example in ["", "rust", "no_run"] {
        assert!(has_examples(&format!("/// ```text\n/// a\n/// ```\n/// ```{example}\n/// f()\n/// ```\n")));
    }
    assert!(!has_examples("//! ```text\n//! a\n//! ```\n\nlet fence = \"```rust\";\n"));
}
