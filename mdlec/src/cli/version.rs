//! Texts that an executable depends on, for its answer to `--version`: neither place nor time is among them.

use mdle_files::{Input, Target};

/// Returns the hash of the plan's text and the files it uses, the target, the hash of its alphabet and the shared ones,
/// and the version of the compiler.
pub(super) fn version(input: &Input, target: &Target) -> String {
    format!(
        "text {}, target {}, alphabet {}, mdlec {}",
        hash(input.texts()),
        target.alphabet.name,
        hash(target.texts()),
        env!("CARGO_PKG_VERSION")
    )
}

/// Returns twelve hexadecimal digits that identify a sequence of texts.
fn hash<'t>(texts: impl Iterator<Item = &'t str>) -> String {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        // The length keeps a text apart from the next.
        hasher.update(&text.len().to_le_bytes()).update(text.as_bytes());
    }
    hasher.finalize().to_hex()[..12].to_owned()
}
