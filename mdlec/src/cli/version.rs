//! Computes the version text of an executable from everything on which the executable depends. The text contains no
//! paths and no times.

use mdle_files::Target;

/// Returns the version text. It contains a hash of `texts` (the texts of the plan and of the files that it uses), the
/// name of the target, a hash of the target's alphabet and of the shared alphabets, and the version of the compiler.
pub(super) fn version<'t>(texts: impl Iterator<Item = &'t [u8]>, target: &Target) -> String {
    format!(
        "text {}, target {}, alphabet {}, mdlec {}",
        hash(texts),
        target.alphabet.name,
        hash(target.texts().map(str::as_bytes)),
        env!("CARGO_PKG_VERSION")
    )
}

/// Returns twelve hexadecimal digits that identify a sequence of texts.
fn hash<'t>(texts: impl Iterator<Item = &'t [u8]>) -> String {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        // The length separates the texts, so that different texts never give the same input.
        hasher.update(&text.len().to_le_bytes()).update(text);
    }
    hasher.finalize().to_hex()[..12].to_owned()
}
